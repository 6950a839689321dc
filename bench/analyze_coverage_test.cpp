#include "bench/analyze_coverage.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "rilievo/capture/shapes_test_helpers.h"

namespace rilievo::bench {
namespace {

std::vector<Camera> cameras_of(const Scene& scene, const ViewSet& views,
                               const ViewCameraOptions& options) {
  std::vector<Camera> cameras;
  for (const glm::dvec3& d : views.directions)
    cameras.push_back(*view_camera(world_bounds(scene), d, options));
  return cameras;
}

Scene cube_scene() {
  Scene scene;
  test_shapes::add(scene, test_shapes::box({1, 1, 1}), {1, 1, 1});
  finish(scene);
  return scene;
}

TEST(AnalyzeCoverage, one_picture_of_a_cube_holds_one_face_or_five) {
  const Scene scene = cube_scene();
  const Result<RayScene> rays = RayScene::create(scene);
  const ViewSet front = view_set_from_directions({glm::dvec3(0, 0, 1)});
  const CoverageOptions options{.points = 6000};
  // Points are one to each 6000th of the area, so that every face has a sixth to within two.
  const double slack = 3.0 / 6000;
  const auto share = [&](Projection kind) {
    const Coverage c = analyze_coverage(
        *rays, cameras_of(scene, front, {.projection = kind, .size = 64}), options);
    EXPECT_EQ(c.visible_share, 1.0);
    return c.covered_share;
  };
  EXPECT_NEAR(share(Projection::perspective), 1.0 / 6, slack);
  EXPECT_NEAR(share(Projection::back_perspective), 5.0 / 6, slack);
}

TEST(AnalyzeCoverage, what_nobody_sees_does_not_count) {
  Scene scene = cube_scene();
  test_shapes::add(scene, test_shapes::box({0.5f, 0.5f, 0.5f}), {1, 1, 1});
  finish(scene);
  const Result<RayScene> rays = RayScene::create(scene);
  const Coverage c =
      analyze_coverage(*rays, cameras_of(scene, make_view_set({}), {.size = 64}), {.points = 5000});
  // The outer cube has four times the inner one's area.
  EXPECT_NEAR(c.visible_share, 0.8, 2.0 / 5000);
  EXPECT_EQ(c.covered_share, 1.0);
  EXPECT_EQ(c.covered_twice_share, 1.0);
  EXPECT_TRUE(c.missed.empty());
}

TEST(AnalyzeCoverage, spacing_is_that_of_neighbouring_texels) {
  // A picture's neighbouring texels on one face, as points in the world: the parallelogram between
  // them is the area of a texel.
  const Scene scene = cube_scene();
  const Result<RayScene> rays = RayScene::create(scene);
  for (Projection kind : {Projection::perspective, Projection::back_perspective}) {
    const Camera camera = *view_camera(world_bounds(scene), {0.3, 0.5, 0.8},
                                       {.projection = kind, .size = 400, .distance = 2});
    const DepthImage picture = cast_picture(*rays, camera);
    const auto world = [&](int x, int y) {
      return world_from_raster(camera, {x + 0.5, y + 0.5}, picture.depth(x, y));
    };
    int checked = 0;
    for (int y = 3; y < 397; y += 7)
      for (int x = 3; x < 397; x += 7) {
        bool inside = true;
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) inside = inside && picture.covered(x + dx, y + dy);
        if (!inside) continue;
        const glm::dvec3 u = 0.5 * (world(x + 1, y) - world(x - 1, y));
        const glm::dvec3 v = 0.5 * (world(x, y + 1) - world(x, y - 1));
        glm::dvec3 normal = glm::normalize(glm::cross(u, v));
        // On one face only, away from the edges.
        const glm::dvec3 a = glm::abs(normal);
        if (std::max({a.x, a.y, a.z}) < 0.9999) continue;
        const glm::dvec3 p = world(x, y);
        if (glm::dot(normal, p) < 0) normal = -normal;
        const double spacing = sample_spacing(*rays, camera, {p, normal});
        // Central differences over two texels of 400 on a plane in perspective: 1 % at worst, at
        // the grazing sides.
        EXPECT_NEAR(spacing / std::sqrt(glm::length(glm::cross(u, v))), 1.0, 0.02);
        ++checked;
      }
    EXPECT_GT(checked, 200);
  }
}

// Does any triangle lie between? Doubles, no tree.
bool slow_occluded(const Scene& scene, const glm::dvec3& origin, const glm::dvec3& direction,
                   double t_far) {
  for (const Object& object : scene.objects)
    for (const Part& part : scene.models[object.model].parts) {
      const Mesh& mesh = scene.meshes[part.mesh];
      const glm::dmat4 place(object.placement * part.model_from_mesh);
      for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
        glm::dvec3 c[3];
        for (int k = 0; k < 3; ++k)
          c[k] = glm::dvec3(place * glm::dvec4(mesh.positions[mesh.indices[i + k]], 1));
        const glm::dvec3 front = glm::cross(c[1] - c[0], c[2] - c[0]);
        if (glm::dot(front, direction) >= 0) continue;  // single-sided
        const glm::dvec3 s =
            glm::inverse(glm::dmat3(c[1] - c[0], c[2] - c[0], -direction)) * (origin - c[0]);
        if (s.x >= 0 && s.y >= 0 && s.x + s.y <= 1 && s.z > 0 && s.z < t_far) return true;
      }
    }
  return false;
}

