#include "rilievo/core/camera.h"

#include <gtest/gtest.h>

#include <limits>
#include <random>

#include "rilievo/core/depth.h"

namespace rilievo {
namespace {

glm::dvec3 random_point(std::mt19937& rng, double reach) {
  std::uniform_real_distribution<double> u(-reach, reach);
  return {u(rng), u(rng), u(rng)};
}

TEST(Camera, raster_and_clip_agree_and_invert) {
  std::mt19937 rng(1);
  for (int i = 0; i < 1000; ++i) {
    Camera c =
        look_at(random_point(rng, 10), random_point(rng, 1), {0, 1, 0}, 1.0, 640, 480, 0.1, 100);
    c.projection = i % 3 == 0   ? Projection::parallel
                   : i % 3 == 1 ? Projection::perspective
                                : Projection::back_perspective;
    const glm::dvec3 p =
        c.position() + glm::dmat3(c.world_from_eye) * (random_point(rng, 3) - glm::dvec3(0, 0, 5));
    const glm::dvec3 raster = raster_from_world(c, p);
    const glm::dvec4 clip = clip_from_world(c) * glm::dvec4(p, 1);
    const glm::dvec3 ndc = glm::dvec3(clip) / clip.w;
    const glm::dvec4 from_relative = clip_from_relative(c) * glm::dvec4(p - c.position(), 1);
    EXPECT_LT(glm::length(from_relative - clip), 1e-9);  // doubles of some hundreds
    // 1e-9 px: rounding of doubles over a few dozen operations.
    EXPECT_NEAR(raster.x, (ndc.x + 1) / 2 * c.width, 1e-9);
    EXPECT_NEAR(raster.y, (1 - ndc.y) / 2 * c.height, 1e-9);
    EXPECT_NEAR(depth_from_eye_z(DepthKind::window_z, raster.z, c, raster), (ndc.z + 1) / 2, 1e-12);
    EXPECT_LT(glm::length(world_from_raster(c, raster, raster.z) - p), 1e-9);
  }
}

TEST(Camera, a_part_shows_the_same_texels) {
  std::mt19937 rng(2);
  for (int i = 0; i < 1000; ++i) {
    const Camera c =
        look_at(random_point(rng, 10), random_point(rng, 1), {0, 1, 0}, 1.0, 640, 480, 0.1, 100);
    const int x = int(rng() % 600), y = int(rng() % 400);
    const Camera part = camera_of_part(c, x, y, 1 + int(rng() % 300), 1 + int(rng() % 300));
    const glm::dvec2 at(rng() % 300 + 0.25, rng() % 300 + 0.5);
    const glm::dvec3 here = world_from_raster(part, at, 7),
                     there = world_from_raster(c, at + glm::dvec2(x, y), 7);
    EXPECT_LT(glm::distance(here, there), 1e-12);
  }
  const Camera c = look_at({1, 2, 3}, {0, 0, 0}, {0, 1, 0}, 1.0, 640, 480, 0.1, 100);
  EXPECT_EQ(camera_of_part(c, 0, 0, 640, 480), c);
}

TEST(Camera, a_supersampled_one_shows_the_same_view) {
  const Camera c = look_at({1, 2, 3}, {0, 0, 0}, {0, 1, 0}, 1.0, 640, 480, 0.1, 100);
  const Camera finer = supersampled(supersampled(c, 2), 3);
  EXPECT_EQ(finer.width, 6 * c.width);
  EXPECT_EQ(finer.height, 6 * c.height);
  EXPECT_EQ(finer.texels_per_pixel, 6 * c.texels_per_pixel);
  const glm::dvec3 here = raster_from_world(c, {0.3, 0.2, -5}),
                   there = raster_from_world(finer, {0.3, 0.2, -5});
  EXPECT_LT(glm::distance(6.0 * glm::dvec2(here), glm::dvec2(there)), 1e-9);
  EXPECT_EQ(here.z, there.z);
}

TEST(Camera, tight_camera_holds_the_box_and_no_more) {
  std::mt19937 rng(2);
  for (int i = 0; i < 500; ++i) {
    Box box;
    const glm::dvec3 center = random_point(rng, 4);
    box.add(glm::vec3(center - glm::abs(random_point(rng, 1))));
    box.add(glm::vec3(center + glm::abs(random_point(rng, 1))));
    const Projection kind = i % 2 ? Projection::perspective : Projection::parallel;
    const glm::dvec3 eye = center + glm::normalize(random_point(rng, 1)) * 6.0;
    const Result<Camera> made = tight_camera(kind, eye, {0, 1, 0}, box);
    ASSERT_TRUE(made.ok()) << made.error().message();
    Camera c = *made;
    c.width = c.height = 100;
    ASSERT_TRUE(validate(c).ok());
    double left = 100, right = 0, nearest = 1e9, farthest = 0;
    for (const glm::vec3& corner : box.corners()) {
      const glm::dvec3 raster = raster_from_world(c, corner);
      left = std::min(left, raster.x), right = std::max(right, raster.x);
      nearest = std::min(nearest, raster.z), farthest = std::max(farthest, raster.z);
      EXPECT_GE(raster.y, -1e-9);
      EXPECT_LE(raster.y, 100 + 1e-9);
    }
    EXPECT_NEAR(left, 0, 1e-6);
    EXPECT_NEAR(right, 100, 1e-6);
    EXPECT_LE(c.z_near, nearest);
    EXPECT_GE(c.z_far, farthest);
  }
}

TEST(Camera, validate_refuses_what_is_not_a_camera) {
  const Camera good = look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 1.0, 64, 64, 0.1, 10);
  EXPECT_TRUE(validate(good).ok());
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Camera c = good;
  c.world_from_eye[3][0] = nan;
  EXPECT_FALSE(validate(c).ok());
  c = good, c.world_from_eye[0] *= 2.0;
  EXPECT_FALSE(validate(c).ok());
  c = good, c.world_from_eye[0] *= -1.0;
  EXPECT_EQ(validate(c).error().reason, "the axes are mirrored");
  c = good, c.window.right = c.window.left;
  EXPECT_FALSE(validate(c).ok());
  c = good, c.z_near = 0;
  EXPECT_FALSE(validate(c).ok());
  c = good, c.width = 0;
  EXPECT_FALSE(validate(c).ok());
}

TEST(Camera, tight_camera_refuses_what_it_cannot_hold) {
  EXPECT_FALSE(tight_camera(Projection::perspective, {0, 0, 0}, {0, 1, 0}, Box{}).ok());
  Box around_eye;
  around_eye.add({-1, -1, -1}), around_eye.add({1, 1, 2});
  EXPECT_FALSE(tight_camera(Projection::perspective, {0, 0, 0}, {0, 1, 0}, around_eye).ok());
  // A point, and an eye straight above: degenerate, and still a valid camera.
  Box point;
  point.add({1, 0, 1});
  const Result<Camera> c = tight_camera(Projection::perspective, {1, 5, 1}, {0, 1, 0}, point);
  ASSERT_TRUE(c.ok());
  EXPECT_TRUE(validate(*c).ok());
}

}  // namespace
}  // namespace rilievo
