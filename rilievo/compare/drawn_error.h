// How far from their true places does a method draw surfaces?
//
// Measured by what is drawn, whatever the method: it walks through a scene whose colours tell
// positions (scene/position_colors.h), and each pixel is decoded. Its error is the distance in
// pixels between the pixel's centre and the place to which the true camera projects the position
// that it shows; of the positions that its colour may mean, the one with the least error near the
// drawn or the true depth. Therefore an error above a quarter of the code's period looks smaller.
// Pictures, fades and decisions depend on geometry only, so that the second walk draws what the
// first one did, unless a clock decides.
//
// Not measured, and counted: pixels within 1.5 of an object's boundary in the true or the drawn
// frame, or near the frame's border; where samples may be mixed, near steps of the true depth
// within an object and near pixels whose position even the true frame does not tell (what is
// narrower than a pixel); and where the code's half period is less than kFinestCode or more than
// kCoarsestCode pixels.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/compare/compare.h"
#include "rilievo/measure/stats.h"
#include "rilievo/measure/visibility.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// Half periods of the code, in pixels, between which a pixel is measured.
inline constexpr double kFinestCode = 12, kCoarsestCode = 64;
// What rounding does: each of three channels is off by up to half a byte where a picture is
// captured and again where the frame is drawn, and by a fifth each time by the curve of sRGB.
inline constexpr double kCodeResolution = 1.4 * 1.7320508 / 255;  // of the half period

// Half a pixel's diagonal: how far from a pixel's centre the texel that it shows may lie where
// texels are as large as pixels. Bounds leave it out (nailboard/error.h).
inline constexpr double kTexelError = 0.70710678;

// What can be measured at a pixel of a true frame.
enum class PixelState : std::uint8_t { no_object, boundary, mixed, unresolved, measurable };

// A pixel is in a gap if it shows what lies behind the true surface, farther from its place than
// the bound, and a pixel within half of FrameStats::gap_px, and half a pixel's diagonal, shows what
// it should. Bounds of errors are not about gaps, which have a bound of their own.

// The errors of a method's pixels.
struct DrawnErrors {
  Histogram errors_px;
  double largest_px = 0;
  double resolution_px = 0;      // the largest of what was measured
  std::uint64_t shown = 0;       // pixels that show an object in the true frame
  std::uint64_t boundary = 0;    // of these, not measured: beside a boundary, or another object
  std::uint64_t mixed = 0;       // ... near what mixes
  std::uint64_t unresolved = 0;  // ... too far away or too near for the code
  std::uint64_t over_bound = 0;  // measured, and above the frame's bound by more than is resolved
  std::uint64_t violations = 0;  // ... and by more than kTexelError besides, and not in a gap
  std::uint64_t in_gaps = 0;     // ... and in a gap that the frame's bound of gaps allows
};

// Half periods, one for each model, that suit the places from which `truth` shows the models in a
// few frames of the walk.
[[nodiscard]] Result<std::vector<double>> choose_half_periods(
    const Scene& scene, FrameSource& truth, const std::function<WalkFrame(int frame)>& walk,
    const CompareOptions& options);

// Where the error of a frame can be measured. `truth` shows positions of `scene`'s models by
// `half_periods`; what mixes is looked for within `margin` pixels. Uses all cores, as the next.
[[nodiscard]] Image<PixelState> find_measurable(const Scene& scene,
                                                std::span<const double> half_periods,
                                                const WalkFrame& frame, const DrawnFrame& truth,
                                                int margin);
// Adds the errors of a frame that shows positions as `truth` does.
void add_drawn_errors(const Scene& scene, std::span<const double> half_periods,
                      const WalkFrame& frame, const DrawnFrame& truth,
                      const Image<PixelState>& states, const DrawnFrame& seen, DrawnErrors& errors);

// Walks by all sources, which draw `coded`, the scene with_position_colors(). The first one draws
// the true frames. Sets MethodResult::error_px of the methods of `report` that have these names,
// and notes a method that did not capture and draw as much as in the report.
[[nodiscard]] Result<> measure_drawn_errors(const Scene& coded,
                                            std::span<const double> half_periods,
                                            std::span<const ComparedSource> sources,
                                            const std::function<WalkFrame(int frame)>& walk,
                                            const CompareOptions& options, Report& report);

}  // namespace rilievo
