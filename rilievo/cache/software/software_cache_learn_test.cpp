// Does the cache learn what the frames that it drew show?
#include <gtest/gtest.h>

#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/method/test_source_test_helpers.h"

namespace rilievo {
namespace {

// Rings behind a wall, or without it.
Scene rings_behind(bool wall) {
  Scene scene;
  for (int i = 0; i < 5; ++i)
    test_shapes::add(scene, test_shapes::torus(0.8, 0.3, 24, 12), glm::vec3(0.5f),
                     glm::translate(glm::mat4(1), {4 * i - 8, 0, -20}));
  if (wall)
    test_shapes::add(scene, test_shapes::box({40, 8, 0.1f}), glm::vec3(0.7f),
                     glm::translate(glm::mat4(1), {0, 0, -10}));
  finish(scene);
  return scene;
}

// Of an eye that strides aside so fast that pictures live shortly: what looking at hidden triangles
// costs is then less than another picture.
int captures_of_walk(const Scene& scene, bool learn) {
  ImageCacheOptions options;
  options.learn = learn, options.error_px = 0.5;
  auto cache = software_cache(scene, options);
  EXPECT_TRUE(cache.ok());
  int captures = 0;
  for (int f = 0; f < 60; ++f) {
    const glm::dvec3 eye(0.2 * f - 6, 0, 0);
    EXPECT_TRUE(
        (*cache)
            ->draw(look_at(eye, eye - glm::dvec3(0, 0, 1), {0, 1, 0}, 0.8, 480, 240, 0.5, 60), 0)
            .ok());
    if (f >= 10) captures += (*cache)->stats().captures;
  }
  return captures;
}

TEST(SoftwareCacheLearns, what_a_wall_hides_is_captured_less_often) {
  const Scene open = rings_behind(false), hidden = rings_behind(true);
  EXPECT_EQ(captures_of_walk(open, true), captures_of_walk(open, false));
  const int without = captures_of_walk(hidden, false), with = captures_of_walk(hidden, true);
  EXPECT_GT(without, 6);
  // Between two pictures they are polygons for a while.
  EXPECT_LE(with, 0.7 * without);
}

}  // namespace
}  // namespace rilievo
