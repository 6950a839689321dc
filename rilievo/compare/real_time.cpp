#include "rilievo/compare/real_time.h"

#include <algorithm>
#include <chrono>
#include <thread>

#include "rilievo/core/expects.h"
#include "rilievo/core/stopwatch.h"

namespace rilievo {
namespace {

void add_stats(const FrameStats& stats, RealTimeWalk& result) {
  result.captures += stats.captures;
  result.capture_ms += stats.capture_ms;
  result.bound_px = std::max(result.bound_px, stats.bound_px.value_or(0));
  result.gap_px = std::max(result.gap_px, stats.gap_px);
  result.picture_bytes = std::max(result.picture_bytes, stats.picture_bytes);
}

// Are both eyes the same but for rounding? A path that returns to a place may compute it anew.
bool same_place(const Camera& a, const Camera& b) {
  constexpr double kRounding = 1e-9;
  const double far_off = glm::length(a.position()) + glm::length(b.position());
  double most = glm::distance(a.position(), b.position()) / std::max(1.0, far_off);
  for (int i = 0; i < 3; ++i)
    most = std::max(most, glm::distance(a.world_from_eye[i], b.world_from_eye[i]));
  return most <= kRounding;
}

}  // namespace

std::vector<double> cuts_of(const CameraPath& path) {
  std::vector<double> cuts;
  for (std::size_t i = 1; i < path.keys.size(); ++i)
    if (is_cut(path.keys[i - 1], path.keys[i]))
      cuts.push_back(path.keys[i].time - path.keys[0].time);
  return cuts;
}

Result<RealTimeWalk> walk_in_real_time(FrameSource& source, const DrawTargets& targets,
                                       const std::function<WalkFrame(double seconds)>& walk,
                                       const RealTimeOptions& options) {
  RILIEVO_EXPECTS(options.kept >= 1 && options.in_a_row >= 1 && options.seconds > 0 &&
                  options.refresh > 0);
  RealTimeWalk result;
  const WalkFrame start = walk(0);
  Camera last = start.camera;
  const Result<double> first = time_frame(source, targets, start);
  if (!first) return first.error();
  result.first_frame_ms = *first;
  add_stats(source.stats(), result);
  int over = !options.limits.hold(source.stats());

  std::size_t next_cut = 0;
  double since_cut = -1;  // ms; negative: a good frame came after the last cut
  // The k-th place is the first frame at k / kept of the walk or later.
  const int wanted = options.kept * options.in_a_row;
  for (double clock = 0; clock < options.seconds || int(result.kept.size()) < wanted;) {
    const WalkFrame frame = walk(clock);
    bool after_cut = false;
    for (; next_cut < options.cuts.size() && clock >= options.cuts[next_cut]; ++next_cut)
      after_cut = true;
    // An eye that jumped there and back between two frames did not jump.
    after_cut = after_cut && !same_place(frame.camera, last);
    if (after_cut) since_cut = std::max(since_cut, 0.0);
    last = frame.camera;
    const int kept = int(result.kept.size());
    const double place = options.seconds * (kept / options.in_a_row) / options.kept;
    const bool keep = kept < wanted && (kept % options.in_a_row > 0 || clock >= place);
    double ms = 0;
    const BusyWatch busy;
    if (keep) {
      Result<DrawnFrame> drawn = draw_frame(source, targets, frame);
      if (!drawn) return drawn.error();
      ms = drawn->frame_ms;
      result.kept.emplace_back(frame, std::move(*drawn));
    } else {
      const Result<double> timed = time_frame(source, targets, frame);
      if (!timed) return timed.error();
      ms = *timed;
      result.busy_ms.push_back(busy.ms());
    }
    result.frame_ms.push_back(ms);
    if (after_cut) result.cut_ms = std::max(result.cut_ms.value_or(0), ms);
    add_stats(source.stats(), result);
    const bool good = options.limits.hold(source.stats());
    over += !good;
    if (since_cut >= 0) {
      since_cut += ms;
      if (good) {
        result.cut_fine_ms = std::max(result.cut_fine_ms.value_or(0), since_cut);
        since_cut = -1;
      }
    }
    const double rest_ms = 1000 / options.refresh - ms;
    if (options.waits && rest_ms > 0)
      std::this_thread::sleep_for(std::chrono::duration<double, std::milli>(rest_ms));
    clock += options.each_frame ? 1 / options.refresh : std::max(ms / 1000, 1 / options.refresh);
  }
  // Not good again before the walk ended: at least so long.
  if (since_cut >= 0) result.cut_fine_ms = std::max(result.cut_fine_ms.value_or(0), since_cut);
  result.over_bound_share = double(over) / double(result.frame_ms.size() + 1);
  return result;
}

}  // namespace rilievo
