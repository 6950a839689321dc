// What a frame costs, and what is coarse in it so that it costs no more: the part of FramePlanner
// about SpikePolicy and Plan::fallback.
#include <algorithm>
#include <cmath>

#include "rilievo/cache/plan/fallback.h"
#include "rilievo/cache/plan/frame_planner.h"

namespace rilievo {
namespace {

// By how much what the last frame drew as pictures has shifted since: the mean, radians.
double mean_shift(const CacheState& state, double step) {
  double sum = 0;
  int drawn = 0;
  for (const Picture& picture : state.slots)
    if (picture.held && picture.used + 1 == state.frame) {
      sum += step / picture.geometry.plane_z;
      ++drawn;
    }
  return drawn > 0 ? sum / drawn : 0;
}

}  // namespace

FrameCosts FramePlanner::frame_costs() const {
  return {.first = state_.frame == 0,
          .jumped = frame_.jumped,
          .started = frame_.started,
          .shift = frame_.started ? mean_shift(state_, frame_.step) : 0,
          .now = cost_at_hand_,
          .usual = state_.usual_cost,
          .last_limit = state_.limit};
}

// Of one object: is it to be in the fallback, and is that cheaper than its polygons?
bool FramePlanner::falls_back(Entity e, float from, float to) const {
  if (fallback_depth_ == 0 || is_moving(e) || from > 0 || to < 1) return false;
  const double texels = covered_pixels(view_, box_of(e)) * fallback_scale_ * fallback_scale_;
  return stands_for(e, polygon_cost(e)).cost > options_.cost.fallback_texel * texels;
}

// Moves the dearest polygons into the fallback, which costs the same however many it shows, until
// the frame costs what it may; none where that would cost more.
void FramePlanner::limit_cost() {
  if (!(plan_.limit > 0)) return;
  const double whole = double(view_.camera.width) * view_.camera.height;
  const auto count_fallback = [&](double scale) {
    plan_.cost -= plan_.fallback_cost;
    plan_.fallback_cost = options_.cost.fallback_texel * whole * scale * scale;
    plan_.cost += plan_.fallback_cost;
  };
  if (!plan_.fallback.objects.empty()) count_fallback(fallback_scale_);
  if (plan_.cost <= plan_.limit) return;
  std::vector<std::uint32_t>& dearest = scratch_.dearest;
  dearest.clear();
  double polygons = 0;
  for (std::uint32_t i = 0; i < plan_.polygons.size(); ++i)
    if (plan_.polygons[i].from <= 0 && plan_.polygons[i].to >= 1) {
      dearest.push_back(i);
      polygons += double(scratch_.polygons[i].cost);
    }
  const double coarsest =
      coarsest_fallback(limit_, options_.cost.fallback_texel * whole, kCoarsestFallback);
  if (plan_.fallback.objects.empty() &&
      polygons <= options_.cost.fallback_texel * whole * coarsest * coarsest)
    return;
  count_fallback(coarsest);
  std::sort(dearest.begin(), dearest.end(), [&](std::uint32_t a, std::uint32_t b) {
    const float cost_a = scratch_.polygons[a].cost, cost_b = scratch_.polygons[b].cost;
    return cost_a != cost_b ? cost_a > cost_b : a < b;
  });
  std::size_t moved = 0;
  for (; moved < dearest.size() && plan_.cost > plan_.limit; ++moved) {
    const auto& [entity, cost, triangles] = scratch_.polygons[dearest[moved]];
    plan_.fallback.objects.push_back(plan_.polygons[dearest[moved]].object);
    scratch_.boxes.push_back(box_of(entity));
    plan_.polygon_triangles -= triangles;
    plan_.cost -= double(cost);
    plan_.polygons[dearest[moved]].to = 0;
  }
  std::erase_if(plan_.polygons, [](const DrawnObject& drawn) { return drawn.to <= 0; });
  fallback_scale_ = rilievo::fallback_scale(
      view_, whole, plan_.limit - plan_.cost + plan_.fallback_cost, coarsest, options_);
}

void FramePlanner::finish_fallback() {
  plan_.fallback.geometry = fallback_geometry(view_, scratch_.boxes, fallback_scale_, options_);
  plan_.fallback.bound_px = bound_total_px(plan_.fallback.geometry, frame_.camera);
  // Rays at texels' centres may miss all of a surface into which no circle fits that reaches four.
  const Camera& coarse = plan_.fallback.geometry.capture;
  const double across = view_.px * (coarse.window.right - coarse.window.left) / coarse.width;
  const double up = view_.py * (coarse.window.top - coarse.window.bottom) / coarse.height;
  plan_.fallback.texel_px = across;
  plan_.fallback.gap_px = std::hypot(across, up);
}

void FramePlanner::make_fallback(CaptureMaker& maker) {
  Fallback& fallback = plan_.fallback;
  if (fallback.objects.empty()) return;
  finish_fallback();
  const MadeCapture made = maker.make(fallback);
  if (made.made) {
    if (made.range) narrow_slab(fallback.geometry, *made.range);
    return;
  }
  for (const std::uint32_t object : fallback.objects) plan_.polygons.push_back({object, 0, 1});
  fallback.objects.clear();
}

}  // namespace rilievo
