// An even pace: requests with deadlines d_1 <= d_2 <= ... and costs c_i can all be met at the
// constant rate
//
//   max over k of (c_1 + ... + c_k) / d_k
//
// and at no lower one. Each frame saves up that much; what is saved up pays for the next request.
// So captures are made no earlier than they must be, and a frame in which many pictures end has
// been prepared for by those before.
#include "rilievo/cache/schedule.h"

#include <algorithm>
#include <cmath>

namespace rilievo {
namespace {

// Of the memory, this much is planned for; the rest holds pictures that fade out.
constexpr double kPlannedMemory = 0.8;
constexpr double kCoarsest = 0.125;
constexpr std::uint64_t kMostFadedTriangles = 10'000;  // begun in one frame

// What a frame's captures may cost, in the units of their estimates: drawn triangles.
double capture_budget(const CacheOptions& options) {
  return double(options.capture_triangles) * options.cost.capture_triangle;
}

// Makes room for `bytes` by dropping pictures that this frame does not need, the longest unused
// first; in the end the picture that the new one replaces.
bool make_room(Cut& cut, std::uint64_t bytes, Entity e) {
  const auto fits = [&] { return cut.plan.bytes + bytes <= cut.options.memory_bytes; };
  if (fits()) return true;
  std::vector<std::uint32_t>& idle = cut.scratch.idle;
  if (idle.empty()) {
    // Gathered once a frame, the first to go last.
    for (std::uint32_t slot = 0; slot < cut.state.slots.size(); ++slot) {
      const PlanScratch::Checked& checked = cut.scratch.checked[slot];
      const bool needed = checked.frame == cut.state.frame &&
                          checked.now_px <= limit_px(cut.state.slots[slot], cut.options);
      if (cut.state.slots[slot].held && !needed && !cut.scratch.dropped[slot]) idle.push_back(slot);
    }
    std::sort(idle.begin(), idle.end(), [&](std::uint32_t a, std::uint32_t b) {
      const std::uint32_t used_a = cut.state.slots[a].used, used_b = cut.state.slots[b].used;
      return used_a != used_b ? used_a > used_b : a > b;
    });
    idle.insert(idle.begin(), 0xFFFFFFFFu);  // a sentinel: gathered, if nothing else
  }
  while (!fits() && idle.size() > 1) {
    if (!cut.scratch.dropped[idle.back()]) cut.drop(idle.back());
    idle.pop_back();
  }
  if (!fits())
    if (const Picture* old = cut.picture_of(cut.state.current, e)) cut.drop(cut.slot_of(old));
  return fits();
}

std::uint32_t new_slot(const Cut& cut) {
  // Freed in this frame, free before, or new: as commit() will find them.
  const std::size_t taken = cut.plan.captures.size();
  if (taken < cut.state.free_slots.size())
    return cut.state.free_slots[cut.state.free_slots.size() - 1 - taken];
  return std::uint32_t(cut.state.slots.size() + taken - cut.state.free_slots.size());
}

bool capture(Cut& cut, Entity e, double cost) {
  const CacheOptions& options = cut.options;
  const PictureEstimate estimated = cut.estimate(e);
  const glm::dvec3 drift = cut.drift_of(e);
  const PlacedPicture placed = place_picture(cut.view, cut.box_of(e), estimated, drift,
                                             cut.plan.texel_scale, options, cut.expected_range(e));
  if (!placed.good) return false;
  const std::uint64_t bytes = picture_bytes(placed.geometry.capture, options);
  if (!make_room(cut, bytes, e)) {
    ++cut.plan.starved;
    return false;
  }
  // Captured again before its last fade was over: the eldest goes.
  if (const Picture* eldest = cut.picture_of(cut.state.previous, e)) cut.drop(cut.slot_of(eldest));
  Capture made;
  made.slot = new_slot(cut);
  made.entity = e;
  made.geometry = placed.geometry;
  made.triangles = cut.triangles_of(e);
  made.cost = cost;
  made.several = cut.several(e);

  Picture& picture = made.picture;
  picture.entity = e;
  picture.geometry = placed.geometry;
  if (cut.is_moving(e)) picture.world_from_object = cut.moving[e - cut.nodes()].world_from_object;
  picture.coarse_px = placed.coarse_px;
  picture.draw_cost = estimated.draw;
  picture.rate = picture_rate(estimated, options);
  picture.bytes = bytes;
  picture.texel_scale = cut.plan.texel_scale;
  picture.used = picture.fade_start = cut.state.frame;
  // A short life has little time to be replaced in.
  const double life = (1 + options.anticipation) * estimated.life;
  picture.lead =
      std::uint16_t(std::clamp(life / 3, 1.0, double(options.fade_frames + options.spread_frames)));
  // Of a frame that begins with polygons all over, only some fade.
  const bool over_pictures =
      cut.valid(cut.picture_of(cut.state.current, e)) || cut.pictures_cover_below(e);
  const bool over_polygons = !over_pictures && made.triangles <= kFadedTriangles;
  if (over_polygons) cut.faded_triangles += made.triangles;
  if (over_pictures || (over_polygons && cut.faded_triangles <= kMostFadedTriangles))
    picture.fade_length = std::uint16_t(fade_length(picture.lead, options));
  picture.held = true;

  cut.plan.bytes += bytes;
  cut.plan.captured_triangles += made.triangles;
  cut.plan.captures.push_back(made);
  cut.scratch.captured[e] = std::uint32_t(cut.plan.captures.size());
  return true;
}

// How coarse must pictures be for all to find room?
double fitting_scale(const Cut& cut) {
  const double room = kPlannedMemory * double(cut.options.memory_bytes);
  if (cut.full_bytes <= room) return 1;
  return std::max(kCoarsest, std::sqrt(room / cut.full_bytes));
}

}  // namespace

void schedule_captures(Cut& cut) {
  std::vector<PlanScratch::Request>& requests = cut.scratch.requests;
  std::sort(requests.begin(), requests.end(), [](const auto& a, const auto& b) {
    if (a.deadline != b.deadline) return a.deadline < b.deadline;
    return a.worth != b.worth ? a.worth > b.worth : a.entity < b.entity;
  });
  cut.plan.texel_scale = fitting_scale(cut);

  double sum = 0, pace = 0;
  for (const auto& request : requests) {
    sum += double(request.cost);
    pace = std::max(pace, sum / std::max(1.0, double(request.deadline)));
  }
  const double budget = capture_budget(cut.options);
  double credit = requests.empty() ? 0 : cut.state.credit + pace, spent = 0;
  for (const auto& request : requests) {
    const double cost = request.cost;
    if (request.deadline > 0 && credit < cost) break;
    // What is captured need not be drawn by other means: in a frame that would draw it as polygons
    // its capture costs next to nothing.
    const double extra = std::max(0.0, cost - double(cut.scratch.now_cost[request.entity]));
    if (!cut.plan.captures.empty() &&
        (int(cut.plan.captures.size()) >= cut.options.captures || spent + extra > budget))
      break;
    if (!capture(cut, request.entity, cost)) continue;
    credit = std::max(0.0, credit - cost);
    spent += extra;
  }
  // Nothing to save for beyond what one frame may spend.
  cut.plan.credit = std::min(credit, budget);
}

}  // namespace rilievo
