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
// A valid picture is replaced only by something that is cheaper by this share: what is about as
// good would alternate.
constexpr double kHysteresis = 0.2;

glm::dmat4 power(const glm::dmat4& m, int n) {
  glm::dmat4 result(1.0);
  for (int i = 0; i < n; ++i) result = m * result;
  return result;
}

}  // namespace

FramePlanner::FramePlanner(const PlanScene& scene, const CacheState& state, const FrameView& frame,
                           const CacheOptions& options, PlanScratch& scratch, Plan& plan)
    : tree_(scene.hierarchy),
      moving_(scene.moving),
      alternatives_(scene.alternatives),
      levels_(scene.levels),
      state_(state),
      frame_(frame),
      options_(options),
      scratch_(scratch),
      plan_(plan),
      view_(view_axes(frame, options.fade_frames + kSpreadFrames)) {}

void FramePlanner::run(CaptureMaker& maker) {
  evict_finished();
  choose();
  schedule_captures();
  make_captures(maker);
  draw();
  make_fallback(maker);
}

const Box& FramePlanner::box_of(Entity e) const { return rilievo::box_of(e, tree_, moving_); }

std::uint64_t FramePlanner::triangles_of(Entity e) const {
  return is_moving(e) ? moving_[e - nodes()].triangles : tree_.nodes[e].triangles;
}

glm::dvec3 FramePlanner::drift_of(Entity e) const {
  if (!is_moving(e)) return view_.velocity;
  // The eye's next place, carried back by what the object will have done.
  const glm::dmat4 last_from_now = glm::inverse(moving_[e - nodes()].now_from_last);
  return glm::dvec3(last_from_now * glm::dvec4(view_.eye + view_.velocity, 1)) - view_.eye;
}

FramePlanner::Level FramePlanner::level_of(Entity e, double share) const {
  const Level finest{triangles_of(e)};
  if (is_moving(e) || levels_.of_node.empty()) return finest;
  const double limit_px = share * std::min(options_.error_px, gap_limit_px(options_) / 2);
  // Of an error as small as the least, which hardly moves anything nearer to the eye.
  const double px = level_px(frame_.camera, box_of(e), levels_.first);
  const double step = std::floor(2 * std::log2(limit_px / px));
  if (!(step >= 0)) return finest;
  const LevelTable::Level& entry =
      levels_.of_node[e][std::size_t(std::min(step, double(LevelTable::kSteps - 1)))];
  const Level level{std::uint64_t(entry.triangles), double(entry.error),
                    level_px(frame_.camera, box_of(e), double(entry.error))};
  return 2 * level.triangles <= finest.triangles && level.px <= limit_px ? level : finest;
}

CaptureCost FramePlanner::estimate(Entity e) const {
  const CaptureCost fine = estimate(e, {triangles_of(e)});
  const Level level = level_of(e, kLevelShare);
  if (!(level.error > 0)) return fine;
  const CaptureCost coarse = estimate(e, level);
  if (!coarse.possible || !fine.possible) return coarse.possible ? coarse : fine;
  return picture_rate(coarse) < picture_rate(fine) ? coarse : fine;
}

CaptureCost FramePlanner::estimate(Entity e, const Level& level) const {
  if (is_moving(e) ? moving_[e - nodes()].polygons_only
                   : !tree_.nodes[e].leaf() && level.triangles > options_.picture_triangles)
    return {};
  CaptureCost estimated =
      estimate_capture_cost(view_, box_of(e), level.triangles, drift_of(e), options_,
                            expected_range(e), expected_life_share(e), level.px);
  estimated.level_error = level.error;
  // It would come when its frame is over.
  if (captures_beside(options_) && estimated.once) estimated.possible = false;
  return estimated;
}

