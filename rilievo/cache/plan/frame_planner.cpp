#include "rilievo/cache/plan/frame_planner.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

enum Choice : std::uint8_t {
  kNothing,  // neither seen now nor soon
  kKeep,     // the picture at hand
  kCapture,  // a new picture
  kBelow,    // the children; polygons, or what stands for them, of an object
  kStandIn,  // an alternative, for all objects of an inner node
};

// A capture that pays within so many frames is made at once, others when there is time.
constexpr double kRangeMargin = 0.1;
constexpr double kPaysSoon = 4, kPaysLate = 16;
// What is in the fallback is as urgent as a picture that is late by this: twice its limit.
constexpr double kFallbackDeadline = -1;
// For so many frames it is known what drawing an entity as polygons took.
constexpr std::uint32_t kKnownFrames = 120;
// Of an object that others hide, so much of the cost as polygons remains: runs of triangles are
// looked at.
constexpr double kHiddenShare = 0.15;
// How soon CacheState::usual_cost follows what frames cost.
constexpr double kFollowCost = 0.2;

glm::dmat4 power(const glm::dmat4& m, int n) {
  glm::dmat4 result(1.0);
  for (int i = 0; i < n; ++i) result = m * result;
  return result;
}

}  // namespace

FramePlanner::FramePlanner(const Hierarchy& tree_, std::span<const MovingObject> moving_,
                           const Alternatives& alternatives_, const LevelTable& levels_,
                           const CacheState& state_, const FrameView& frame_,
                           const CacheOptions& options_, PlanScratch& scratch_, Plan& plan_)
    : tree(tree_),
      moving(moving_),
      alternatives(alternatives_),
      levels(levels_),
      state(state_),
      frame(frame_),
      options(options_),
      scratch(scratch_),
      plan(plan_),
      view(view_axes(frame_, options_.fade_frames + options_.spread_frames)) {}

const Box& FramePlanner::box_of(Entity e) const { return rilievo::box_of(e, tree, moving); }

std::uint64_t FramePlanner::triangles_of(Entity e) const {
  return is_moving(e) ? moving[e - nodes()].triangles : tree.nodes[e].triangles;
}

glm::dvec3 FramePlanner::drift_of(Entity e) const {
  if (!is_moving(e)) return view.velocity;
  // The eye's next place, carried back by what the object will have done.
  const glm::dmat4 last_from_now = glm::inverse(moving[e - nodes()].now_from_last);
  return glm::dvec3(last_from_now * glm::dvec4(view.eye + view.velocity, 1)) - view.eye;
}

FramePlanner::Level FramePlanner::level_of(Entity e, double share) const {
  const Level finest{triangles_of(e)};
  if (is_moving(e) || levels.of_node.empty()) return finest;
  const double limit_px = share * std::min(options.error_px, gap_limit_px(options) / 2);
  // Of an error as small as the least, which hardly moves anything nearer to the eye.
  const double px = level_px(frame.camera, box_of(e), levels.first);
  const double step = std::floor(2 * std::log2(limit_px / px));
  if (!(step >= 0)) return finest;
  const LevelTable::Level& entry =
      levels.of_node[e][std::size_t(std::min(step, double(LevelTable::kSteps - 1)))];
  const Level level{std::uint64_t(entry.triangles), double(entry.error),
                    level_px(frame.camera, box_of(e), double(entry.error))};
  return 2 * level.triangles <= finest.triangles && level.px <= limit_px ? level : finest;
}

CaptureCost FramePlanner::estimate(Entity e) const {
  const CaptureCost fine = estimate(e, {triangles_of(e)});
  const Level level = level_of(e, options.level_share);
  if (!(level.error > 0)) return fine;
  const CaptureCost coarse = estimate(e, level);
  if (!coarse.possible || !fine.possible) return coarse.possible ? coarse : fine;
  return picture_rate(coarse, options) < picture_rate(fine, options) ? coarse : fine;
}

