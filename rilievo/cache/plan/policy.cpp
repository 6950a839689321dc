#include "rilievo/cache/plan/policy.h"

#include <algorithm>
#include <utility>

#include "rilievo/cache/plan/frame_planner.h"
#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

void forget(CacheState& state, std::uint32_t slot) {
  Picture& picture = state.slots[slot];
  RILIEVO_EXPECTS(picture.held);
  for (std::vector<std::uint32_t>* by_entity : {&state.current, &state.previous})
    if ((*by_entity)[picture.entity] == slot + 1) (*by_entity)[picture.entity] = 0;
  state.bytes -= picture.bytes;
  picture.held = false;
  state.free_slots.push_back(slot);
}

Order end_order(CacheState& state, Entity e) {
  const Order order = std::exchange(state.ordered[e], {});
  state.ordered_cost = std::max(0.0, state.ordered_cost - order.cost);
  return order;
}

void forget_order(CacheState& state, Entity e) {
  if (e >= state.ordered.size() || state.ordered[e].number == 0) return;
  const Order order = end_order(state, e);
  state.free_slots.push_back(order.slot);
  state.bytes -= order.bytes;
}

void forget_entity(CacheState& state, Entity e, std::vector<std::uint32_t>& evictions) {
  forget_order(state, e);
  for (std::uint32_t name : {state.current[e], state.previous[e]})
    if (name != 0) {
      forget(state, name - 1);
      evictions.push_back(name - 1);
    }
}

// Of what is drawn now.
void find_bound(Plan& plan) {
  plan.bound_px = plan.polygon_px;
  plan.gap_px = 2 * plan.polygon_px;
  for (const DrawnPicture& drawn : plan.pictures) {
    plan.bound_px = std::max(plan.bound_px, double(drawn.bound_px));
    plan.gap_px = std::max(plan.gap_px, double(drawn.gap_px));
  }
  for (const DrawnAlternative& drawn : plan.alternatives) {
    plan.bound_px = std::max(plan.bound_px, double(drawn.bound_px));
    plan.gap_px = std::max(plan.gap_px, double(drawn.gap_px));
  }
  if (!plan.fallback.objects.empty()) {
    plan.bound_px = std::max(plan.bound_px, plan.fallback.bound_px);
    plan.gap_px = std::max(plan.gap_px, plan.fallback.gap_px);
  }
}

// How soon CacheState::usual_range and usual_life_share follow what captures show.
constexpr double kForget = 1.0 / 32;
// How soon CacheState::latency follows orders that took longer, and shorter: what comes too early
// costs little.
constexpr double kSlower = 0.5, kFaster = 0.1;

// How soon a PolygonRecord, and the usual one, follow what frames took; what is older than so many
// frames is no longer mixed with what is new.
constexpr float kLearn = 0.5f, kLearnUsual = 0.1f;
constexpr std::uint32_t kRecentFrames = 8;

// Of the life that the flatness allows, the share that the gaps allow: both bounds grow about
// evenly with the eye's way. Nothing where the eye is too near the capture's to tell.
std::optional<float> life_share(double bound_px, double limit_px, double gap_px, double gap_limit) {
  const double flat = bound_px / limit_px, torn = gap_px / gap_limit;
  if (!(flat > 0.05)) return std::nullopt;
  return float(torn > flat ? std::max(0.02, flat / torn) : 1.0);
}

// What a capture shows, and how far off it is in a frame.
struct Narrowed {
  double bound_px = 0, gap_px = 0;
  bool good = false;
};

Narrowed narrow(Capture& capture, const Camera& frame, const RigidMotion& motion,
                const DeltaRange& range, const CacheOptions& options, const GapTable& gaps) {
  capture.range = range;
  narrow_slab(capture.geometry, range);
  capture.picture.geometry = capture.geometry;
  capture.picture.gaps = gaps;
  Narrowed narrowed{bound_total_px(capture.geometry, frame, motion) + capture.level_px,
                    bound_gap_px(capture.geometry, gaps, frame, motion) + 2 * capture.level_px};
  const double limit = limit_px(capture.picture, options), gap_limit = gap_limit_px(options);
  capture.life_share = life_share(narrowed.bound_px, limit, narrowed.gap_px, gap_limit);
  const double late = late_factor(options);
  narrowed.good = narrowed.bound_px <= late * limit && narrowed.gap_px <= late * gap_limit;
  return narrowed;
}

// What others like it can be expected to show.
void learn_capture(const Capture& capture, CacheState& state) {
  if (capture.range) {
    state.ranges[capture.entity] = capture.range;
    DeltaRange& usual = state.usual_range[capture.several ? 1 : 0];
    usual.nearest += kForget * (capture.range->nearest - usual.nearest);
    usual.farthest += kForget * (capture.range->farthest - usual.farthest);
  }
  if (capture.life_share) {
    state.life_shares[capture.entity] = capture.life_share;
    float& usual = state.usual_life_share[capture.several ? 1 : 0];
    usual += float(kForget) * (*capture.life_share - usual);
  }
}

}  // namespace