// What it showed last, or what pictures show on the whole; and somewhat more.
DeltaRange FramePlanner::expected_range(Entity e) const {
  const DeltaRange& range = e < state_.ranges.size() && state_.ranges[e]
                                ? *state_.ranges[e]
                                : state_.usual_range[several(e) ? 1 : 0];
  const double margin = kRangeMargin * (range.farthest - range.nearest);
  return {std::max(0.0, range.nearest - margin), std::min(1.0, range.farthest + margin)};
}

double FramePlanner::expected_life_share(Entity e) const {
  return double(e < state_.life_shares.size() && state_.life_shares[e]
                    ? *state_.life_shares[e]
                    : state_.usual_life_share[several(e) ? 1 : 0]);
}

const Picture* FramePlanner::picture_of(const std::vector<std::uint32_t>& by_entity,
                                        Entity e) const {
  if (e >= by_entity.size() || by_entity[e] == 0) return nullptr;
  const std::uint32_t slot = by_entity[e] - 1;
  return scratch_.dropped[slot] ? nullptr : &state_.slots[slot];
}

// The bounds now and, as long as the motion goes on as it is, the frames until they pass the
// limits; at most Picture::lead of them are looked into.
const PlanScratch::Checked& FramePlanner::check(std::uint32_t slot) {
  PlanScratch::Checked& checked = scratch_.checked[slot];
  if (checked.frame == state_.frame) return checked;
  const Picture& picture = state_.slots[slot];
  const MovingObject* object =
      is_moving(picture.entity) ? &moving_[picture.entity - nodes()] : nullptr;
  const glm::dmat4 motion = motion_since(picture, tree_, moving_);
  const double limit = limit_px(picture, options_), gap_limit = gap_limit_px(options_);
  const auto holds_at = [&](int k, double factor = 1) {
    const Camera camera = k == 0 ? frame_.camera : camera_ahead(frame_, k);
    const RigidMotion moved{object ? power(object->now_from_last, k) * motion : motion};
    const double off_px = level_px(camera, box_of(picture.entity), picture.level_error);
    const double bound_px = bound_total_px(picture.geometry, camera, moved) + off_px;
    const double gap_px = bound_gap_px(picture.geometry, picture.gaps, camera, moved) + 2 * off_px;
    if (k == 0) checked = {state_.frame, bound_px, gap_px, 0};
    if (picture.clipped && !shows_frame(picture.geometry.capture, camera, box_of(picture.entity)))
      return false;
    return bound_px <= factor * limit && gap_px <= factor * gap_limit;
  };
  if (!holds_at(0, late_at_hand(options_)) || (object && object->polygons_only)) {
    checked.now_px = INFINITY;
    return checked;
  }
  checked.late = checked.now_px > limit || checked.gap_px > gap_limit;
  // Texels that have become too small for pixels alias: time for larger ones.
  if (checked.late || minification(picture.geometry, frame_.camera) > kMostMinified) return checked;
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
  RILIEVO_EXPECTS(state_.slots[slot].held && !scratch_.dropped[slot]);
  scratch_.dropped[slot] = 1;
  plan_.evictions.push_back(slot);
  plan_.bytes -= state_.slots[slot].bytes;
}

// Pictures that have been faded out, and those whose successors have been faded in.
void FramePlanner::evict_finished() {
  for (std::uint32_t slot = 0; slot < state_.slots.size(); ++slot) {
    const Picture& picture = state_.slots[slot];
    if (!picture.held) continue;
    if (picture.retire_length > 0 && state_.frame >= picture.retire_start + picture.retire_length) {
      drop(slot);
    } else if (state_.previous[picture.entity] == slot + 1) {
      const std::uint32_t successor = state_.current[picture.entity];
      if (successor == 0 || state_.frame >= state_.slots[successor - 1].fade_start +
                                                state_.slots[successor - 1].fade_length)
        drop(slot);
    }
  }
}

