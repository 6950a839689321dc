// An even pace: requests with deadlines d_1 <= d_2 <= ... and costs c_i can all be met at the
// constant rate
//
//   max over k of (c_1 + ... + c_k) / d_k
//
// and at no lower one. Each frame saves up that much; what is saved up pays for the next request.
// So captures are made no earlier than they must be, and a frame in which many pictures end has
// been prepared for by those before.

#include <algorithm>
#include <cmath>
#include <span>

#include "rilievo/cache/plan/fallback.h"
#include "rilievo/cache/plan/frame_planner.h"

namespace rilievo {
namespace {

// Of the memory, this much is planned for; the rest holds pictures that fade out.
constexpr double kPlannedMemory = 0.8;
constexpr double kCoarsest = 0.125;
// So many captures are made in one frame, whatever they cost: a bound on what the store and the
// plan are asked for.
constexpr std::size_t kMostCaptures = 1000;
constexpr std::uint64_t kMaxFadedTriangles = 10'000;  // begun in one frame

}  // namespace

// What a frame's captures may cost, in the units of their estimates: drawn triangles.
double FramePlanner::capture_budget() const {
  const double least = double(options_.capture_triangles) * options_.cost.capture_triangle,
               budget = options_.spikes.max_spike > 0
                            ? std::min(least, limit_.capture_room)
                            : std::max(least, options_.capture_share * cost_at_hand_);
  return late_at_hand(options_) > 1 ? std::min(budget, kCatchUpShare * cost_at_hand_) : budget;
}

// Makes room for `bytes` by dropping pictures that this frame does not need, the longest unused
// first; in the end the picture that the new one replaces.
bool FramePlanner::make_room(std::uint64_t bytes, Entity e) {
  const auto fits = [&] { return plan_.bytes + bytes <= options_.memory_bytes; };
  if (fits()) return true;
  std::vector<std::uint32_t>& idle = scratch_.idle;
  if (idle.empty()) {
    // Gathered once a frame, the first to go last.
    for (std::uint32_t slot = 0; slot < state_.slots.size(); ++slot) {
      const PlanScratch::Checked& checked = scratch_.checked[slot];
      const bool needed = checked.frame == state_.frame && std::isfinite(checked.now_px);
      if (state_.slots[slot].held && !needed && !scratch_.dropped[slot]) idle.push_back(slot);
    }
    std::sort(idle.begin(), idle.end(), [&](std::uint32_t a, std::uint32_t b) {
      const std::uint32_t used_a = state_.slots[a].used, used_b = state_.slots[b].used;
      return used_a != used_b ? used_a > used_b : a > b;
    });
    idle.insert(idle.begin(), 0xFFFFFFFFu);  // a sentinel: gathered, if nothing else
  }
  while (!fits() && idle.size() > 1) {
    if (!scratch_.dropped[idle.back()]) drop(idle.back());
    idle.pop_back();
  }
  if (!fits() && !captures_beside(options_))
    if (const Picture* old = picture_of(state_.current, e)) drop(slot_of(old));
  return fits();
}

std::uint32_t FramePlanner::new_slot() const {
  // Freed in this frame, free before, or new: as commit() will find them.
  const std::size_t taken = plan_.captures.size();
  if (taken < state_.free_slots.size())
    return state_.free_slots[state_.free_slots.size() - 1 - taken];
  return std::uint32_t(state_.slots.size() + taken - state_.free_slots.size());
}

bool FramePlanner::capture(Entity e, double cost) {
  const CaptureCost estimated = estimate(e);
  const bool clip = estimated.once && !is_moving(e);
  const double scale = plan_.texel_scale;
  const glm::dvec3 drift = drift_of(e);
  const PlacedPicture placed =
      place_picture(view_, box_of(e), estimated, drift, scale, options_, expected_range(e), clip);
  if (!placed.good) return false;
  const std::uint64_t bytes = picture_bytes(placed.geometry.capture, options_);
  if (!make_room(bytes, e)) {
    ++plan_.starved;
    return false;
  }
  // Captured again before its last fade was over: the eldest goes. For a capture beside the frames
  // adopt_capture() does that.
  if (const Picture* eldest = picture_of(state_.previous, e); eldest && !captures_beside(options_))
    drop(slot_of(eldest));
  Capture made;
  made.slot = new_slot();
  made.entity = e;
  made.geometry = placed.geometry;
  made.triangles = estimated.triangles;
  made.level_px = estimated.level_px;
  made.cost = cost;
  made.bound_px = bound_total_px(placed.geometry, frame_.camera) + estimated.level_px;
  made.several = several(e);
  made.once = estimated.once;
  if (captures_beside(options_))
    made.order = state_.orders + std::uint32_t(plan_.captures.size()) + 1;

  Picture& picture = made.picture;
  picture.entity = e;
  picture.geometry = placed.geometry;
  if (is_moving(e)) picture.world_from_object = moving_[e - nodes()].world_from_object;
  picture.level_error = estimated.level_error;
  picture.coarse_px = placed.coarse_px;
  picture.draw_cost = estimated.draw;
  picture.rate = picture_rate(estimated);
  picture.bytes = bytes;
  picture.texel_scale = scale;
  picture.clipped = placed.clipped;
  picture.used = picture.fade_start = state_.frame;
  // A short life has little time to be replaced in.
  const double life = (1 + kAnticipation) * estimated.life;
  const double lead = std::clamp(life / 6, 1.0, double(options_.fade_frames + kSpreadFrames));
  picture.lead = std::uint16_t(lead + latency());
  // Of a frame that begins with polygons all over, only some fade.
  const Picture* old = picture_of(state_.current, e);
  const bool over_pictures = valid(old) || pictures_cover_below(e);
  const bool over_polygons = !over_pictures && made.triangles <= kFadedTriangles;
  if (over_polygons) faded_triangles_ += made.triangles;
  if (late(old))
    picture.fade_length = 1;  // what is late is shown no longer than it must be
  else if (over_pictures || (over_polygons && faded_triangles_ <= kMaxFadedTriangles))
    picture.fade_length = std::uint16_t(fade_length(int(lead), options_));
  picture.held = true;

  plan_.bytes += bytes;
  plan_.captured_triangles += made.triangles;
  plan_.captures.push_back(made);
  if (made.order == 0) scratch_.captured[e] = std::uint32_t(plan_.captures.size());
  return true;
}

// How coarse must pictures be for all to find room?
double FramePlanner::fitting_scale() const {
  const double room = kPlannedMemory * double(options_.memory_bytes);
  if (full_bytes_ <= room) return 1;
  return std::max(kCoarsest, std::sqrt(room / full_bytes_));
}

// The pace at which requests, sorted by their deadlines, can be met: cost a frame.
double FramePlanner::even_pace() const {
  double sum = 0, pace = 0;
  for (const auto& request : scratch_.requests) {
    if (is_ordered(request.entity)) continue;
    sum += double(request.cost);
    pace = std::max(pace, sum / std::max(1.0, double(request.deadline)));
  }
  return pace;
}

// Within a budget of time, orders what is late and what is missing first, then what the pace asks
// for. What does not fit waits, so that dear captures do not keep cheap ones from being made.
void FramePlanner::schedule_in_time(double credit) {
  const double budget = options_.capture_cost;
  double spent = state_.ordered_cost;
  for (const auto& request : scratch_.requests) {
    if (is_ordered(request.entity)) continue;
    const double cost = request.cost;
    // What costs more than a budget would wait for ever, and all after it.
    if (request.deadline > 0 && credit < std::min(cost, budget)) break;
    if (spent > 0 && spent + cost > budget) continue;
    if (!capture(request.entity, cost)) continue;
    credit = std::max(0.0, credit - cost);
    spent += cost;
  }
  plan_.credit = std::min(credit, budget);

  double pixels = 0;  // of the fallback
  for (const auto& request : scratch_.requests)
    if (request.due) {
      scratch_.fallback[request.entity] = 1;
      pixels += covered_pixels(view_, box_of(request.entity));
    }
  fallback_scale_ =
      rilievo::fallback_scale(view_, pixels, options_.fallback_cost, kCoarsestFallback, options_);
}

void FramePlanner::schedule_captures() {
  std::vector<PlanScratch::Request>& requests = scratch_.requests;
  std::sort(requests.begin(), requests.end(), [](const auto& a, const auto& b) {
    if (a.deadline != b.deadline) return a.deadline < b.deadline;
    return a.worth != b.worth ? a.worth > b.worth : a.entity < b.entity;
  });
  plan_.texel_scale = fitting_scale();
  double credit = requests.empty() ? 0 : state_.credit + even_pace();
  if (std::isfinite(options_.capture_cost)) return schedule_in_time(credit);

  if (limit_.captures_wait) {
    plan_.credit = 0;
    return;
  }
  // Where what cannot be captured is coarse instead, no capture is nearly free.
  const double limit = plan_.limit;
  const double budget = limit > 0 ? limited_capture_budget(limit_) : capture_budget();
  double spent = 0;
  for (const auto& request : requests) {
    const double cost = request.cost;
    if (request.deadline > 0 && credit < cost) break;
    // What is captured need not be drawn by other means: in a frame that would draw it as polygons
    // its capture costs next to nothing.
    const double drawn = limit > 0 ? 0 : double(scratch_.now_cost[request.entity]);
    const double extra = std::max(0.0, cost - drawn);
    if (!plan_.captures.empty()) {
      if (plan_.captures.size() >= kMostCaptures) break;
      if (spent + extra > budget) {
        if (limit > 0) continue;  // each that fits brings the frame without a limit nearer
        break;
      }
    }
    if (!capture(request.entity, cost)) continue;
    credit = std::max(0.0, credit - cost);
    spent += extra;
  }
  // Nothing to save for beyond what one frame may spend.
  plan_.credit = std::min(credit, budget);
}

}  // namespace rilievo
