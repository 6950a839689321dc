#include "rilievo/keyframes/near_objects.h"

#include <algorithm>
#include <glm/glm.hpp>
#include <iterator>
#include <utility>

#include "rilievo/core/box_distance.h"

namespace rilievo {

NearObjects::NearObjects(const PlacedScene& placed, std::vector<std::uint32_t> objects,
                         const NearObjectsOptions& options)
    : placed_(placed), objects_(std::move(objects)), options_(options) {}

double NearObjects::triangles_of(std::uint32_t object) const {
  const Scene& scene = placed_.scene();
  return double(scene.models[std::size_t(scene.objects[object].model)].triangles);
}

void NearObjects::choose(const Camera& keyframe, const Camera& frame) {
  in_view_.clear(), candidates_.clear(), near_.clear(), rest_.clear();
  placed_.cull(keyframe, objects_, in_view_);
  const double way = glm::length(keyframe.position() - frame.position());
  for (const std::uint32_t object : in_view_) {
    const Box& box = placed_.bounds()[object];
    const double distance =
        std::min(distance_to(box, keyframe.position()), distance_to(box, frame.position()));
    if (way > 0 && distance <= options_.distance * way &&
        2 * double(box.radius()) <= kLargest * way)
      candidates_.push_back({distance, object});
  }
  std::ranges::sort(candidates_, [](const Candidate& a, const Candidate& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.object < b.object;
  });
  double left = options_.triangles;
  for (const Candidate& one : candidates_) {
    const double triangles = triangles_of(one.object);
    if (triangles > left) continue;
    left -= triangles;
    near_.push_back(one.object);
  }
  std::ranges::sort(near_);
  std::ranges::set_difference(in_view_, near_, std::back_inserter(rest_));
}

}  // namespace rilievo
