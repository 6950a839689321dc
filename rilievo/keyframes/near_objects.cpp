#include "rilievo/keyframes/near_objects.h"

#include <algorithm>
#include <glm/glm.hpp>
#include <iterator>
#include <utility>

#include "rilievo/core/box_distance.h"

namespace rilievo {

void take_nearest(const Scene& scene, double triangles, std::vector<ObjectAtDistance>& objects,
                  std::vector<std::uint32_t>& taken) {
  std::ranges::sort(objects, [](const ObjectAtDistance& a, const ObjectAtDistance& b) {
    return a.distance != b.distance ? a.distance < b.distance : a.object < b.object;
  });
  taken.clear();
  for (const ObjectAtDistance& one : objects) {
    const double its = double(scene.models[std::size_t(scene.objects[one.object].model)].triangles);
    if (its > triangles) continue;
    triangles -= its;
    taken.push_back(one.object);
  }
  std::ranges::sort(taken);
}

NearObjects::NearObjects(const PlacedScene& placed, std::vector<std::uint32_t> objects,
                         const NearObjectsOptions& options)
    : placed_(placed), objects_(std::move(objects)), options_(options) {}

void NearObjects::choose(const Camera& keyframe, const Camera& frame) {
  in_view_.clear(), candidates_.clear(), rest_.clear();
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
  take_nearest(placed_.scene(), options_.triangles, candidates_, near_);
  std::ranges::set_difference(in_view_, near_, std::back_inserter(rest_));
}

}  // namespace rilievo