TEST(AnalyzeCoverage, agrees_with_trying_every_triangle) {
  Scene scene;
  std::mt19937 rng(3);
  std::uniform_real_distribution<float> u(-1, 1);
  for (int i = 0; i < 8; ++i) {
    glm::mat4 place =
        glm::rotate(glm::translate(glm::mat4(1), 1.2f * glm::vec3(u(rng), u(rng), u(rng))),
                    3 * u(rng), glm::normalize(glm::vec3(u(rng), u(rng), u(rng))));
    test_shapes::add(scene, test_shapes::box({0.3f + 0.3f * u(rng), 0.4f, 0.2f}), {1, 1, 1}, place);
  }
  finish(scene);
  const Result<RayScene> rays = RayScene::create(scene);
  const CoverageOptions options{.points = 600, .viewpoints = 40};
  const std::vector<Camera> cameras =
      cameras_of(scene, make_view_set({.spread = ViewSpread::faces_12}), {.size = 64});
  const Coverage coverage = analyze_coverage(*rays, cameras, options);

  const Box bounds = world_bounds(scene);
  const glm::dvec3 center(bounds.center());
  int visible = 0, covered = 0, seen_times = 0, covered_times = 0;
  const std::vector<SurfacePoint> points = spread_points(*rays, options);
  ASSERT_EQ(points.size(), 600u);
  for (const SurfacePoint& point : points) {
    const glm::dvec3 p(point.position), n(point.normal);
    int seen = 0;
    for (const glm::dvec3& d : spread_directions(40)) {
      const glm::dvec3 from = center + d * (4.0 * double(bounds.radius()));
      seen += glm::dot(n, from - p) > 0 && !slow_occluded(scene, from, p - from, 0.9999);
    }
    visible += seen > 0;
    seen_times += seen;
    bool sampled = false;
    for (const Camera& camera : cameras) {
      const glm::dvec3 out = p - camera.position();
      sampled = sampled ||
                (glm::dot(n, out) > 0 && !slow_occluded(scene, p + 100.0 * out, -out, 99.9999));
    }
    covered += seen > 0 && sampled;
    covered_times += sampled ? seen : 0;
  }
  // Floats against doubles: a point or two within rounding of a shadow's edge.
  EXPECT_NEAR(coverage.visible_share * 600, visible, 2);
  EXPECT_NEAR(coverage.covered_share * coverage.visible_share * 600, covered, 3);
  EXPECT_NEAR(coverage.covered_seen_share, double(covered_times) / seen_times, 0.003);
  EXPECT_LT(visible, 600);
  EXPECT_LE(coverage.covered_share, 1);
  EXPECT_EQ(coverage.spacing.size(), std::size_t(std::lround(coverage.visible_share * 600)));
  EXPECT_EQ(share_within(coverage, 1e30), coverage.covered_share);
  EXPECT_EQ(share_within(coverage, 0), 0);
}

TEST(AnalyzeCoverage, directions_and_points_are_spread_evenly) {
  const std::vector<glm::dvec3> directions = spread_directions(500);
  glm::dvec3 sum(0);
  double closest = 10;
  for (int i = 0; i < 500; ++i) {
    EXPECT_NEAR(glm::length(directions[i]), 1, 1e-12);
    sum += directions[i];
    for (int k = 0; k < i; ++k)
      closest = std::min(closest, glm::length(directions[i] - directions[k]));
  }
  EXPECT_LT(glm::length(sum), 2);
  // 500 caps on a sphere of 4 pi are spaced 0.17; the lattice keeps well over half of that.
  EXPECT_GT(closest, 0.1);

  Scene scene;
  test_shapes::add(scene, test_shapes::sphere(1), {1, 1, 1});
  finish(scene);
  const Result<RayScene> rays = RayScene::create(scene);
  const std::vector<SurfacePoint> points = spread_points(*rays, {.points = 8000});
  glm::dvec3 mean(0);
  int upper = 0;
  for (const SurfacePoint& p : points) {
    mean += glm::dvec3(p.position) / 8000.0;
    upper += p.position.y > 0.5f;
    EXPECT_GT(glm::dot(p.position, p.normal), 0.99f);
  }
  // Archimedes: a quarter of the area lies above 0.5. Four standard deviations of 8000 draws.
  EXPECT_NEAR(upper / 8000.0, 0.25, 4 * std::sqrt(0.25 * 0.75 / 8000));
  EXPECT_LT(glm::length(mean), 0.03);
}

}  // namespace
}  // namespace rilievo::bench
