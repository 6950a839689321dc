#include "rilievo/cache/prices/use_machine.h"

#include <algorithm>
#include <cmath>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

// What the built-in budgets of triangles take on the machine of policy.h, where one takes 280 ns: a
// frame's captures, and a picture of several objects.
constexpr double kBuiltinTriangleNs = 280;
const double kCapturesNs = kBuiltinTriangleNs * double(CacheOptions{}.capture_triangles);
const double kPictureNs = kBuiltinTriangleNs * double(CacheOptions{}.picture_triangles);
// By software polygons are cheap: with fewer captures in a frame the slowest frames take less time,
// and the others no more.
constexpr double kSoftwareCapturesNs = 40e6;
// A frame after a cut may take so long (SpikePolicy::floor).
constexpr double kSpikeFloorNs = 100e6;

}  // namespace

Result<> expect_costs(const MachineCosts& costs, DrawnBy drawn_by, bool rasterizes) {
  if (drawn_by == DrawnBy::opengl && !costs.draw_opengl)
    return Error{"--machine", "its costs were measured without OpenGL, which draws here"};
  if (!rasterizes && !costs.capture_opengl)
    return Error{"--machine", "its costs were measured without OpenGL, which captures here"};
  return Done{};
}

void use_machine(const MachineCosts& costs, DrawnBy drawn_by, bool rasterizes,
                 CacheOptions& options, CostClock& clock) {
  RILIEVO_EXPECTS(expect_costs(costs, drawn_by, rasterizes).ok());
  const DrawTimes& draw = drawn_by == DrawnBy::software ? costs.draw_software : *costs.draw_opengl;
  const CaptureTimes& capture = rasterizes ? costs.capture_rasterizer : *costs.capture_opengl;
  const double triangle = draw.triangle_ns;
  CostModel& cost = options.cost;
  cost.picture = draw.picture_ns / triangle;
  cost.picture_pixel = draw.picture_pixel_ns / triangle;
  cost.object = draw.object_ns / triangle;
  cost.polygon_pixel = draw.polygon_pixel_ns / triangle;
  cost.shaded_pixel = cost.polygon_pixel;
  cost.capture = capture.picture_ns / triangle;
  cost.capture_triangle = capture.triangle_ns / triangle;
  cost.capture_texel = capture.texel_ns / triangle;
  cost.fallback_texel = costs.ray_texel_ns / triangle;
  clock = CostClock(1e-6 * triangle);
  const auto in_time = [&](double ns) {
    return std::uint64_t(std::max(1.0, std::round(ns / capture.triangle_ns)));
  };
  options.capture_triangles =
      in_time(drawn_by == DrawnBy::software ? kSoftwareCapturesNs : kCapturesNs);
  options.picture_triangles = in_time(kPictureNs);
  options.spikes.floor = kSpikeFloorNs / triangle;
}

CostTerms terms_for(const CostTerms& terms, const CostModel& model) {
  const double work = model.picture_pixel / CostModel{}.picture_pixel;
  return {terms.triangles + work * terms.fixed, work * terms.per_pixel, 0};
}

}  // namespace rilievo