FramePlanner::Standing FramePlanner::stands_for(Entity e, double cost) const {
  Standing standing{nullptr, 0, cost};
  if (alternatives_.of_entity.empty()) return standing;
  const double pixels = covered_pixels(view_, box_of(e));
  for (const std::uint32_t i : alternatives_.of_entity[e]) {
    const Alternative& candidate = alternatives_.list[i];
    const double drawn = candidate.cost.fixed + pixels * candidate.cost.per_pixel;
    if (!candidate.present || drawn >= standing.cost) continue;
    const double bound_px = candidate.error.bound_px(candidate.world_from_capture, frame_.camera);
    if (bound_px > options_.error_px) continue;
    const double gap_px = candidate.error.gap_px(candidate.world_from_capture, frame_.camera);
    if (gap_px <= gap_limit_px(options_)) standing = {&candidate, bound_px, drawn, gap_px};
  }
  return standing;
}

// Of one object, static or moving.
double FramePlanner::polygon_cost(Entity e) const {
  return polygon_cost(e, level_of(e, kPolygonLevelShare));
}

double FramePlanner::polygon_cost(Entity e, const Level& level) const {
  return polygon_share(e) * expected_polygon_cost(e, level);
}

double FramePlanner::polygon_share(Entity e) const {
  const double seen = kHiddenShare + (1 - kHiddenShare) * seen_share_;
  if (e < state_.polygon_records.size())
    if (const PolygonRecord& record = state_.polygon_records[e];
        record.frame > 0 && state_.frame - record.frame < kKnownFrames)
      return seen * double(record.share);
  return seen * double(state_.usual_polygon_share);
}

double FramePlanner::expected_polygon_cost(Entity e, const Level& level) const {
  return options_.cost.object + double(level.triangles) +
         options_.cost.polygon_pixel * covered_pixels(view_, box_of(e));
}

FramePlanner::Costs FramePlanner::evaluate_below(Entity e) {
  if (!is_moving(e) && !tree_.nodes[e].leaf()) {
    const Costs a = evaluate(e + 1), b = evaluate(tree_.nodes[e].second_child);
    return {a.best + b.best, a.now + b.now};
  }
  const double cost = stands_for(e, polygon_cost(e)).cost;
  return {cost, may_see(view_.now, box_of(e)) ? cost : 0};
}

FramePlanner::Costs FramePlanner::evaluate(Entity e) {
  scratch_.now_cost[e] = 0;
  scratch_.choice[e] = kNothing;
  if (!may_see(view_.now, box_of(e)) && !may_see(view_.ahead, box_of(e))) return {0, 0};

  const Picture* picture = picture_of(state_.current, e);
  const bool at_hand = valid(picture);
  if (at_hand && picture->retire_length == 0 &&
      check(slot_of(picture)).remaining >= picture->lead) {
    scratch_.choice[e] = kKeep;
    scratch_.now_cost[e] = float(picture->draw_cost);
    return {picture->rate * (1 - kHysteresis), picture->draw_cost};
  }
  double own = INFINITY;
  const bool retiring = at_hand && picture->retire_length > 0;
  if (!retiring)
    if (const CaptureCost estimated = estimate(e); estimated.possible)
      own = is_ordered(e) ? estimated.draw : picture_rate(estimated);
  const double seen_before = seen_share_;
  if (at_hand && picture->used + 1 == state_.frame) seen_share_ = double(picture->seen_share);
  Costs below = evaluate_below(e);
  seen_share_ = seen_before;
  scratch_.choice[e] = own < below.best ? kCapture : kBelow;
  if (several(e))
    if (const Standing standing = stands_for(e, std::min(own, below.best)); standing.alternative) {
      scratch_.choice[e] = kStandIn;
      below = {standing.cost, may_see(view_.now, box_of(e)) ? standing.cost : 0};
    }
  const double now = at_hand ? std::min(picture->draw_cost, below.now) : below.now;
  scratch_.now_cost[e] = float(now);
  return {std::min(own, below.best), now};
}

