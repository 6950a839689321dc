#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <cstring>
#include <map>
#include <tuple>

#include "rilievo/environment_nodes/node_mesh.h"
#include "rilievo/environment_nodes/node_test_helpers.h"

namespace rilievo {
namespace {

// Largest difference between what the mesh and the picture show at texels' centres, 1/m.
double largest_error(const EnvironmentMap& map, const NodeMesh& mesh) {
  const CubeGrid grid(map, {});
  double worst = 0;
  for (int f = 0; f < 6; ++f) {
    const Image<float> drawn = drawn_disparity(mesh, f);
    for (int y = 0; y < grid.size(); ++y)
      for (int x = 0; x < grid.size(); ++x)
        worst = std::max(worst, double(std::abs(drawn(x, y) - grid.at(f, {x, y}))));
  }
  return worst;
}

TEST(Triangulate, no_texel_is_wrong_by_more_than_was_allowed) {
  const EnvironmentMap map = make_node(48, furnished_room());
  std::size_t last = 0;
  for (const double error_px : {2.0, 0.5, 0.1}) {
    TriangulateOptions options;
    options.error_px = error_px;
    options.reach = 0.5;
    TriangulateStats stats;
    const NodeMesh mesh = triangulate(map, options, &stats);
    const double allowed = error_px / (0.5 * 24);
    // Interpolation in floats.
    EXPECT_LE(largest_error(map, mesh), allowed + 1e-5);
    EXPECT_LE(stats.worst_error_px, error_px);
    EXPECT_GT(mesh.surface_triangles(), last);
    last = mesh.surface_triangles();
  }
}

TEST(Triangulate, a_box_is_a_few_triangles) {
  // Seen from a corner at heights that no texel's corner has, its edges lie between texels.
  const EnvironmentMap map = make_node(64, box_around({-2, -1.5, -3}, {4, 1.2, 2.5}));
  TriangulateOptions options;
  options.error_px = 0.1;
  options.reach = 0.25;
  const NodeMesh mesh = triangulate(map, options);
  EXPECT_LT(mesh.surface_triangles(), 700u);
  EXPECT_EQ(mesh.triangles(), mesh.surface_triangles());  // nothing jumps: no skin
  EXPECT_LE(largest_error(map, mesh), 0.1 / (0.25 * 32) + 1e-5);
}

TEST(Triangulate, with_its_skins_a_room_is_closed) {
  for (const std::size_t budget : {std::size_t(0), std::size_t(400), std::size_t(1500)}) {
    const EnvironmentMap map = make_node(40, furnished_room());
    TriangulateOptions options;
    options.triangles = budget;
    options.error_px = 0.2;
    options.reach = 0.5;
    const NodeMesh mesh = triangulate(map, options);
    EXPECT_GT(mesh.triangles(), mesh.surface_triangles());
    // By place, whatever the vertex's number: every edge belongs to two triangles.
    using Place = std::tuple<float, float, float, float>;
    const auto place = [&](std::uint32_t i) {
      const NodeVertex& v = mesh.vertices[i];
      return Place{v.direction.x, v.direction.y, v.direction.z, v.disparity};
    };
    std::map<std::pair<Place, Place>, int> edges;
    for (std::size_t i = 0; i < mesh.indices.size(); ++i) {
      const std::size_t next = i % 3 == 2 ? i - 2 : i + 1;
      Place a = place(mesh.indices[i]), b = place(mesh.indices[next]);
      if (b < a) std::swap(a, b);
      // Both ends the same: a skin's end of no width.
      if (a != b) ++edges[{a, b}];
    }
    for (const auto& [edge, count] : edges) EXPECT_EQ(count % 2, 0);
  }
}

TEST(Triangulate, no_triangle_hangs_between_two_surfaces) {
  const DistanceAlong room = furnished_room();
  const EnvironmentMap map = make_node(96, room);
  TriangulateOptions options;
  options.error_px = 0.2;
  options.reach = 0.5;
  const NodeMesh mesh = triangulate(map, options);
  const DistanceAlong surfaces[] = {box_around({-4, -1.6, -3}, {5, 2, 4}),
                                    ball({1.5, -0.6, -1.4}, 0.6), ball({-1.2, 0.3, 1.9}, 0.5)};
  for (std::size_t t = 0; t < mesh.surface_triangles(); ++t) {
    glm::dvec4 middle(0.0);
    for (int k = 0; k < 3; ++k) {
      const NodeVertex& v = mesh.vertices[mesh.indices[3 * t + std::size_t(k)]];
      middle += glm::dvec4(glm::dvec3(v.direction) / double(v.disparity), 1.0) / 3.0;
    }
    const glm::dvec3 p(middle);
    // Distance from each surface, metres. Allowed: the error, 0.2 px / (0.5 m * 48) of disparity,
    // is 0.13 m at 4 m; and a ball's rim, seen along its surface, continues half a texel.
    const double of_ball[] = {std::abs(glm::distance(p, {1.5, -0.6, -1.4}) - 0.6),
                              std::abs(glm::distance(p, {-1.2, 0.3, 1.9}) - 0.5)};
    double of_box = 1e9;
    const glm::dvec3 low(-4, -1.6, -3), high(5, 2, 4);
    for (int k = 0; k < 3; ++k)
      of_box = std::min({of_box, std::abs(p[k] - low[k]), std::abs(p[k] - high[k])});
    EXPECT_LT(std::min({of_ball[0], of_ball[1], of_box}), 0.25) << t;
  }
}

TEST(Triangulate, a_budget_is_kept_and_used) {
  const EnvironmentMap map = make_node(64, furnished_room());
  double last = 1e9;
  for (const std::size_t budget : {300, 600, 1500, 4000}) {
    TriangulateOptions options;
    options.triangles = budget;
    options.error_px = 0;
    const NodeMesh mesh = triangulate(map, options);
    EXPECT_LE(mesh.surface_triangles(), budget);
    const double error = largest_error(map, mesh);
    // Unless nothing is wrong any more.
    EXPECT_TRUE(error < 1e-5 || double(mesh.surface_triangles()) > 0.95 * double(budget));
    EXPECT_LT(error, last);
    last = error;
  }
}

TEST(Triangulate, what_is_far_gets_fewer_triangles) {
  // Waves as high and as long in metres everywhere, on a wall that is near on the left.
  const auto wavy = [](double away) {
    return [=](const glm::dvec3& d) {
      const double flat = away / std::max(1e-9, -d.z);
      if (d.z > -0.5) return 1e9;
      return flat * (1 + 0.1 / away * std::sin(3 * d.x * flat) * std::sin(3 * d.y * flat));
    };
  };
  const auto room = box_around({-50, -50, -50}, {50, 50, 50});
  std::size_t counts[2];
  for (const bool far : {false, true}) {
    const auto wall = wavy(far ? 12.0 : 3.0);
    const EnvironmentMap map =
        make_node(128, [&](const glm::dvec3& d) { return std::min(wall(d), room(d)); });
    TriangulateOptions options;
    options.error_px = 0.25;
    options.reach = 1;
    counts[far] = triangulate(map, options).surfaces[5].count;
  }
  EXPECT_GT(counts[0], 3 * counts[1]);
}

TEST(Triangulate, the_mesh_does_not_depend_on_threads) {
  const EnvironmentMap map = make_node(64, furnished_room());
  for (const std::size_t budget : {std::size_t(0), std::size_t(900)}) {
    TriangulateOptions options;
    options.triangles = budget;
    options.error_px = budget ? 0 : 0.2;
    NodeMesh made[2];
    for (const int threads : {1, 4}) {
      const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                      std::size_t(threads));
      made[threads == 4] = triangulate(map, options);
    }
    ASSERT_EQ(made[0].indices, made[1].indices);
    ASSERT_EQ(made[0].vertices.size(), made[1].vertices.size());
    EXPECT_EQ(std::memcmp(made[0].vertices.data(), made[1].vertices.data(),
                          made[0].vertices.size() * sizeof(NodeVertex)),
              0);
    EXPECT_EQ(made[0].quality, made[1].quality);
  }
}

TEST(Triangulate, the_sky_is_at_infinity_and_nothing_is_not_drawn) {
  // A floor; above it, sky on one side and nothing on the other.
  const EnvironmentMap map = make_node(
      32,
      [](const glm::dvec3& d) {
        return d.y < -0.05 ? -1.5 / d.y : std::numeric_limits<double>::infinity();
      },
      [](const glm::dvec3& d, double distance) {
        return glm::vec4(std::isfinite(distance) || d.x > 0 ? 1.0f : 0.0f);
      });
  const NodeMesh mesh = triangulate(map, {});
  for (int f = 0; f < 6; ++f) {
    const Image<float> drawn = drawn_disparity(mesh, f);
    const DepthImage& face = map.faces[std::size_t(f)];
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 32; ++x) {
        if (face.color(x, y).a == 0) {
          EXPECT_EQ(drawn(x, y), kNothing);
        } else if (!face.covered(x, y)) {
          EXPECT_NEAR(drawn(x, y), 0, 0.02);  // the far floor's error, 0.5 px
        } else {
          EXPECT_GT(drawn(x, y), 0);
        }
      }
  }
}

