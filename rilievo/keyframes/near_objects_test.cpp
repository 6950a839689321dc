#include "rilievo/keyframes/near_objects.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

#include "rilievo/core/random.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

std::vector<std::uint32_t> all_of(const Scene& scene) {
  std::vector<std::uint32_t> objects(scene.objects.size());
  for (std::uint32_t i = 0; i < objects.size(); ++i) objects[i] = i;
  return objects;
}

// By the definition: the nearest that may still be added, again and again.
std::vector<std::uint32_t> slow_choice(const PlacedScene& placed, const NearObjectsOptions& options,
                                       const Camera& keyframe, const Camera& frame) {
  std::vector<std::uint32_t> left, near;
  placed.cull(keyframe, left);
  const double way = glm::length(keyframe.position() - frame.position());
  const auto distance = [&](std::uint32_t object) {
    const Box& box = placed.bounds()[object];
    double least = 1e30;
    for (const glm::dvec3& eye : {keyframe.position(), frame.position()}) {
      glm::dvec3 to(0);
      for (int c = 0; c < 3; ++c)
        to[c] = std::max({double(box.min[c]) - eye[c], eye[c] - double(box.max[c]), 0.0});
      least = std::min(least, glm::length(to));
    }
    return least;
  };
  std::erase_if(left, [&](std::uint32_t object) {
    return 2 * double(placed.bounds()[object].radius()) > NearObjects::kLargest * way;
  });
  double triangles = 0;
  while (!left.empty()) {
    const auto first = std::ranges::min_element(left, {}, distance);
    if (distance(*first) > options.distance * way) break;
    const Scene& scene = placed.scene();
    const double its = double(scene.models[std::size_t(scene.objects[*first].model)].triangles);
    if (triangles + its <= options.triangles) triangles += its, near.push_back(*first);
    left.erase(first);
  }
  std::ranges::sort(near);
  return near;
}

TEST(NearObjects, AreTheNearestWithinANumberOfTriangles) {
  const BuiltinScene made = *make_builtin("builtin:stonehenge?triangles=20000");
  const PlacedScene placed(made.scene);
  Random random(9);
  std::map<std::size_t, int> sizes;
  for (int i = 0; i < 1000; ++i) {
    const auto some = [&](double size) { return random.between(-size, size); };
    const glm::dvec3 eye(some(15), 1.7, some(15)), to(some(15), 1, some(15)),
        step(some(1), 0, some(1));
    const Camera frame = look_at(eye, to, {0, 1, 0}, 0.9, 160, 100, 0.1, 200),
                 keyframe = look_at(eye + step, to + step, {0, 1, 0}, 0.9, 200, 120, 0.1, 200);
    const NearObjectsOptions options{.triangles = random.between(0, 8000)};
    NearObjects near(placed, all_of(made.scene), options);
    near.choose(keyframe, frame);
    const std::vector<std::uint32_t> expected = slow_choice(placed, options, keyframe, frame);
    EXPECT_TRUE(std::ranges::equal(near.near(), expected)) << i;
    std::vector<std::uint32_t> seen, joined(near.near().begin(), near.near().end());
    placed.cull(keyframe, seen);
    joined.insert(joined.end(), near.rest().begin(), near.rest().end());
    std::ranges::sort(joined);
    EXPECT_EQ(joined, seen);
    ++sizes[expected.size()];
  }
  EXPECT_GT(sizes.size(), 3u);  // none, some, many
}

TEST(NearObjects, NothingIsNearAnEyeThatStands) {
  const BuiltinScene made = *make_builtin("builtin:stonehenge?triangles=20000");
  const PlacedScene placed(made.scene);
  NearObjects near(placed, all_of(made.scene));
  const Camera eye = camera_at(made.path, 0, 160, 100);
  near.choose(eye, eye);
  EXPECT_TRUE(near.near().empty());
  EXPECT_FALSE(near.rest().empty());
}

}  // namespace
}  // namespace rilievo