void FramePlanner::enqueue(Entity e, double deadline, bool covered) {
  const CaptureCost estimated = estimate(e);
  if (estimated.once && !may_see(view_.now, box_of(e))) return;  // it would be of no use then
  const double benefit = std::max(double(scratch_.now_cost[e]) - estimated.draw, 1e-3);
  bool due = false;
  if (!covered && !may_see(view_.now, box_of(e))) {
    deadline = kSpreadFrames;  // it comes into view
  } else if (!covered) {
    const double pays_in = estimated.capture / benefit;
    due = pays_in < kPaysSoon;
    deadline =
        due ? (captures_beside(options_) ? kFallbackDeadline : 0.0) : std::min(pays_in, kPaysLate);
  }
  scratch_.requests.push_back({e, float(deadline), float(benefit / estimated.capture),
                               float(estimated.capture), float(estimated.texels_in_frame), due});
  full_bytes_ += estimated.texels * options_.bytes_per_texel;
}

// Asks for the captures that the choices need; `deadline`: frames until what covers this now ends,
// if anything does; negative: it is late. Is everything at hand?
bool FramePlanner::request(Entity e, double deadline, bool covered) {
  if (scratch_.choice[e] == kNothing) return true;
  const Picture* picture = picture_of(state_.current, e);
  if (scratch_.choice[e] == kKeep) {
    full_bytes_ += double(picture->bytes) / (picture->texel_scale * picture->texel_scale);
    return true;
  }
  const bool at_hand = valid(picture);
  if (at_hand) {
    // The fade takes place while the old picture still holds.
    const PlanScratch::Checked& checked = check(slot_of(picture));
    const double fade = fade_length(int(picture->lead - latency()), options_);
    deadline = std::max(0.0, checked.remaining - fade - latency());
    if (checked.late)
      deadline = 1 - std::max(checked.now_px / limit_px(*picture, options_),
                              checked.gap_px / gap_limit_px(options_));
    covered = true;
  }
  if (scratch_.choice[e] == kCapture) {
    enqueue(e, deadline, covered);
    return false;
  }
  bool ready = true;
  if (scratch_.choice[e] == kBelow && several(e)) {
    ready = request(e + 1, deadline, covered);
    ready = request(tree_.nodes[e].second_child, deadline, covered) && ready;
  }
  if (at_hand && ready && picture->retire_length == 0)
    plan_.retirements.push_back(slot_of(picture));
  return ready;
}

void FramePlanner::choose() {
  if (nodes() > 0) {
    cost_at_hand_ += evaluate(0).now;
    request(0, 0, false);
  }
  for (Entity e = nodes(); e < plan_.entities; ++e) {
    cost_at_hand_ += evaluate(e).now;
    request(e, 0, false);
  }
  limit_ = find_limit(options_.spikes, frame_costs());
  plan_.limit = limit_.limit;
}

bool FramePlanner::pictures_cover(Entity e) {
  if (!may_see(view_.now, box_of(e))) return true;
  return scratch_.captured[e] != 0 || valid(picture_of(state_.current, e)) ||
         pictures_cover_below(e);
}

bool FramePlanner::pictures_cover_below(Entity e) {
  return !is_moving(e) && !tree_.nodes[e].leaf() && pictures_cover(e + 1) &&
         pictures_cover(tree_.nodes[e].second_child);
}

void FramePlanner::emit(std::uint32_t slot, Entity e, const PlanScratch::Checked& checked,
                        float from, float to) {
  if (!(from < to)) return;
  plan_.pictures.push_back({slot, from, to, float(checked.now_px), float(checked.gap_px)});
  plan_.cost += scratch_.captured[e] && plan_.captures[scratch_.captured[e] - 1].slot == slot
                    ? plan_.captures[scratch_.captured[e] - 1].picture.draw_cost
                    : state_.slots[slot].draw_cost;
  ++(is_moving(e) || tree_.nodes[e].leaf() ? plan_.single : plan_.hierarchy);
}