CaptureCost FramePlanner::estimate(Entity e, const Level& level) const {
  if (is_moving(e) ? moving[e - nodes()].polygons_only
                   : !tree.nodes[e].leaf() && level.triangles > options.picture_triangles)
    return {};
  CaptureCost estimated =
      estimate_capture_cost(view, box_of(e), level.triangles, drift_of(e), options,
                            expected_range(e), expected_life_share(e), level.px);
  estimated.level_error = level.error;
  // It would come when its frame is over.
  if (captures_beside(options) && estimated.once) estimated.possible = false;
  return estimated;
}

// What it showed last, or what pictures show on the whole; and somewhat more.
DeltaRange FramePlanner::expected_range(Entity e) const {
  const DeltaRange& range = e < state.ranges.size() && state.ranges[e]
                                ? *state.ranges[e]
                                : state.usual_range[several(e) ? 1 : 0];
  const double margin = kRangeMargin * (range.farthest - range.nearest);
  return {std::max(0.0, range.nearest - margin), std::min(1.0, range.farthest + margin)};
}

double FramePlanner::expected_life_share(Entity e) const {
  return double(e < state.life_shares.size() && state.life_shares[e]
                    ? *state.life_shares[e]
                    : state.usual_life_share[several(e) ? 1 : 0]);
}

const Picture* FramePlanner::picture_of(const std::vector<std::uint32_t>& by_entity,
                                        Entity e) const {
  if (e >= by_entity.size() || by_entity[e] == 0) return nullptr;
  const std::uint32_t slot = by_entity[e] - 1;
  return scratch.dropped[slot] ? nullptr : &state.slots[slot];
}

// The bounds now and, as long as the motion goes on as it is, the frames until they pass the
// limits; at most Picture::lead of them are looked into.
const PlanScratch::Checked& FramePlanner::check(std::uint32_t slot) {
  PlanScratch::Checked& checked = scratch.checked[slot];
  if (checked.frame == state.frame) return checked;
  const Picture& picture = state.slots[slot];
  const MovingObject* object =
      is_moving(picture.entity) ? &moving[picture.entity - nodes()] : nullptr;
  const glm::dmat4 motion = motion_since(picture, tree, moving);
  const double limit = limit_px(picture, options), gap_limit = gap_limit_px(options);
  const auto holds_at = [&](int k, double factor = 1) {
    const Camera camera = k == 0 ? frame.camera : camera_ahead(frame, k);
    const RigidMotion moved{object ? power(object->now_from_last, k) * motion : motion};
    const double off_px = level_px(camera, box_of(picture.entity), picture.level_error);
    const double bound_px = bound_total_px(picture.geometry, camera, moved) + off_px;
    const double gap_px = bound_gap_px(picture.geometry, picture.gaps, camera, moved) + 2 * off_px;
    if (k == 0) checked = {state.frame, bound_px, gap_px, 0};
    if (picture.clipped && !shows_frame(picture.geometry.capture, camera, box_of(picture.entity)))
      return false;
    return bound_px <= factor * limit && gap_px <= factor * gap_limit;
  };
  if (!holds_at(0, late_factor(options)) || (object && object->polygons_only)) {
    checked.now_px = INFINITY;
    return checked;
  }
  checked.late = checked.now_px > limit || checked.gap_px > gap_limit;
  // Texels that have become too small for pixels alias: time for larger ones.
  if (checked.late || minification(picture.geometry, frame.camera) > kMostMinified) return checked;
  if (holds_at(picture.lead)) {
    checked.remaining = picture.lead;
    return checked;
  }
  int lives = 0, ends = picture.lead;
  while (ends - lives > 1) {
    const int middle = (lives + ends) / 2;
    (holds_at(middle) ? lives : ends) = middle;
  }
  checked.remaining = lives;
  return checked;
}

bool FramePlanner::valid(const Picture* picture) {
  return picture && std::isfinite(check(slot_of(picture)).now_px);
}

void FramePlanner::drop(std::uint32_t slot) {
  RILIEVO_EXPECTS(state.slots[slot].held && !scratch.dropped[slot]);
  scratch.dropped[slot] = 1;
  plan.evictions.push_back(slot);
  plan.bytes -= state.slots[slot].bytes;
}

