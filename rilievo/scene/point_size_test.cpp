#include "rilievo/scene/point_size.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <tuple>

#include "rilievo/core/random.h"

namespace rilievo {
namespace {

Mesh cloud_of(const std::vector<glm::vec3>& positions) {
  Mesh mesh;
  mesh.primitive = Primitive::points;
  mesh.positions = positions;
  mesh.indices.resize(positions.size());
  std::iota(mesh.indices.begin(), mesh.indices.end(), 0u);
  return mesh;
}

TEST(PointSize, is_read_in_units_and_in_pixels) {
  EXPECT_FLOAT_EQ(parse_point_size("0.02")->metres, 0.02f);
  EXPECT_FLOAT_EQ(parse_point_size("2px")->pixels, 2);
  EXPECT_EQ(parse_point_size("2px")->metres, 0);
  EXPECT_EQ(parse_point_size("auto")->metres, 0);
  for (const char* bad : {"", "0", "-1", "2 px", "2pxx", "px", "nan", "inf", "1e", "0px"})
    EXPECT_FALSE(parse_point_size(bad)) << bad;
}

TEST(PointSize, closes_a_square_grid) {
  std::vector<glm::vec3> grid;
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x) grid.push_back({0.1f * float(x), 0, 0.1f * float(y)});
  Mesh mesh = cloud_of(grid);
  sort_points(mesh);
  const float diameter = point_diameter(mesh);
  // A disc of the diagonal closes it; neighbours that the curve leads away from are missed.
  EXPECT_GT(diameter, 0.1f * std::sqrt(2.0f));
  EXPECT_LT(diameter, 0.1f * 3.0f);
}

TEST(PointSize, few_points_stay_points_and_points_in_one_place_have_no_size) {
  EXPECT_FLOAT_EQ(point_diameter(cloud_of({{0, 0, 0}, {3, 4, 0}})), 0.05f);
  EXPECT_EQ(point_diameter(cloud_of({{1, 2, 3}, {1, 2, 3}, {1, 2, 3}})), 0);
  EXPECT_EQ(point_diameter(cloud_of({{1, 2, 3}})), 0);
}

// The boxes of runs are then small beside the cloud.
TEST(PointSize, sorted_points_are_near_each_other_and_keep_their_colours) {
  Random random(7);
  std::vector<glm::vec3> positions;
  for (int i = 0; i < 64 * 1024; ++i)
    positions.push_back({random.unit(), random.unit(), random.unit()});
  Mesh mesh = cloud_of(positions);
  for (const glm::vec3& p : positions) mesh.colors.push_back(glm::vec4(p, 1));
  sort_points(mesh);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    ASSERT_EQ(glm::vec3(mesh.colors[i]), mesh.positions[i]);
  update_bounds(mesh);
  double volume = 0;
  for (const Box& run : mesh.run_bounds) {
    const glm::vec3 e = run.extent();
    volume += double(e.x * e.y * e.z);
  }
  EXPECT_LT(volume, 4);  // of 64 runs, which would have 64 in any other order
  const auto less = [](const glm::vec3& a, const glm::vec3& b) {
    return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
  };
  std::sort(positions.begin(), positions.end(), less);
  std::sort(mesh.positions.begin(), mesh.positions.end(), less);
  EXPECT_EQ(positions, mesh.positions);
}

// Whatever reads a file: what does not bend is sorted, and what does has the size that it has
// sorted.
TEST(PointSize, is_that_of_sorted_points_whether_a_mesh_bends_or_not) {
  Random random(5);
  Scene scene;
  std::vector<glm::vec3> positions;
  for (int i = 0; i < 50000; ++i) {
    const float x = random.unit();
    positions.push_back({x, 0, random.unit()});
  }
  scene.meshes = {cloud_of(positions), cloud_of(positions)};
  const int bent = 1;
  finish_points(scene, {}, {&bent, 1});
  EXPECT_NE(scene.meshes[0].positions, positions);
  EXPECT_EQ(scene.meshes[1].positions, positions);
  EXPECT_EQ(scene.meshes[1].width, scene.meshes[0].width);
  EXPECT_LT(scene.meshes[0].width, 0.014f);  // less than what few points have
}

TEST(PointSize, the_smallest_stretch_of_a_placement_is_its_smallest_singular_value) {
  glm::mat4 m(1.0f);
  m[0] *= 2.0f, m[1] *= -3.0f, m[2] *= 5.0f;
  EXPECT_NEAR(smallest_stretch(m), 2, 1e-9);
  m[1] = glm::vec4(0);
  EXPECT_EQ(smallest_stretch(m), 0);
}

}  // namespace
}  // namespace rilievo