const Box& box_of(Entity entity, const Hierarchy& hierarchy, std::span<const MovingObject> moving) {
  const std::size_t nodes = hierarchy.nodes.size();
  return entity >= nodes ? moving[entity - nodes].box : hierarchy.nodes[entity].box;
}

glm::dmat4 motion_since(const Picture& picture, const Hierarchy& hierarchy,
                        std::span<const MovingObject> moving) {
  const std::size_t nodes = hierarchy.nodes.size();
  return picture.entity >= nodes ? moving[picture.entity - nodes].world_from_object *
                                       glm::inverse(picture.world_from_object)
                                 : glm::dmat4(1.0);
}

void plan_frame(const PlanScene& scene, const CacheState& state, const FrameView& view,
                const CacheOptions& options, CaptureMaker& maker, PlanScratch& scratch,
                Plan& plan) {
  RILIEVO_EXPECTS(view.camera.projection == Projection::perspective);
  const std::size_t nodes = scene.hierarchy.nodes.size();
  const std::size_t entities = nodes + scene.moving.size();
  RILIEVO_EXPECTS(state.current.empty() || state.current.size() == entities);
  RILIEVO_EXPECTS(scene.alternatives.of_entity.empty() ||
                  scene.alternatives.of_entity.size() == entities);
  RILIEVO_EXPECTS(scene.levels.of_node.empty() || scene.levels.of_node.size() == nodes);
  plan.evictions.clear(), plan.captures.clear(), plan.pictures.clear(), plan.alternatives.clear();
  plan.polygons.clear(), plan.moving_polygons.clear(), plan.retirements.clear();
  plan.fallback.objects.clear();
  plan.entities = entities;
  plan.polygon_triangles = plan.captured_triangles = 0;
  plan.single = plan.hierarchy = plan.starved = 0;
  plan.polygon_px = 0;
  plan.cost = plan.fallback_cost = plan.limit = plan.usual_cost = 0;
  plan.bytes = state.bytes;

  scratch.checked.assign(state.slots.size(), {});
  scratch.dropped.assign(state.slots.size(), 0);
  scratch.choice.resize(entities), scratch.now_cost.resize(entities);
  scratch.captured.resize(entities, 0), scratch.fallback.assign(entities, 0);
  scratch.requests.clear(), scratch.idle.clear(), scratch.boxes.clear();
  scratch.polygons.clear();

  FramePlanner(scene, state, view, options, scratch, plan).run(maker);
  find_bound(plan);
  for (const Capture& capture : plan.captures) scratch.captured[capture.entity] = 0;
}

// What could not be made, and what is not good enough, is drawn as if nobody had asked for it.
void FramePlanner::make_captures(CaptureMaker& maker) {
  if (captures_beside(options_)) return;
  scratch_.made.assign(plan_.captures.size(), {});
  maker.make(plan_.evictions, plan_.captures, scratch_.made);
  for (std::size_t i = 0; i < plan_.captures.size(); ++i) {
    Capture& capture = plan_.captures[i];
    const MadeCapture& made = scratch_.made[i];
    capture.geometry.strokes = capture.picture.geometry.strokes = made.strokes;
    if (made.made && !made.range) continue;  // empty
    if (made.made) {
      const Narrowed narrowed =
          narrow(capture, frame_.camera, {}, *made.range, options_, made.gaps);
      capture.bound_px = narrowed.bound_px, capture.gap_px = narrowed.gap_px;
      if (narrowed.good) continue;
      maker.drop(capture.slot);
    }
    plan_.captured_triangles -= capture.triangles;
    plan_.bytes -= capture.picture.bytes;
    capture.picture.held = false;
    scratch_.captured[capture.entity] = 0;
  }
}

bool is_wanted(const Capture& capture, const CacheState& state) {
  return capture.order != 0 && capture.entity < state.ordered.size() &&
         state.ordered[capture.entity].number == capture.order;
}

void cancel_order(const Capture& capture, CacheState& state) {
  if (is_wanted(capture, state)) forget_order(state, capture.entity);
}

bool adopt_capture(Capture& capture, const Camera& frame, const Hierarchy& hierarchy,
                   std::span<const MovingObject> moving, const std::optional<DeltaRange>& range,
                   const GapTable& gaps, const CacheOptions& options, CacheState& state,
                   std::vector<std::uint32_t>& evictions) {
  if (!is_wanted(capture, state)) return false;
  const double longer = double(state.frame - state.ordered[capture.entity].frame) - state.latency;
  state.latency += (longer > 0 ? kSlower : kFaster) * longer;
  if (range) {
    capture.level_px =
        level_px(frame, box_of(capture.entity, hierarchy, moving), capture.picture.level_error);
    const RigidMotion motion{motion_since(capture.picture, hierarchy, moving)};
    const bool good = narrow(capture, frame, motion, *range, options, gaps).good;
    learn_capture(capture, state);
    if (!good) {
      forget_order(state, capture.entity);
      return false;
    }
  }
  // Captured again before its last fade was over: the eldest goes.
  if (const std::uint32_t eldest = state.previous[capture.entity]; eldest != 0) {
    evictions.push_back(eldest - 1);
    forget(state, eldest - 1);
  }
  state.previous[capture.entity] = state.current[capture.entity];
  state.current[capture.entity] = capture.slot + 1;
  state.slots[capture.slot] = capture.picture;
  state.slots[capture.slot].used = state.slots[capture.slot].fade_start = state.frame;
  (void)end_order(state, capture.entity);
  return true;
}