TEST(NodeMesh, quality_is_the_cosine_of_the_angle_of_view) {
  const auto at = [](const glm::vec3& p) {
    const float z = std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)});
    return NodeVertex{p / z, 1 / z, p / z};
  };
  // Head on: a triangle around the axis.
  const float s = 1e-3f;
  EXPECT_NEAR(triangle_quality(at({-s, -s, -2}), at({s, -s, -2}), at({0, s, -2})), 1, 1e-5);
  // A wall at 45 degrees, z = -2 - x, around the axis.
  EXPECT_NEAR(triangle_quality(at({-s, -s, -2 + s}), at({s, -s, -2 - s}), at({0, s, -2})),
              std::sqrt(0.5f), 1e-4);
  // A floor 1 m below, 3 m away: sin of the angle of elevation, 1 / sqrt(10).
  EXPECT_NEAR(triangle_quality(at({-s, -1, -3 - s}), at({s, -1, -3 - s}), at({0, -1, -3 + s})),
              1 / std::sqrt(10.0f), 1e-3);
  // Seen from the side.
  EXPECT_NEAR(triangle_quality(at({0, 0, -2}), at({0, 0, -3}), at({0, 0.5f, -2})), 0, 1e-6);
}

TEST(ValidateEnvironment, says_what_is_wrong_with_a_face) {
  const EnvironmentMap good = make_node(8, furnished_room());
  EXPECT_TRUE(validate_environment(good).ok());
  const auto reason = [](const EnvironmentMap& map) {
    const Result<> result = validate_environment(map);
    return result ? std::string("none") : result.error().message();
  };
  const auto has = [](const std::string& text, const char* part) {
    return text.find(part) != std::string::npos;
  };
  EnvironmentMap bad = good;
  bad.faces[2] = make_node(9, furnished_room()).faces[2];
  EXPECT_TRUE(has(reason(bad), "face 2 of 6")) << reason(bad);
  bad = good;
  std::swap(bad.faces[0], bad.faces[1]);
  EXPECT_TRUE(has(reason(bad), "does not look where it should")) << reason(bad);
  bad = good;
  bad.faces[4].camera.world_from_eye[3] = {0.1, 0, 0, 1};
  EXPECT_TRUE(has(reason(bad), "another point")) << reason(bad);
  bad = good;
  bad.faces[3].camera.window.right = 1.2;
  EXPECT_TRUE(has(reason(bad), "90 degrees")) << reason(bad);
  bad = good;
  bad.faces[3].depth(3, 3) = -1;
  EXPECT_TRUE(has(reason(bad), "not positive")) << reason(bad);
  // 1 / depth is infinite, or twice it is.
  for (const float near : {1e-40f, 3e-39f}) {
    bad = good;
    bad.faces[3].depth(2, 3) = near;
    EXPECT_TRUE(has(reason(bad), "too small")) << reason(bad);
    bad.faces[3].depth_kind = DepthKind::ray;
    EXPECT_TRUE(has(reason(bad), "too small")) << reason(bad);
  }
  bad = good;
  bad.faces[5].depth = Image<float>(7, 8, 1.0f);
  EXPECT_TRUE(has(reason(bad), "face 5 of 6")) << reason(bad);
}