// Pictures that have been faded out, and those whose successors have been faded in.
void FramePlanner::evict_finished() {
  for (std::uint32_t slot = 0; slot < state.slots.size(); ++slot) {
    const Picture& picture = state.slots[slot];
    if (!picture.held) continue;
    if (picture.retire_length > 0 && state.frame >= picture.retire_start + picture.retire_length) {
      drop(slot);
    } else if (state.previous[picture.entity] == slot + 1) {
      const std::uint32_t successor = state.current[picture.entity];
      if (successor == 0 || state.frame >= state.slots[successor - 1].fade_start +
                                               state.slots[successor - 1].fade_length)
        drop(slot);
    }
  }
}

FramePlanner::Standing FramePlanner::stands_for(Entity e, double cost) const {
  Standing standing{nullptr, 0, cost};
  if (alternatives.of_entity.empty()) return standing;
  const double pixels = covered_pixels(view, box_of(e));
  for (const std::uint32_t i : alternatives.of_entity[e]) {
    const Alternative& candidate = alternatives.list[i];
    const double drawn = candidate.cost.fixed + pixels * candidate.cost.per_pixel;
    if (!candidate.present || drawn >= standing.cost) continue;
    const double bound_px = candidate.error.bound_px(candidate.world_from_capture, frame.camera);
    if (bound_px > options.error_px) continue;
    const double gap_px = candidate.error.gap_px(candidate.world_from_capture, frame.camera);
    if (gap_px <= gap_limit_px(options)) standing = {&candidate, bound_px, drawn, gap_px};
  }
  return standing;
}

// Of one object, static or moving.
double FramePlanner::polygon_cost(Entity e) const {
  return polygon_cost(e, level_of(e, options.polygon_level_share));
}

double FramePlanner::polygon_cost(Entity e, const Level& level) const {
  return polygon_share(e) * expected_polygon_cost(e, level);
}

double FramePlanner::polygon_share(Entity e) const {
  const double seen = kHiddenShare + (1 - kHiddenShare) * seen_share_;
  if (e < state.polygon_records.size())
    if (const PolygonRecord& record = state.polygon_records[e];
        record.frame > 0 && state.frame - record.frame < kKnownFrames)
      return seen * double(record.share);
  return seen * double(state.usual_polygon_share);
}

double FramePlanner::expected_polygon_cost(Entity e, const Level& level) const {
  return options.cost.object + double(level.triangles) +
         options.cost.polygon_pixel * covered_pixels(view, box_of(e));
}

FramePlanner::Costs FramePlanner::evaluate_below(Entity e) {
  if (!is_moving(e) && !tree.nodes[e].leaf()) {
    const Costs a = evaluate(e + 1), b = evaluate(tree.nodes[e].second_child);
    return {a.best + b.best, a.now + b.now};
  }
  const double cost = stands_for(e, polygon_cost(e)).cost;
  return {cost, may_see(view.now, box_of(e)) ? cost : 0};
}

FramePlanner::Costs FramePlanner::evaluate(Entity e) {
  scratch.now_cost[e] = 0;
  scratch.choice[e] = kNothing;
  if (!may_see(view.now, box_of(e)) && !may_see(view.ahead, box_of(e))) return {0, 0};

  const Picture* picture = picture_of(state.current, e);
  const bool at_hand = valid(picture);
  if (at_hand && picture->retire_length == 0 &&
      check(slot_of(picture)).remaining >= picture->lead) {
    scratch.choice[e] = kKeep;
    scratch.now_cost[e] = float(picture->draw_cost);
    return {picture->rate * (1 - options.hysteresis), picture->draw_cost};
  }
  double own = INFINITY;
  const bool retiring = at_hand && picture->retire_length > 0;
  if (!retiring)
    if (const CaptureCost estimated = estimate(e); estimated.possible)
      own = is_ordered(e) ? estimated.draw : picture_rate(estimated, options);
  const double seen_share = seen_share_;
  if (at_hand && picture->used + 1 == state.frame) seen_share_ = double(picture->seen_share);
  Costs below = evaluate_below(e);
  seen_share_ = seen_share;
  scratch.choice[e] = own < below.best ? kCapture : kBelow;
  if (several(e))
    if (const Standing standing = stands_for(e, std::min(own, below.best)); standing.alternative) {
      scratch.choice[e] = kStandIn;
      below = {standing.cost, may_see(view.now, box_of(e)) ? standing.cost : 0};
    }
  const double now = at_hand ? std::min(picture->draw_cost, below.now) : below.now;
  scratch.now_cost[e] = float(now);
  return {std::min(own, below.best), now};
}