void FramePlanner::emit(const Standing& standing) {
  plan_.alternatives.push_back({std::uint32_t(standing.alternative - alternatives_.list.data()),
                                float(standing.bound_px), float(standing.gap_px)});
  plan_.cost += standing.cost;
}

void FramePlanner::draw_below(Entity e, float from, float to) {
  if (several(e)) {
    if (scratch_.choice[e] == kStandIn && from <= 0 && to >= 1)
      if (const Standing standing = stands_for(e, std::numeric_limits<double>::infinity());
          standing.alternative)
        return emit(standing);
    draw(e + 1, from, to);
    draw(tree_.nodes[e].second_child, from, to);
    return;
  }
  if (falls_back(e, from, to)) {
    plan_.fallback.objects.push_back(tree_.order[tree_.nodes[e].first]);
    scratch_.boxes.push_back(box_of(e));
    return;
  }
  const Level level = level_of(e, kPolygonLevelShare);
  const double expected = expected_polygon_cost(e, level), cost = polygon_share(e) * expected;
  // An alternative is for all pixels: what fades goes with polygons.
  if (from <= 0 && to >= 1)
    if (const Standing standing = stands_for(e, cost); standing.alternative) return emit(standing);
  if (is_moving(e)) {
    plan_.moving_polygons.push_back({e - nodes(), from, to, 0, float(expected)});
  } else {
    plan_.polygons.push_back(
        {tree_.order[tree_.nodes[e].first], from, to, float(level.error), float(expected)});
    scratch_.polygons.push_back({e, float(cost), level.triangles});
  }
  plan_.cost += cost;
  plan_.polygon_triangles += level.triangles;
  plan_.polygon_px = std::max(plan_.polygon_px, level.px);
}

bool FramePlanner::may_fade_over_below(Entity e) {
  return triangles_of(e) <= kFadedTriangles || pictures_cover_below(e);
}

// A picture fades in over the one before it, or over what is below it, and out over what is below:
// that gets the rest of the pixels. Not over many polygons: they would cost the time that the
// picture saves.
void FramePlanner::draw(Entity e, float from, float to) {
  if (!may_see(view_.now, box_of(e))) return;
  const Capture* capture =
      scratch_.captured[e] ? &plan_.captures[scratch_.captured[e] - 1] : nullptr;
  const Picture* old = picture_of(capture ? state_.current : state_.previous, e);
  const Picture* picture = capture ? &capture->picture : picture_of(state_.current, e);
  if (!picture || (!capture && !valid(picture))) {
    fallback_depth_ += scratch_.fallback[e];
    draw_below(e, from, to);
    fallback_depth_ -= scratch_.fallback[e];
    return;
  }

  const std::uint32_t slot = capture ? capture->slot : slot_of(picture);
  const float frames = float(state_.frame - picture->fade_start) + 1;
  float share = std::min(1.0f, frames / float(picture->fade_length));
  const bool over_old = share < 1 && valid(old);
  if (!over_old && picture->retire_length > 0)
    share = std::min(share, 1 - (float(state_.frame - picture->retire_start) + 1) /
                                    (float(picture->retire_length) + 1));
  if (share < 1 && !over_old && !may_fade_over_below(e)) share = 1;

  const float middle = share < 1 ? from + (to - from) * share : to;
  if (capture)
    emit(slot, e, {.now_px = capture->bound_px, .gap_px = capture->gap_px}, from, middle);
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
  for (Entity e = nodes(); e < plan_.entities; ++e) draw(e, 0, 1);
  if (!captures_beside(options_))
    for (const Capture& capture : plan_.captures) plan_.cost += capture.cost;
  limit_cost();
  if (state_.usual_cost > 0)
    plan_.usual_cost = state_.usual_cost + kFollowCost * (plan_.cost - state_.usual_cost);
  else if (state_.frame > 0)  // the first is not usual
    plan_.usual_cost = plan_.cost;
}

}  // namespace rilievo
