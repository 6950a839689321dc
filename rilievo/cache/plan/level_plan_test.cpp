#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "rilievo/cache/plan/capture_cost.h"
#include "rilievo/cache/plan/forest_test_helpers.h"

namespace rilievo {
namespace {

using namespace test_forest;

TEST(LevelPx, no_point_appears_farther_off_than_it_says) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> u(-1, 1);
  const auto random_point = [&] { return glm::dvec3(u(rng), u(rng), u(rng)); };
  int cases = 0, near = 0;
  for (int round = 0; round < 20000; ++round) {
    const Camera camera = look_at(random_point(), 3.0 * random_point(), {0, 1, 0},
                                  0.9 + 0.5 * u(rng), 640, 360, 0.01, 100);
    Box box;
    const glm::dvec3 center = 6.0 * random_point(), half = glm::abs(random_point());
    box.add(glm::vec3(center - half)), box.add(glm::vec3(center + half));
    const glm::dvec3 low(box.min), high(box.max);
    const glm::dvec3 p = glm::mix(low, high, 0.5 + 0.5 * random_point());
    const glm::dvec3 q = glm::clamp(p + 0.1 * random_point(), low, high);
    const double error = glm::length(q - p), px = level_px(camera, box, error);
    if (!std::isfinite(px)) continue;
    const glm::dvec3 a = raster_from_world(camera, p), b = raster_from_world(camera, q);
    // One of them is in the frame: the true one, or the one that is drawn.
    if (!(b.z > camera.z_near && b.x > 0 && b.x < 640 && b.y > 0 && b.y < 360)) continue;
    const double off = glm::length(glm::dvec2(a) - glm::dvec2(b));
    EXPECT_GT(a.z, 0);
    EXPECT_LE(off, px * (1 + 1e-6) + 1e-6) << round;  // the camera's matrices are rounded
    near += off > 0.5 * px;
    ++cases;
  }
  EXPECT_GT(cases, 1000);
  EXPECT_GT(near, 100);  // it is no mere guess
}

TEST(LevelPx, is_nothing_without_an_error_and_infinite_around_the_eye) {
  const Camera camera = looking({0, 0, 0}, {0, 0, -1}, {}).camera;
  Box box;
  box.add(glm::vec3(-1)), box.add(glm::vec3(1));
  EXPECT_EQ(level_px(camera, box, 0), 0);
  EXPECT_TRUE(std::isinf(level_px(camera, box, 0.1)));
}

// Half of the triangles for each factor of two in the error, from a millimetre on.
LevelTable halves(const Hierarchy& tree) {
  LevelTable table{
      0.001, std::vector<std::array<LevelTable::Level, LevelTable::kSteps>>(tree.nodes.size())};
  for (std::size_t e = 0; e < tree.nodes.size(); ++e)
    for (int step = 0; step < LevelTable::kSteps; ++step) {
      const int level = 1 + step / 2;
      table.of_node[e][std::size_t(step)] = {
          float(std::ldexp(double(tree.nodes[e].triangles), -level)),
          float(std::ldexp(0.001, step / 2))};
    }
  return table;
}

TEST(LevelPlan, bounds_have_the_levels_errors_and_stay_within_the_limits) {
  for (const bool rasterized : {false, true}) {
    PlanObjects forest = plant(150);
    const LevelTable levels = halves(forest.tree);
    CacheOptions options = rasterized ? rasterized_cache_options() : CacheOptions{};
    Loop run;
    int by_level = 0, polygons_by_level = 0;
    std::uint64_t captured = 0, all_triangles = 0;
    for (int f = 0; f < 260; ++f) {
      SCOPED_TRACE(f);
      const FrameView view = stroll(f);
      ASSERT_NO_FATAL_FAILURE(run.frame(forest.tree, {}, view, options, {}, levels));
      for (const Capture& capture : run.plan.captures) {
        captured += capture.triangles;
        all_triangles += forest.tree.nodes[capture.entity].triangles;
        ASSERT_LE(capture.level_px, kLevelShare * options.error_px);
        if (capture.level_px > 0) {
          ASSERT_LE(2 * capture.triangles, forest.tree.nodes[capture.entity].triangles);
        }
      }
      double largest = 0;
      for (const DrawnPicture& drawn : run.plan.pictures) {
        const Picture& picture = run.state.slots[drawn.slot];
        const double off_px =
            level_px(view.camera, forest.tree.nodes[picture.entity].box, picture.level_error);
        const double bound_px = bound_total_px(picture.geometry, view.camera) + off_px;
        // Stored in single precision.
        ASSERT_NEAR(drawn.bound_px, bound_px, 1e-5);
        ASSERT_LE(drawn.bound_px, limit_px(picture, options) + 1e-6);
        ASSERT_GE(drawn.gap_px,
                  2 * off_px - 1e-5 - (picture.fade_start + 1 == run.state.frame ? 1 : 0));
        largest = std::max(largest, bound_px);
        by_level += picture.level_error > 0;
      }
      for (const DrawnObject& drawn : run.plan.polygons) {
        const double off_px =
            level_px(view.camera, forest.boxes[drawn.object], double(drawn.level_error));
        ASSERT_LE(off_px, kPolygonLevelShare * options.error_px + 1e-6);
        largest = std::max(largest, off_px);
        polygons_by_level += drawn.level_error > 0;
      }
      ASSERT_NEAR(run.plan.bound_px, largest, 1e-5);
    }
    EXPECT_GT(by_level, 50);
    EXPECT_GT(polygons_by_level, 100);
    EXPECT_LT(captured, all_triangles);
  }
}

}  // namespace
}  // namespace rilievo