void FramePlanner::enqueue(Entity e, double deadline, bool covered) {
  const CaptureCost estimated = estimate(e);
  if (estimated.once && !may_see(view.now, box_of(e))) return;  // it would be of no use then
  const double benefit = std::max(double(scratch.now_cost[e]) - estimated.draw, 1e-3);
  bool due = false;
  if (!covered && !may_see(view.now, box_of(e))) {
    deadline = options.spread_frames;  // it comes into view
  } else if (!covered) {
    const double pays_in = estimated.capture / benefit;
    due = pays_in < kPaysSoon;
    deadline =
        due ? (captures_beside(options) ? kFallbackDeadline : 0.0) : std::min(pays_in, kPaysLate);
  }
  scratch.requests.push_back({e, float(deadline), float(benefit / estimated.capture),
                              float(estimated.capture), float(estimated.texels_in_frame), due});
  full_bytes += estimated.texels * options.bytes_per_texel;
}

// Asks for the captures that the choices need; `deadline`: frames until what covers this now ends,
// if anything does; negative: it is late. Is everything at hand?
bool FramePlanner::request(Entity e, double deadline, bool covered) {
  if (scratch.choice[e] == kNothing) return true;
  const Picture* picture = picture_of(state.current, e);
  if (scratch.choice[e] == kKeep) {
    full_bytes += double(picture->bytes) / (picture->texel_scale * picture->texel_scale);
    return true;
  }
  const bool at_hand = valid(picture);
  if (at_hand) {
    // The fade takes place while the old picture still holds.
    const PlanScratch::Checked& checked = check(slot_of(picture));
    const double fade = fade_length(int(picture->lead - latency()), options);
    deadline = std::max(0.0, checked.remaining - fade - latency());
    if (checked.late)
      deadline = 1 - std::max(checked.now_px / limit_px(*picture, options),
                              checked.gap_px / gap_limit_px(options));
    covered = true;
  }
  if (scratch.choice[e] == kCapture) {
    enqueue(e, deadline, covered);
    return false;
  }
  bool ready = true;
  if (scratch.choice[e] == kBelow && several(e)) {
    ready = request(e + 1, deadline, covered);
    ready = request(tree.nodes[e].second_child, deadline, covered) && ready;
  }
  if (at_hand && ready && picture->retire_length == 0) plan.retirements.push_back(slot_of(picture));
  return ready;
}

void FramePlanner::choose() {
  if (nodes() > 0) {
    cost_at_hand += evaluate(0).now;
    request(0, 0, false);
  }
  for (Entity e = nodes(); e < plan.entities; ++e) {
    cost_at_hand += evaluate(e).now;
    request(e, 0, false);
  }
  find_limit();
}

bool FramePlanner::pictures_cover(Entity e) {
  if (!may_see(view.now, box_of(e))) return true;
  return scratch.captured[e] != 0 || valid(picture_of(state.current, e)) || pictures_cover_below(e);
}

bool FramePlanner::pictures_cover_below(Entity e) {
  return !is_moving(e) && !tree.nodes[e].leaf() && pictures_cover(e + 1) &&
         pictures_cover(tree.nodes[e].second_child);
}

void FramePlanner::emit(std::uint32_t slot, Entity e, const PlanScratch::Checked& checked,
                        float from, float to) {
  if (!(from < to)) return;
  plan.pictures.push_back({slot, from, to, float(checked.now_px), float(checked.gap_px)});
  plan.cost += scratch.captured[e] && plan.captures[scratch.captured[e] - 1].slot == slot
                   ? plan.captures[scratch.captured[e] - 1].picture.draw_cost
                   : state.slots[slot].draw_cost;
  ++(is_moving(e) || tree.nodes[e].leaf() ? plan.single : plan.hierarchy);
}

