#include "rilievo/keyframes/coarse_keyframes.h"

#include <algorithm>
#include <cmath>

#include "rilievo/core/stopwatch.h"

namespace rilievo {
namespace {

// Texels for each pixel of the frame, in each direction: of the first one; and at least, where it
// would take more ms by what the last ones took. And the margin.
constexpr double kFirstCoarse = 0.45, kLeastCoarse = 0.25, kCoarseMs = 40;
constexpr double kCoarseMargin = 1.1;
// The share of the last one in the cost of a texel, where that is less than before.
constexpr double kNewestCoarse = 0.25;

}  // namespace

// For each pixel of the frame, in each direction.
double CoarseKeyframes::texels(const Camera& frame) const {
  if (texel_ms_ == 0) return kFirstCoarse;
  const Camera whole = keyframe_camera(frame, kCoarseMargin);
  return std::clamp(std::sqrt(kCoarseMs / (texel_ms_ * whole.width * whole.height)), kLeastCoarse,
                    1.0);
}

Result<Keyframe> CoarseKeyframes::make(const Camera& frame, std::span<const std::uint32_t> objects,
                                       double time) {
  KeyframeRequest request;
  request.camera = keyframe_camera(frame, kCoarseMargin, texels(frame));
  request.objects = objects, request.samples = 1;
  request.time = time, request.coarse = true;
  const Stopwatch watch;  // with the memory that it takes
  has_memory_ = true;
  maker_.begin(request, std::exchange(spare_, {}));
  if (Result<> made = maker_.step(source_, maker_.columns_left()); !made) return made.error();
  const double ms = watch.ms() / (double(request.camera.width) * request.camera.height);
  // Rises at once and falls slowly; but of the first one much is what is done once.
  texel_ms_ = ++made_ <= 2 ? ms : std::max(ms, texel_ms_ + (ms - texel_ms_) * kNewestCoarse);
  return maker_.take();
}

void CoarseKeyframes::take_memory(const Camera& frame, std::span<const std::uint32_t> objects,
                                  double time) {
  if (has_memory_) return;
  if (Result<Keyframe> made = make(frame, objects, time)) reuse(std::move(*made));
  // New pages took a part of the time.
  made_ = 0, texel_ms_ = 0;
}

}  // namespace rilievo