void commit(const Plan& plan, CacheState& state) {
  state.current.resize(plan.entities, 0);
  state.previous.resize(plan.entities, 0);
  // Slots for the captures first, as they were given out; then what was evicted becomes free.
  for (const Capture& capture : plan.captures) {
    if (capture.slot >= state.slots.size()) {
      RILIEVO_EXPECTS_EQ(capture.slot, state.slots.size());
      state.slots.emplace_back();
    } else {
      RILIEVO_EXPECTS_EQ(capture.slot, state.free_slots.back());
      state.free_slots.pop_back();
    }
  }
  for (std::uint32_t slot : plan.evictions) forget(state, slot);
  state.ranges.resize(plan.entities);
  state.life_shares.resize(plan.entities);
  state.ordered.resize(plan.entities);
  for (const Capture& capture : plan.captures) {
    learn_capture(capture, state);
    if (!capture.picture.held) {  // refused
      state.free_slots.push_back(capture.slot);
      continue;
    }
    if (capture.order != 0) {
      state.ordered[capture.entity] = {capture.order, capture.slot, state.frame, capture.cost,
                                       capture.picture.bytes};
      state.orders = capture.order;
      state.ordered_cost += capture.cost;
      state.bytes += capture.picture.bytes;
      continue;
    }
    RILIEVO_EXPECTS_EQ(state.previous[capture.entity], 0u);
    state.previous[capture.entity] = state.current[capture.entity];
    state.current[capture.entity] = capture.slot + 1;
    state.slots[capture.slot] = capture.picture;
    state.bytes += capture.picture.bytes;
  }
  for (std::uint32_t slot : plan.retirements) {
    Picture& picture = state.slots[slot];
    picture.retire_start = state.frame + 1;
    picture.retire_length = std::max<std::uint16_t>(1, std::uint16_t(picture.lead / 2));
  }
  for (const DrawnPicture& drawn : plan.pictures) state.slots[drawn.slot].used = state.frame;
  state.credit = plan.credit;
  state.usual_cost = plan.usual_cost;
  state.limit = plan.limit;
  ++state.frame;
}

void learn_seen(const Plan& plan, std::span<const float> shares, CacheState& state) {
  RILIEVO_EXPECTS(shares.size() >= plan.pictures.size());
  for (std::size_t i = 0; i < plan.pictures.size(); ++i)
    state.slots[plan.pictures[i].slot].seen_share = shares[i];
}

void learn_polygons(std::span<const PolygonCost> costs, CacheState& state) {
  state.polygon_records.resize(state.current.size());
  double expected = 0, cost = 0;
  for (const PolygonCost& one : costs) {
    RILIEVO_EXPECTS(one.expected > 0 && one.cost >= 0);
    const auto share = float(one.cost / one.expected);
    PolygonRecord& record = state.polygon_records[one.entity];
    // What one frame hides the next may show: the mean of the last few.
    record.share = record.frame > 0 && state.frame - record.frame < kRecentFrames
                       ? record.share + kLearn * (share - record.share)
                       : share;
    record.frame = state.frame;
    expected += one.expected, cost += one.cost;
  }
  if (expected > 0)
    state.usual_polygon_share += kLearnUsual * (float(cost / expected) - state.usual_polygon_share);
}

void invalidate(CacheState& state, std::vector<std::uint32_t>& evictions) {
  for (Entity e = 0; e < state.ordered.size(); ++e) forget_order(state, e);
  for (std::uint32_t slot = 0; slot < state.slots.size(); ++slot)
    if (state.slots[slot].held) {
      forget(state, slot);
      evictions.push_back(slot);
    }
}

void invalidate(const Hierarchy& hierarchy, std::uint32_t object, CacheState& state,
                std::vector<std::uint32_t>& evictions) {
  for (Entity e = 0; e < state.current.size() && e < hierarchy.nodes.size(); ++e) {
    const HierarchyNode& node = hierarchy.nodes[e];
    const auto begin = hierarchy.order.begin() + node.first, end = begin + node.count;
    const bool any =
        state.current[e] != 0 || state.previous[e] != 0 || state.ordered[e].number != 0;
    if (any && std::find(begin, end, object) != end) forget_entity(state, e, evictions);
  }
}

void invalidate_moving(const Hierarchy& hierarchy, std::uint32_t object, CacheState& state,
                       std::vector<std::uint32_t>& evictions) {
  const Entity e = Entity(hierarchy.nodes.size()) + object;
  if (e < state.current.size()) forget_entity(state, e, evictions);
}

}  // namespace rilievo
