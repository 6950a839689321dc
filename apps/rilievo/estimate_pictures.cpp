#include "apps/rilievo/estimate_pictures.h"

#include <algorithm>
#include <cstddef>

#include "rilievo/core/processor_time.h"
#include "rilievo/core/stopwatch.h"

namespace rilievo::app {
namespace {

// Pictures are estimated with so many times fewer texels a side and samples: in 1/32 of their time.
constexpr int kCoarseSide = 2, kCoarseSamples = 8;
// Programs may refuse smaller ones: Blender makes none below 4.
constexpr int kLeastSide = 8;
// Who takes less of the processor, as a share of the time by the clock, waits for something else.
// A machine on which ten others work gives more.
constexpr double kLeastWork = 0.05;

// What a picture, or all, took.
struct Took {
  double processor = 0, clock = 0;
};

Result<Took> time_of(const CapturePiece& picture, CaptureSource& light) {
  const Stopwatch watch;
  const double before = processor_seconds();
  if (Result<> made = capture_piece(picture, light); !made) return made.error();
  // A program that dies takes with it the time of what it did not wait for.
  return Took{std::max(0.0, processor_seconds() - before), 1e-3 * watch.ms()};
}

// A picture of the same with fewer texels and samples.
CapturePiece coarser(const CapturePiece& picture, int per_side, int per_samples) {
  CapturePiece coarse = picture;
  for (int* side : {&coarse.camera.width, &coarse.camera.height})
    *side = std::max(std::min(*side, kLeastSide), *side / per_side);
  coarse.samples = std::max(1, picture.samples / per_samples);
  return coarse;
}

double work_of(const CapturePiece& picture) {
  return double(picture.camera.width) * double(picture.camera.height) * double(picture.samples);
}

}  // namespace

// Time is the same for every picture, and as much again for each sample of a texel, as much as
// there is to see.
//
//   seconds = same + (coarse - same) work / coarse work
Result<std::vector<double>> estimate_seconds(const std::vector<CapturePiece>& pictures,
                                             CaptureSource& light, Progress& progress) {
  Took same;
  // The first one also starts the program.
  for (int i = 0; i < 3; ++i) {
    const Result<Took> tiny = time_of(coarser(pictures.front(), 1 << 16, 1 << 16), light);
    if (!tiny) return tiny.error();
    if (i == 1) same = *tiny;
    if (i > 1)
      same = {std::min(same.processor, tiny->processor), std::min(same.clock, tiny->clock)};
  }
  std::vector<Took> coarse;
  Took all;
  for (const CapturePiece& picture : pictures) {
    progress.show(int(coarse.size()), int(pictures.size()), 0);
    const Result<Took> took = time_of(coarser(picture, kCoarseSide, kCoarseSamples), light);
    if (!took) return took.error();
    coarse.push_back(*took);
    all.processor += took->processor, all.clock += took->clock;
  }
  progress.show(int(pictures.size()), int(pictures.size()), 0);
  double Took::*const counted =
      all.processor >= kLeastWork * all.clock ? &Took::processor : &Took::clock;
  std::vector<double> seconds;
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    const double work =
        work_of(pictures[i]) / work_of(coarser(pictures[i], kCoarseSide, kCoarseSamples));
    seconds.push_back(same.*counted + std::max(0.0, coarse[i].*counted - same.*counted) * work);
  }
  return seconds;
}

}  // namespace rilievo::app
