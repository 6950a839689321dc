#include "rilievo/capture/ray_source.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "rilievo/core/random.h"
#include "rilievo/render/rays/cast_layers.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/render/shading/sample_buffer.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

Camera camera_around(const Box& box, Random& random, Projection projection) {
  const glm::dvec3 center(box.center());
  const double radius = double(box.radius());
  const glm::dvec3 out = glm::normalize(
      glm::dvec3(random.between(-1, 1), random.between(0.1f, 1), random.between(-1, 1)));
  Camera camera = look_at(center + 1.3 * radius * out, center, {0, 1, 0}, 0.9, 40, 30, 0.3 * radius,
                          2.4 * radius);
  camera.projection = projection;
  if (projection == Projection::parallel)
    camera.window = {-0.7 * radius, 0.7 * radius, -0.5 * radius, 0.5 * radius};
  return camera;
}

// What some objects show is what a scene without the others shows; the farthest surface is the last
// of all layers.
TEST(RaySource, some_objects_are_a_scene_of_their_own) {
  const auto built = make_builtin("builtin:teapots?triangles=20000");
  ASSERT_TRUE(built);
  const Scene& scene = built->scene;
  const Result<RayScene> rays = RayScene::create(scene);
  ASSERT_TRUE(rays);
  RaySource source(*rays);
  Random random(7);
  std::size_t covered = 0, hidden = 0;
  for (int round = 0; round < 24; ++round) {
    std::vector<std::uint32_t> objects;
    Scene alone = scene;
    alone.objects.clear();
    for (std::uint32_t i = 0; i < scene.objects.size(); ++i)
      if (round % 4 == 0 || random.below(2) == 0) {
        objects.push_back(i);
        alone.objects.push_back(scene.objects[i]);
      }
    if (objects.empty()) continue;
    finish(alone);
    const Result<RayScene> others = RayScene::create(alone);
    ASSERT_TRUE(others);
    const Camera camera =
        camera_around(world_bounds(scene), random,
                      round % 3 == 0 ? Projection::parallel : Projection::perspective);
    const int samples = round % 2 ? 1 : 4;
    const Result<CapturedPicture> captured = source.capture(
        {.camera = camera, .objects = objects, .samples = samples, .farthest = true});
    ASSERT_TRUE(captured) << captured.error().message();
    ASSERT_TRUE(validate(captured->picture));
    const DepthImage expected = cast_picture(*others, camera, {{}, samples});
    // Merged: a ray through an edge hits both triangles, in one order or the other.
    const LayeredDepthImage layers = cast_layers(*others, camera, {.merge = 1e-4});
    const Result<LayeredDepthImage> own =
        source.capture_layers({.camera = camera, .objects = objects, .merge = 1e-4});
    ASSERT_TRUE(own);
    ASSERT_EQ(own->first, layers.first);
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        ASSERT_EQ(captured->picture.depth(x, y), expected.depth(x, y));
        ASSERT_EQ(captured->picture.color(x, y), expected.color(x, y));
        const std::uint32_t shown = expected.object(x, y);
        ASSERT_EQ(captured->picture.object(x, y), shown == 0 ? 0 : objects[shown - 1] + 1);
        covered += shown != 0;
        const std::size_t i = std::size_t(y) * std::size_t(camera.width) + std::size_t(x);
        const float farthest = captured->farthest(x, y);
        if (layers.first[i] == layers.first[i + 1]) {
          // Of a thin surface beside the ray.
          ASSERT_EQ(farthest, captured->picture.depth(x, y));
          continue;
        }
        const float last = layers.samples[layers.first[i + 1] - 1].depth;
        // Two floats along rays from either end.
        ASSERT_NEAR(farthest, last, 1e-4 * camera.z_far);
        hidden += farthest > captured->picture.depth(x, y) + 0.01f;
      }
  }
  EXPECT_GT(covered, 5000u);
  EXPECT_GT(hidden, 500u);
}

// The slow way: a picture for each sample, its window moved by the sample's place in the texel.
TEST(RaySource, four_samples_average_the_colours_of_a_surface) {
  const auto built = make_builtin("builtin:teapots?triangles=20000");
  ASSERT_TRUE(built);
  const Result<RayScene> rays = RayScene::create(built->scene);
  ASSERT_TRUE(rays);
  RaySource source(*rays);
  Random random(3);
  int partly = 0, inside = 0;
  double difference = 0;
  for (int round = 0; round < 6; ++round) {
    const Camera camera =
        camera_around(world_bounds(built->scene), random, Projection::perspective);
    const Result<CapturedPicture> captured =
        source.capture({.camera = camera, .identifiers = false});
    ASSERT_TRUE(captured);
    EXPECT_TRUE(captured->picture.object.empty());
    EXPECT_TRUE(captured->farthest.empty());
    const DepthImage center = cast_picture(*rays, camera);
    std::vector<DepthImage> moved_pictures;
    for (int i = 0; i < 4; ++i) {
      Camera moved = camera;
      const glm::dvec2 by = glm::dvec2(sample_position(i, 4)) - 0.5;
      const double u = by.x * (camera.window.right - camera.window.left) / camera.width;
      const double v = by.y * (camera.window.top - camera.window.bottom) / camera.height;
      moved.window.left += u, moved.window.right += u;
      moved.window.bottom += v, moved.window.top += v;
      moved_pictures.push_back(cast_picture(*rays, moved));
    }
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const glm::vec4 c = captured->picture.color(x, y);
        if (!captured->picture.covered(x, y)) {
          ASSERT_EQ(c, glm::vec4(0));
          continue;
        }
        int covered = 0;
        bool alike = true;  // nothing else is near
        glm::vec4 mean(0);
        for (const DepthImage& one : moved_pictures) {
          covered += one.covered(x, y);
          alike &= one.object(x, y) == center.object(x, y) &&
                   std::abs(one.depth(x, y) - center.depth(x, y)) < 0.02f * center.depth(x, y);
          mean += 0.25f * one.color(x, y);
        }
        ASSERT_EQ(c.a, float(std::max(covered, 1)) / 4);
        ASSERT_GT(c.a, 0);
        partly += c.a < 1;
        if (!alike || covered < 4) continue;
        ++inside;
        const glm::vec4 d = glm::abs(c - mean);
        difference += double(d.x + d.y + d.z) / 3;
      }
  }
  EXPECT_GT(partly, 100);
  EXPECT_GT(inside, 1000);
  // A surface is shaded once a texel, at its centre; the slow way shades it at each sample.
  EXPECT_LT(difference / inside, 0.01);
}

TEST(RaySource, what_it_cannot_do_is_refused) {
  const auto built = make_builtin("builtin:teapot?triangles=1000");
  ASSERT_TRUE(built);
  const Result<RayScene> rays = RayScene::create(built->scene);
  ASSERT_TRUE(rays);
  RaySource source(*rays);
  Random random(1);
  Camera camera = camera_around(world_bounds(built->scene), random, Projection::perspective);
  EXPECT_TRUE(source.capture({.camera = camera}));
  EXPECT_FALSE(source.capture({.camera = camera, .samples = 2}));
  camera.projection = Projection::back_perspective;
  EXPECT_FALSE(source.capture({.camera = camera, .with_sky = true}));
  EXPECT_FALSE(source.capture_layers({.camera = camera}));
  camera.z_near = std::nan("");
  EXPECT_FALSE(source.capture({.camera = camera}));
  EXPECT_EQ(source.bounds({}).max, world_bounds(built->scene).max);
}

}  // namespace
}  // namespace rilievo
