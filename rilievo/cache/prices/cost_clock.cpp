#include "rilievo/cache/prices/cost_clock.h"

#include <algorithm>
#include <utility>

namespace rilievo {
namespace {

constexpr double kDearer = 0.5, kCheaper = 0.1, kForgotten = 0.02;
constexpr double kLeastMs = 0.1;                   // less says little
constexpr std::uint64_t kLeastTriangles = 10'000;  // of pictures of several objects

}  // namespace

void MeasuredPrice::learn(double cost, double ms) {
  if (!(ms > 0 && cost * ms_per_cost > kLeastMs)) return;
  const double now = ms / cost;
  ms_per_cost += (now > ms_per_cost ? kDearer : kCheaper) * (now - ms_per_cost);
  learned = true;
}

void MeasuredPrice::pass_frame(double least) {
  if (!std::exchange(learned, false) && ms_per_cost > least)
    ms_per_cost += kForgotten * (least - ms_per_cost);
}

void CostClock::pass_frame() {
  capture.pass_frame(drawing.ms_per_cost);
  fallback.pass_frame(drawing.ms_per_cost);
}

void CostClock::set_budget(double ms, const CacheOptions& original, CacheOptions& options) const {
  options.capture_cost = ms / capture.ms_per_cost;
  options.fallback_cost = ms / drawing.ms_per_cost;
  options.cost.fallback_texel =
      original.cost.fallback_texel * fallback.ms_per_cost / drawing.ms_per_cost;
  options.picture_triangles = std::clamp(
      std::uint64_t(std::min(1e15, 0.5 * options.capture_cost / options.cost.capture_triangle)),
      std::min(kLeastTriangles, original.picture_triangles), original.picture_triangles);
  options.spikes.jump_share =
      original.spikes.jump_share * std::min(1.0, modelled_ms_per_cost_ / drawing.ms_per_cost);
}

}  // namespace rilievo