void FramePlanner::emit(const Standing& standing) {
  plan.alternatives.push_back({std::uint32_t(standing.alternative - alternatives.list.data()),
                               float(standing.bound_px), float(standing.gap_px)});
  plan.cost += standing.cost;
}

void FramePlanner::draw_below(Entity e, float from, float to) {
  if (several(e)) {
    if (scratch.choice[e] == kStandIn && from <= 0 && to >= 1)
      if (const Standing standing = stands_for(e, std::numeric_limits<double>::infinity());
          standing.alternative)
        return emit(standing);
    draw(e + 1, from, to);
    draw(tree.nodes[e].second_child, from, to);
    return;
  }
  if (falls_back(e, from, to)) {
    plan.fallback.objects.push_back(tree.order[tree.nodes[e].first]);
    scratch.boxes.push_back(box_of(e));
    return;
  }
  const Level level = level_of(e, options.polygon_level_share);
  const double expected = expected_polygon_cost(e, level), cost = polygon_share(e) * expected;
  // An alternative is for all pixels: what fades goes with polygons.
  if (from <= 0 && to >= 1)
    if (const Standing standing = stands_for(e, cost); standing.alternative) return emit(standing);
  if (is_moving(e)) {
    plan.moving_polygons.push_back({e - nodes(), from, to, 0, float(expected)});
  } else {
    plan.polygons.push_back(
        {tree.order[tree.nodes[e].first], from, to, float(level.error), float(expected)});
    scratch.polygons.push_back({e, float(cost), level.triangles});
  }
  plan.cost += cost;
  plan.polygon_triangles += level.triangles;
  plan.polygon_px = std::max(plan.polygon_px, level.px);
}

bool FramePlanner::may_fade_over_below(Entity e) {
  return triangles_of(e) <= kFadedTriangles || pictures_cover_below(e);
}

// A picture fades in over the one before it, or over what is below it, and out over what is below:
// that gets the rest of the pixels. Not over many polygons: they would cost the time that the
// picture saves.
void FramePlanner::draw(Entity e, float from, float to) {
  if (!may_see(view.now, box_of(e))) return;
  const Capture* capture = scratch.captured[e] ? &plan.captures[scratch.captured[e] - 1] : nullptr;
  const Picture* old = picture_of(capture ? state.current : state.previous, e);
  const Picture* picture = capture ? &capture->picture : picture_of(state.current, e);
  if (!picture || (!capture && !valid(picture))) {
    fallback_depth_ += scratch.fallback[e];
    draw_below(e, from, to);
    fallback_depth_ -= scratch.fallback[e];
    return;
  }

  const std::uint32_t slot = capture ? capture->slot : slot_of(picture);
  const float frames = float(state.frame - picture->fade_start) + 1;
  float share = std::min(1.0f, frames / float(picture->fade_length));
  const bool over_old = share < 1 && valid(old);
  if (!over_old && picture->retire_length > 0)
    share = std::min(share, 1 - (float(state.frame - picture->retire_start) + 1) /
                                    (float(picture->retire_length) + 1));
  if (share < 1 && !over_old && !may_fade_over_below(e)) share = 1;

  const float middle = share < 1 ? from + (to - from) * share : to;
  if (capture)  // its gaps are known only when it is made
    emit(slot, e, {.now_px = bound_total_px(picture->geometry, frame.camera) + capture->level_px},
         from, middle);
  else
    emit(slot, e, check(slot), from, middle);
  if (!(middle < to)) return;
  if (over_old)
    emit(slot_of(old), e, check(slot_of(old)), middle, to);
  else
    draw_below(e, middle, to);
}

void FramePlanner::draw() {
  if (nodes() > 0) draw(0, 0, 1);
  for (Entity e = nodes(); e < plan.entities; ++e) draw(e, 0, 1);
  if (!captures_beside(options))
    for (const Capture& capture : plan.captures) plan.cost += capture.cost;
  limit_cost();
  if (state.usual_cost > 0)
    plan.usual_cost = state.usual_cost + kFollowCost * (plan.cost - state.usual_cost);
  else if (state.frame > 0)  // the first is not usual
    plan.usual_cost = plan.cost;
  if (!plan.fallback.objects.empty()) finish_fallback();
}

}  // namespace rilievo
