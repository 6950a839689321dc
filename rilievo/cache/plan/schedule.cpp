// An even pace: requests with deadlines d_1 <= d_2 <= ... and costs c_i can all be met at the
// constant rate
//
//   max over k of (c_1 + ... + c_k) / d_k
//
// and at no lower one. Each frame saves up that much; what is saved up pays for the next request.
// So captures are made no earlier than they must be, and a frame in which many pictures end has
// been prepared for by those before.
#include "rilievo/cache/plan/schedule.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "rilievo/cache/plan/fallback.h"

namespace rilievo {
namespace {

// Of the memory, this much is planned for; the rest holds pictures that fade out.
constexpr double kPlannedMemory = 0.8;
constexpr double kCoarsest = 0.125;
// Of what a frame may cost that would cost more, for its captures; after a jump a coarse picture
// of nearly everything takes most of it.
constexpr double kLimitedShare = 0.5, kJumpedShare = 0.25;
constexpr std::uint64_t kMaxFadedTriangles = 10'000;  // begun in one frame

// What a frame's captures may cost, in the units of their estimates: drawn triangles.
double capture_budget(const FramePlanner& planner) {
  const CacheOptions& options = planner.options;
  const double least = double(options.capture_triangles) * options.cost.capture_triangle;
  if (options.max_spike > 0) return std::min(least, planner.capture_room);
  return std::max(least, options.capture_share * planner.cost_at_hand);
}

// Makes room for `bytes` by dropping pictures that this frame does not need, the longest unused
// first; in the end the picture that the new one replaces.
bool make_room(FramePlanner& planner, std::uint64_t bytes, Entity e) {
  const auto fits = [&] { return planner.plan.bytes + bytes <= planner.options.memory_bytes; };
  if (fits()) return true;
  std::vector<std::uint32_t>& idle = planner.scratch.idle;
  if (idle.empty()) {
    // Gathered once a frame, the first to go last.
    for (std::uint32_t slot = 0; slot < planner.state.slots.size(); ++slot) {
      const PlanScratch::Checked& checked = planner.scratch.checked[slot];
      const bool needed = checked.frame == planner.state.frame && std::isfinite(checked.now_px);
      if (planner.state.slots[slot].held && !needed && !planner.scratch.dropped[slot])
        idle.push_back(slot);
    }
    std::sort(idle.begin(), idle.end(), [&](std::uint32_t a, std::uint32_t b) {
      const std::uint32_t used_a = planner.state.slots[a].used,
                          used_b = planner.state.slots[b].used;
      return used_a != used_b ? used_a > used_b : a > b;
    });
    idle.insert(idle.begin(), 0xFFFFFFFFu);  // a sentinel: gathered, if nothing else
  }
  while (!fits() && idle.size() > 1) {
    if (!planner.scratch.dropped[idle.back()]) planner.drop(idle.back());
    idle.pop_back();
  }
  if (!fits() && !captures_beside(planner.options))
    if (const Picture* old = planner.picture_of(planner.state.current, e))
      planner.drop(planner.slot_of(old));
  return fits();
}

std::uint32_t new_slot(const FramePlanner& planner) {
  // Freed in this frame, free before, or new: as commit() will find them.
  const std::size_t taken = planner.plan.captures.size();
  if (taken < planner.state.free_slots.size())
    return planner.state.free_slots[planner.state.free_slots.size() - 1 - taken];
  return std::uint32_t(planner.state.slots.size() + taken - planner.state.free_slots.size());
}

bool capture(FramePlanner& planner, Entity e, double cost) {
  const CaptureCost estimated = planner.estimate(e);
  const CacheOptions& options = planner.options;
  const bool clip = estimated.once && !planner.is_moving(e);
  const double scale = planner.plan.texel_scale;
  const glm::dvec3 drift = planner.drift_of(e);
  const PlacedPicture placed = place_picture(planner.view, planner.box_of(e), estimated, drift,
                                             scale, options, planner.expected_range(e), clip);
  if (!placed.good) return false;
  const std::uint64_t bytes = picture_bytes(placed.geometry.capture, options);
  if (!make_room(planner, bytes, e)) {
    ++planner.plan.starved;
    return false;
  }
  // Captured again before its last fade was over: the eldest goes. For a capture beside the frames
  // adopt_capture() does that.
  if (const Picture* eldest = planner.picture_of(planner.state.previous, e);
      eldest && !captures_beside(options))
    planner.drop(planner.slot_of(eldest));
  Capture made;
  made.slot = new_slot(planner);
  made.entity = e;
  made.geometry = placed.geometry;
  made.triangles = estimated.triangles;
  made.level_px = estimated.level_px;
  made.cost = cost;
  made.several = planner.several(e);
  made.once = estimated.once;
  if (captures_beside(options))
    made.order = planner.state.orders + std::uint32_t(planner.plan.captures.size()) + 1;

  Picture& picture = made.picture;
  picture.entity = e;
  picture.geometry = placed.geometry;
  if (planner.is_moving(e))
    picture.world_from_object = planner.moving[e - planner.nodes()].world_from_object;
  picture.level_error = estimated.level_error;
  picture.coarse_px = placed.coarse_px;
  picture.draw_cost = estimated.draw;
  picture.rate = picture_rate(estimated, options);
  picture.bytes = bytes;
  picture.texel_scale = scale;
  picture.clipped = placed.clipped;
  picture.used = picture.fade_start = planner.state.frame;
  // A short life has little time to be replaced in.
  const double life = (1 + options.anticipation) * estimated.life;
  const double lead =
      std::clamp(life / 6, 1.0, double(options.fade_frames + options.spread_frames));
  picture.lead = std::uint16_t(lead + planner.latency());
  // Of a frame that begins with polygons all over, only some fade.
  const Picture* old = planner.picture_of(planner.state.current, e);
  const bool over_pictures = planner.valid(old) || planner.pictures_cover_below(e);
  const bool over_polygons = !over_pictures && made.triangles <= kFadedTriangles;
  if (over_polygons) planner.faded_triangles += made.triangles;
  if (planner.late(old))
    picture.fade_length = 1;  // what is late is shown no longer than it must be
  else if (over_pictures || (over_polygons && planner.faded_triangles <= kMaxFadedTriangles))
    picture.fade_length = std::uint16_t(fade_length(int(lead), options));
  picture.held = true;

  planner.plan.bytes += bytes;
  planner.plan.captured_triangles += made.triangles;
  planner.plan.captures.push_back(made);
  if (made.order == 0) planner.scratch.captured[e] = std::uint32_t(planner.plan.captures.size());
  return true;
}

// How coarse must pictures be for all to find room?
double fitting_scale(const FramePlanner& planner) {
  const double room = kPlannedMemory * double(planner.options.memory_bytes);
  if (planner.full_bytes <= room) return 1;
  return std::max(kCoarsest, std::sqrt(room / planner.full_bytes));
}

// The pace at which requests, sorted by their deadlines, can be met: cost a frame.
double even_pace(const FramePlanner& planner) {
  double sum = 0, pace = 0;
  for (const auto& request : planner.scratch.requests) {
    if (planner.is_ordered(request.entity)) continue;
    sum += double(request.cost);
    pace = std::max(pace, sum / std::max(1.0, double(request.deadline)));
  }
  return pace;
}

// Within a budget of time, orders what is late and what is missing first, then what the pace asks
// for. What does not fit waits, so that dear captures do not keep cheap ones from being made.
void schedule_in_time(FramePlanner& planner, double credit) {
  const double budget = planner.options.capture_cost;
  double spent = planner.state.ordered_cost;
  for (const auto& request : planner.scratch.requests) {
    if (planner.is_ordered(request.entity)) continue;
    const double cost = request.cost;
    // What costs more than a budget would wait for ever, and all after it.
    if (request.deadline > 0 && credit < std::min(cost, budget)) break;
    if (spent > 0 && spent + cost > budget) continue;
    if (!capture(planner, request.entity, cost)) continue;
    credit = std::max(0.0, credit - cost);
    spent += cost;
  }
  planner.plan.credit = std::min(credit, budget);

  double pixels = 0;  // of the fallback
  for (const auto& request : planner.scratch.requests)
    if (request.due) {
      planner.scratch.fallback[request.entity] = 1;
      pixels += covered_pixels(planner.view, planner.box_of(request.entity));
    }
  planner.fallback_scale = fallback_scale(planner.view, pixels, planner.options.fallback_cost,
                                          kCoarsestFallback, planner.options);
}

}  // namespace

void schedule_captures(FramePlanner& planner) {
  std::vector<PlanScratch::Request>& requests = planner.scratch.requests;
  std::sort(requests.begin(), requests.end(), [](const auto& a, const auto& b) {
    if (a.deadline != b.deadline) return a.deadline < b.deadline;
    return a.worth != b.worth ? a.worth > b.worth : a.entity < b.entity;
  });
  planner.plan.texel_scale = fitting_scale(planner);
  double credit = requests.empty() ? 0 : planner.state.credit + even_pace(planner);
  if (std::isfinite(planner.options.capture_cost)) return schedule_in_time(planner, credit);

  if (planner.captures_wait) {
    planner.plan.credit = 0;
    return;
  }
  // Where what cannot be captured is coarse instead, no capture is nearly free.
  const double limit = planner.plan.limit;
  const double share = planner.jumped ? kJumpedShare : kLimitedShare;
  const double budget = limit > 0 ? share * limit : capture_budget(planner);
  double spent = 0;
  for (const auto& request : requests) {
    const double cost = request.cost;
    if (request.deadline > 0 && credit < cost) break;
    // What is captured need not be drawn by other means: in a frame that would draw it as polygons
    // its capture costs next to nothing.
    const double drawn = limit > 0 ? 0 : double(planner.scratch.now_cost[request.entity]);
    const double extra = std::max(0.0, cost - drawn);
    if (!planner.plan.captures.empty()) {
      if (int(planner.plan.captures.size()) >= planner.options.captures) break;
      if (spent + extra > budget) {
        if (limit > 0) continue;  // each that fits brings the frame without a limit nearer
        break;
      }
    }
    if (!capture(planner, request.entity, cost)) continue;
    credit = std::max(0.0, credit - cost);
    spent += extra;
  }
  // Nothing to save for beyond what one frame may spend.
  planner.plan.credit = std::min(credit, budget);
}

}  // namespace rilievo
