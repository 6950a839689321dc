#include "rilievo/frame/frame_content.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace rilievo {

const Sky& FrameContent::sky_over(const Scene& scene) const {
  if (scene.objects.empty())
    for (const Set& set : sets)
      if (!set.instances.empty())
        if (const Sky* own = set.drawable->sky()) return *own;
  return scene.sky;
}

std::string FrameDecision::sentence() const {
  if (method.empty()) return {};
  std::string text = fmt::format("{} ({}", method, reason);
  if (expected_ms > 0) text += fmt::format(": {:.1f} ms", expected_ms);
  if (!rival.empty()) text += fmt::format(", {} {:.1f} ms", rival, rival_ms);
  return text + ")";
}

void count_drawn(const FrameContent& content, FrameStats& stats) {
  stats.polygons = int(content.polygons.size() + content.fading.size());
  stats.groups = 0;
  for (auto& [name, number] : stats.by_kind) number = 0;
  for (const FrameContent::Set& set : content.sets) {
    int single = 0;
    for (const Instance& instance : set.instances) single += instance.object != kNoObject;
    stats.groups += int(set.instances.size()) - single;
    const std::string_view kind = set.drawable->kind();
    const auto found = std::find_if(stats.by_kind.begin(), stats.by_kind.end(),
                                    [&](const auto& entry) { return entry.first == kind; });
    if (found == stats.by_kind.end())
      stats.by_kind.emplace_back(kind, single);
    else
      found->second += single;
  }
}

void widen_bounds(const ErrorModel& error, const Instance& instance, const Camera& frame,
                  FrameStats& stats) {
  if (!stats.bound_px) return;
  const double bound_px = error.bound_px(instance.world_from_capture, frame);
  if (!std::isfinite(bound_px)) {
    stats.bound_px.reset();
    return;
  }
  stats.bound_px = std::max(*stats.bound_px, bound_px);
  if (const double gap_px = error.gap_px(instance.world_from_capture, frame); std::isfinite(gap_px))
    stats.gap_px = std::max(stats.gap_px, gap_px);
}

}  // namespace rilievo
