// What may a frame cost, and what is coarse in it so that it costs no more? The part of
// FramePlanner about CacheOptions::max_spike and Plan::fallback.
#include <algorithm>
#include <cmath>

#include "rilievo/cache/plan/fallback.h"
#include "rilievo/cache/plan/frame_planner.h"

namespace rilievo {
namespace {

// By how much CacheState::limit grows from frame to frame.
constexpr double kLimitGrowth = 1.3;
// Of what a frame would cost without a limit, at least so much is allowed but after a jump: where
// all frames are slow, they need not become fine as slowly as where others are fast.
constexpr double kLeastShare = 0.5;
// Where nothing jumped, captures do not make a frame cost more than this share of spike_floor or
// max_spike times what is usual; in the second frame they cost no more than this.
constexpr double kWalkFloor = 0.4, kCaptureFloor = 0.2;
// After a jump the fallback takes no more than this share of what the frame may cost, down to
// texels of four pixels, which still show what is where.
constexpr double kFallbackShare = 0.8, kCoarsestAfterJump = 0.25;
// An eye that stood has jumped if its first step shifts what it saw by more, radians.
constexpr double kFirstShift = 0.25;

}  // namespace

double FramePlanner::mean_shift() const {
  double sum = 0;
  int drawn = 0;
  for (const Picture& picture : state.slots)
    if (picture.held && picture.used + 1 == state.frame) {
      sum += frame.step / picture.geometry.plane_z;
      ++drawn;
    }
  return drawn > 0 ? sum / drawn : 0;
}

void FramePlanner::find_limit() {
  const double usual = state.usual_cost;
  if (!(options.max_spike > 0)) return;
  // What is captured for an eye that stands is of little use to one that walks, and only the second
  // frame tells which it is.
  captures_wait = state.frame == 0;
  // The first frame may take its time: nothing that moves is interrupted. The second one does not
  // capture all that it left.
  if (!(usual > 0) && !frame.jumped) {
    if (state.frame > 0) capture_room = kCaptureFloor * options.spike_floor;
    return;
  }
  const double spike = std::max(options.spike_floor, options.max_spike * usual);
  double limit = std::max(options.spike_floor, usual), allowed = spike;
  // Of an eye's first step, what it costs and what shifts tell whether it was a jump.
  jumped = frame.jumped || (frame.started && (cost_at_hand > spike || mean_shift() > kFirstShift));
  if (jumped) {
    allowed = limit = options.jump_share * options.spike_floor;
  } else if (state.limit > 0) {
    const double last = std::max(state.limit, options.spike_floor);
    allowed = limit =
        std::max({last, std::min(kLimitGrowth * last, spike), kLeastShare * cost_at_hand});
  }
  if (cost_at_hand > allowed)
    plan.limit = limit;
  else
    capture_room = std::max(0.0, std::min(allowed, std::max(kWalkFloor * options.spike_floor,
                                                            options.max_spike * usual)) -
                                     cost_at_hand);
}

// Of one object: is it to be in the fallback, and is that cheaper than its polygons?
bool FramePlanner::falls_back(Entity e, float from, float to) const {
  if (fallback_depth_ == 0 || is_moving(e) || from > 0 || to < 1) return false;
  const double texels = covered_pixels(view, box_of(e)) * fallback_scale * fallback_scale;
  return stands_for(e, polygon_cost(e)).cost > options.cost.fallback_texel * texels;
}

// The smallest scale of the fallback: after a jump no larger than leaves some of the frame's limit.
double FramePlanner::coarsest_fallback() const {
  if (!jumped) return kCoarsestFallback;
  const double pixels = double(view.camera.width) * view.camera.height;
  const double most =
      std::sqrt(kFallbackShare * plan.limit / (options.cost.fallback_texel * pixels));
  return std::clamp(most, kCoarsestAfterJump, kCoarsestFallback);
}

// Moves the dearest polygons into the fallback, which costs the same however many it shows, until
// the frame costs what it may; none where that would cost more.
void FramePlanner::limit_cost() {
  if (!(plan.limit > 0)) return;
  const double frame = double(view.camera.width) * view.camera.height;
  const auto count_fallback = [&](double scale) {
    plan.cost -= plan.fallback_cost;
    plan.fallback_cost = options.cost.fallback_texel * frame * scale * scale;
    plan.cost += plan.fallback_cost;
  };
  if (!plan.fallback.objects.empty()) count_fallback(fallback_scale);
  if (plan.cost <= plan.limit) return;
  std::vector<std::uint32_t>& dearest = scratch.dearest;
  dearest.clear();
  double polygons = 0;
  for (std::uint32_t i = 0; i < plan.polygons.size(); ++i)
    if (plan.polygons[i].from <= 0 && plan.polygons[i].to >= 1) {
      dearest.push_back(i);
      polygons += double(scratch.polygons[i].cost);
    }
  const double coarsest = coarsest_fallback();
  if (plan.fallback.objects.empty() &&
      polygons <= options.cost.fallback_texel * frame * coarsest * coarsest)
    return;
  count_fallback(coarsest);
  std::sort(dearest.begin(), dearest.end(), [&](std::uint32_t a, std::uint32_t b) {
    const float cost_a = scratch.polygons[a].cost, cost_b = scratch.polygons[b].cost;
    return cost_a != cost_b ? cost_a > cost_b : a < b;
  });
  std::size_t moved = 0;
  for (; moved < dearest.size() && plan.cost > plan.limit; ++moved) {
    const auto& [entity, cost, triangles] = scratch.polygons[dearest[moved]];
    plan.fallback.objects.push_back(plan.polygons[dearest[moved]].object);
    scratch.boxes.push_back(box_of(entity));
    plan.polygon_triangles -= triangles;
    plan.cost -= double(cost);
    plan.polygons[dearest[moved]].to = 0;
  }
  std::erase_if(plan.polygons, [](const DrawnObject& drawn) { return drawn.to <= 0; });
  fallback_scale = rilievo::fallback_scale(view, frame, plan.limit - plan.cost + plan.fallback_cost,
                                           coarsest, options);
}

void FramePlanner::finish_fallback() {
  plan.fallback.geometry = fallback_geometry(view, scratch.boxes, fallback_scale, options);
  plan.fallback.bound_px = bound_total_px(plan.fallback.geometry, frame.camera);
  // Rays at texels' centres may miss all of a surface into which no circle fits that reaches four.
  const Camera& coarse = plan.fallback.geometry.capture;
  const double across = view.px * (coarse.window.right - coarse.window.left) / coarse.width;
  const double up = view.py * (coarse.window.top - coarse.window.bottom) / coarse.height;
  plan.fallback.texel_px = across;
  plan.fallback.gap_px = std::hypot(across, up);
}

}  // namespace rilievo