TEST(Triangulate, refinement_ends_with_the_nearest_depths_that_are_allowed) {
  EnvironmentMap map = make_node(8, furnished_room());
  for (int x = 0; x < 8; x += 3) map.faces[3].depth(x, 3) = 1.1e-30f;
  ASSERT_TRUE(validate_environment(map).ok());
  TriangulateOptions options;
  options.reach = 1;
  TriangulateStats stats;
  EXPECT_GT(triangulate(map, options, &stats).triangles(), 0u);
  EXPECT_LE(stats.worst_error_px, 0.5);
}

// Seen through a doorway, a wall's, a ceiling's and a floor's ends make one straight silhouette.
// The middle of each triangle is where a surface is: between those of the texels around it.
TEST(Triangulate, no_surface_stands_in_the_air_behind_a_doorway) {
  const DistanceAlong partition = [](const glm::dvec3& d) {
    if (d.x >= 0) return std::numeric_limits<double>::infinity();
    const double s = -1.1 / d.x, y = s * d.y, z = s * d.z;
    const bool door = z > 0.35 && z < 1.4 && y < 0.7;
    return door ? std::numeric_limits<double>::infinity() : s;
  };
  const DistanceAlong rooms =
      nearest_of({box_around({-6.6, -1.45, -1.8}, {4.4, 1.15, 3.2}), partition});
  TriangulateOptions options;
  options.error_px = 0.5;
  const int n = 128;
  const NodeMesh mesh = triangulate(make_node(n, rooms), options);
  for (std::size_t f = 0; f < 6; ++f) {
    const FaceAxes& axes = face_axes()[f];
    const TriangleRange range = mesh.surfaces[f];
    for (std::uint32_t t = range.first; t < range.first + range.count; ++t) {
      glm::dvec3 direction(0);
      double disparity = 0;
      for (int k = 0; k < 3; ++k) {
        const NodeVertex& v = mesh.vertices[mesh.indices[3 * t + std::uint32_t(k)]];
        direction += glm::dvec3(v.direction) / 3.0;
        disparity += double(v.disparity) / 3;
      }
      double least = 1e9, most = 0;
      for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx) {
          const double step = 2.0 / n;
          const double there = 1 / rooms(direction + step * dx * glm::dvec3(axes.right) +
                                         step * dy * glm::dvec3(axes.up));
          least = std::min(least, there), most = std::max(most, there);
        }
      // Near a silhouette that is between the two surfaces' as well: what is between, in the air,
      // is as far from both.
      const double off = std::min(std::abs(disparity - least), std::abs(disparity - most));
      EXPECT_LT(off, 0.05 + 0.1 * disparity) << "face " << f << " shows " << 1 / disparity
                                             << " m, not " << 1 / most << " to " << 1 / least;
    }
  }
}

}  // namespace
}  // namespace rilievo
