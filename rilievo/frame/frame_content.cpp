#include "rilievo/frame/frame_content.h"

#include <fmt/format.h>

#include <algorithm>

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

}  // namespace rilievo
