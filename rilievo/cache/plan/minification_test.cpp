#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "rilievo/cache/plan/capture_cost.h"
#include "rilievo/cache/plan/plan_test_helpers.h"

namespace rilievo {
namespace {

glm::dvec2 raster_of(const glm::dvec3& p, const Camera& camera) {
  const glm::dvec4 q = glm::inverse(camera.world_from_eye) * glm::dvec4(p, 1);
  const ImageWindow& w = camera.window;
  return {(q.x / -q.z - w.left) / (w.right - w.left) * camera.width,
          (q.y / -q.z - w.bottom) / (w.top - w.bottom) * camera.height};
}

// By definition: the distance in pixels of points of the polygon that are a texel apart.
TEST(Minification, is_the_texels_that_a_pixel_steps_over) {
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 eye{u(rng), u(rng), u(rng)}, other{u(rng), u(rng), 4 * u(rng)};
    const glm::dvec3 direction{u(rng), 0.3 * u(rng), -2};
    Camera capture = look_at(eye, eye + direction, {0, 1, 0}, 0.7, 90, 60, 8, 9);
    const Camera frame =
        look_at(other, other + direction, {0, 1, 0}, 0.9 + 0.3 * u(rng), 64, 64, 0.1, 50);
    const PictureGeometry picture = picture_geometry(capture);
    const ImageWindow& w = capture.window;
    const auto on_polygon = [&](double x, double y) {
      const glm::dvec4 p(x * picture.plane_z, y * picture.plane_z, -picture.plane_z, 1);
      return glm::dvec3(capture.world_from_eye * p);
    };
    // Across the whole polygon, where rounding is small.
    const double across = glm::distance(raster_of(on_polygon(w.left, w.bottom), frame),
                                        raster_of(on_polygon(w.right, w.bottom), frame));
    EXPECT_NEAR(minification(picture, frame), capture.width / across, 1e-6);
  }
}

TEST(Minification, of_what_is_behind_the_eye_is_none) {
  const Camera capture = look_at({0, 0, 0}, {0, 0, -1}, {0, 1, 0}, 0.7, 90, 60, 8, 9);
  const Camera frame = look_at({0, 0, -20}, {0, 0, -21}, {0, 1, 0}, 0.7, 90, 60, 0.1, 50);
  EXPECT_EQ(minification(picture_geometry(capture), frame), 1);
}

// Boards without depth, whose pictures would be good for ever.
TEST(Minification, an_eye_that_goes_away_sees_no_picture_whose_texels_are_much_too_small) {
  std::vector<Box> boxes;
  std::vector<std::uint64_t> triangles;
  for (int i = 0; i < 5; ++i) {
    const auto x = float(3 * i - 6);
    Box box;
    box.add({x - 1, 0, -0.001f}), box.add({x + 1, 2, 0.001f});
    boxes.push_back(box);
    triangles.push_back(40'000);
  }
  const Hierarchy tree = build_hierarchy(boxes, triangles);
  for (const CacheOptions& options : {CacheOptions{}, rasterized_cache_options()}) {
    Loop run;
    double most = 0;
    int captures = 0;
    for (int frame = 0; frame < 300; ++frame) {
      const glm::dvec3 velocity(0, 0, 0.1), eye(0, 1, 8 + 0.1 * frame);
      const FrameView view{look_at(eye, {0, 1, 0}, {0, 1, 0}, 1.0, 640, 360, 0.1, 400),
                           frame > 0 ? velocity : glm::dvec3(0)};
      ASSERT_NO_FATAL_FAILURE(run.frame(tree, {}, view, options));
      captures += int(run.plan.captures.size());
      for (const DrawnPicture& drawn : run.plan.pictures)
        most = std::max(most, minification(run.state.slots[drawn.slot].geometry, view.camera));
    }
    EXPECT_GT(captures, 10);
    // The captures of five boards are spread, and each fades in for ten frames: 4 m of 12. Without
    // the limit it would be 38 m / 8 m.
    EXPECT_LT(most, kMostMinified * 16 / 12);
    EXPECT_GT(most, 1.2);
  }
}

}  // namespace
}  // namespace rilievo
