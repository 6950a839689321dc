#include "rilievo/environment_nodes/placement.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "rilievo/core/random.h"

namespace rilievo {
namespace {

// Boxes, seen from both sides.
Scene scene_of(const std::vector<Box>& boxes) {
  Scene scene;
  Material material;
  material.double_sided = true;
  scene.materials.push_back(material);
  for (const Box& box : boxes) {
    Mesh mesh;
    mesh.material = 0;
    for (const glm::vec3& corner : box.corners()) {
      mesh.positions.push_back(corner);
      mesh.normals.push_back({0, 1, 0});
    }
    mesh.indices = {0, 2, 1, 1, 2, 3, 4, 5, 6, 5, 7, 6, 0, 1, 4, 1, 5, 4,
                    2, 6, 3, 3, 6, 7, 0, 4, 2, 2, 4, 6, 1, 3, 5, 3, 7, 5};
    scene.meshes.push_back(mesh);
    Model model;
    model.parts.push_back({int(scene.meshes.size()) - 1});
    scene.models.push_back(model);
    Object object;
    object.model = int(scene.models.size()) - 1;
    scene.objects.push_back(object);
  }
  finish(scene);
  return scene;
}

// Three rooms in a row, with doors that are not opposite each other.
Scene three_rooms() {
  std::vector<Box> boxes{{{-1, -0.1f, -2}, {13, 0, 2}},    {{-1, 2.5f, -2}, {13, 2.6f, 2}},
                         {{-0.1f, 0, -2}, {0, 2.5f, 2}},   {{12, 0, -2}, {12.1f, 2.5f, 2}},
                         {{0, 0, -2.1f}, {12, 2.5f, -2}},  {{0, 0, 2}, {12, 2.5f, 2.1f}},
                         {{4, 0, -2}, {4.1f, 2.5f, 1.2f}}, {{8, 0, -1.2f}, {8.1f, 2.5f, 2}}};
  return scene_of(boxes);
}

PlacementOptions options_for_rooms() {
  PlacementOptions options;
  options.region = {{0.3f, 0.8f, -1.7f}, {11.7f, 1.9f, 1.7f}};
  options.candidates = 60;
  options.eyes = 60;
  options.rays = 60;
  return options;
}

TEST(PlaceNodes, three_rooms_take_three_nodes_and_a_row_takes_more) {
  const Scene scene = three_rooms();
  const Result<RayScene> rays = RayScene::create(scene);
  ASSERT_TRUE(rays.ok());
  PlacementOptions options = options_for_rooms();
  options.nodes = 6;
  const Result<Placement> placed = place_nodes(*rays, options);
  ASSERT_TRUE(placed.ok()) << placed.error().message();
  ASSERT_GE(placed->share.size(), 3u);
  EXPECT_LT(placed->share[0], 0.75);
  EXPECT_GT(placed->share[2], 0.9);
  bool in_room[3] = {};
  for (int i = 0; i < 3; ++i) in_room[std::min(2, int(placed->eyes[std::size_t(i)].x / 4))] = true;
  EXPECT_TRUE(in_room[0] && in_room[1] && in_room[2]);
  // What it says is what is measured, and no worse than three places in a row along a wall.
  const std::vector<glm::dvec3> first(placed->eyes.begin(), placed->eyes.begin() + 3);
  const Result<double> held = share_held(*rays, options, first);
  ASSERT_TRUE(held.ok());
  EXPECT_DOUBLE_EQ(*held, placed->share[2]);
  const Result<double> row =
      share_held(*rays, options, {{3, 1.6, 1.6}, {6, 1.6, 1.6}, {9, 1.6, 1.6}});
  ASSERT_TRUE(row.ok());
  EXPECT_GE(*held, *row);
}

// The rooms as a scanner would have them: points on the walls, 6 cm wide and 4 cm apart.
Scene points_of(const Scene& walls) {
  Scene scene;
  Mesh mesh;
  mesh.primitive = Primitive::points;
  mesh.width = 0.06f;
  for (const Mesh& wall : walls.meshes)
    for (std::size_t i = 0; i < wall.indices.size(); i += 3) {
      const glm::vec3 a = wall.positions[wall.indices[i]];
      const glm::vec3 b = wall.positions[wall.indices[i + 1]] - a;
      const glm::vec3 c = wall.positions[wall.indices[i + 2]] - a;
      const int rows = 1 + int(glm::length(b) / 0.04f), columns = 1 + int(glm::length(c) / 0.04f);
      for (int row = 0; row <= rows; ++row)
        for (int column = 0; column <= columns; ++column) {
          const float u = float(row) / float(rows), v = float(column) / float(columns);
          if (u + v <= 1) mesh.positions.push_back(a + u * b + v * c);
        }
    }
  for (std::size_t i = 0; i < mesh.positions.size(); ++i) mesh.indices.push_back(std::uint32_t(i));
  scene.meshes.push_back(mesh);
  scene.models.emplace_back().parts = {Part{0}};
  scene.objects.emplace_back();
  finish(scene);
  return scene;
}

TEST(PlaceNodes, points_are_seen_and_hide_what_is_behind_them) {
  const Scene scene = points_of(three_rooms());
  const Result<RayScene> rays = RayScene::create(scene, 0, RayParts::strokes);
  ASSERT_TRUE(rays.ok());
  PlacementOptions options = options_for_rooms();
  options.nodes = 3;
  const Result<Placement> placed = place_nodes(*rays, options);
  ASSERT_TRUE(placed.ok()) << placed.error().message();
  ASSERT_EQ(placed->eyes.size(), 3u);
  // A node in each room, and none holds another's walls.
  bool room[3] = {};
  for (const glm::dvec3& eye : placed->eyes) room[std::min(2, int(eye.x / 4))] = true;
  EXPECT_TRUE(room[0] && room[1] && room[2]);
  EXPECT_LT(placed->share[0], 0.6);
  EXPECT_GT(placed->share[2], 0.8);
}

TEST(PlaceNodes, shares_grow_and_do_not_depend_on_threads) {
  const Scene scene = three_rooms();
  const Result<RayScene> rays = RayScene::create(scene);
  ASSERT_TRUE(rays.ok());
  Placement made[2];
  for (const int threads : {1, 4}) {
    const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                    std::size_t(threads));
    Result<Placement> placed = place_nodes(*rays, options_for_rooms());
    ASSERT_TRUE(placed.ok());
    made[threads == 4] = *placed;
  }
  EXPECT_EQ(made[0].eyes, made[1].eyes);
  EXPECT_EQ(made[0].share, made[1].share);
  for (std::size_t i = 1; i < made[0].share.size(); ++i)
    EXPECT_GT(made[0].share[i], made[0].share[i - 1]);
  EXPECT_LE(made[0].share.back(), 1.0);
}

// Also what it sees at a grazing angle: a plain up to the horizon.
TEST(PlaceNodes, a_node_where_the_eye_is_holds_all_that_it_sees) {
  const Scene scene = scene_of({{{-500, -1, -500}, {500, 0, 500}}, {{-5, 0, -9}, {5, 3, -8}}});
  const Result<RayScene> rays = RayScene::create(scene);
  ASSERT_TRUE(rays.ok());
  PlacementOptions options;
  const glm::vec3 eye(0, 1.6f, 0);
  options.region = {eye, eye};
  const Result<double> here = share_held(*rays, options, {eye});
  ASSERT_TRUE(here.ok());
  EXPECT_GT(*here, 0.999);
  // Elsewhere, what is seen at a grazing angle from both counts too, but not what the wall hides.
  const Result<double> there = share_held(*rays, options, {{0, 1.6, -20}});
  ASSERT_TRUE(there.ok());
  EXPECT_LT(*there, 0.9);
}

// Around in the last room, to its door, and a step through it.
std::vector<glm::vec3> way_through_rooms() {
  return {{11, 1.6f, 1.5f}, {11, 1.6f, -1}, {8.5f, 1.6f, -1.6f}, {7.5f, 1.6f, -1.7f}};
}

// From the nearest point of the way, metres.
double distance_from(const std::vector<glm::vec3>& path, const glm::vec3& at) {
  double least = INFINITY;
  for (std::size_t i = 1; i < path.size(); ++i) {
    const glm::vec3 along = path[i] - path[i - 1];
    const float share = glm::dot(at - path[i - 1], along) / glm::dot(along, along);
    const glm::vec3 foot = path[i - 1] + std::clamp(share, 0.0f, 1.0f) * along;
    least = std::min(least, double(glm::distance(at, foot)));
  }
  return least;
}

// The slow way: which triangle each of many eyes sees in many directions, and whether a node sees
// the same place.
TEST(PlaceNodes, along_a_path_nodes_stand_on_it_and_hold_what_is_seen_from_it) {
  const Scene scene = three_rooms();
  const Result<RayScene> rays = RayScene::create(scene);
  ASSERT_TRUE(rays.ok());
  PlacementOptions options = options_for_rooms();
  options.nodes = 2;
  const Result<Placement> in_region = place_nodes(*rays, options);
  options.path = way_through_rooms();
  const Result<Placement> on_path = place_nodes(*rays, options);
  ASSERT_TRUE(in_region.ok() && on_path.ok());
  ASSERT_EQ(on_path->eyes.size(), 2u);
  for (const glm::dvec3& eye : on_path->eyes)
    EXPECT_LT(distance_from(options.path, glm::vec3(eye)), 1e-5);
  const auto hidden_share = [&](const std::vector<glm::dvec3>& nodes) {
    Random random(7);
    int seen = 0, hidden = 0;
    for (std::size_t way = 1; way < options.path.size(); ++way)
      for (int step = 0; step < 40; ++step) {
        const glm::vec3 eye = glm::mix(options.path[way - 1], options.path[way], step / 40.0f);
        for (int ray = 0; ray < 50; ++ray) {
          const glm::vec3 to = glm::normalize(
              glm::vec3(random.between(-1, 1), random.between(-1, 1), random.between(-1, 1)));
          const std::optional<RayHit> hit = rays->first_hit(eye, to, 0.0f, 1e6f);
          if (!hit) continue;
          const glm::vec3 at = eye + (hit->distance - 1e-3f) * to;
          ++seen;
          hidden += std::none_of(nodes.begin(), nodes.end(), [&](const glm::dvec3& node) {
            return !rays->occluded(glm::vec3(node), at - glm::vec3(node), 0.0f, 1.0f);
          });
        }
      }
    EXPECT_GT(seen, 5000);
    return double(hidden) / seen;
  };
  const double hidden = hidden_share(on_path->eyes);
  EXPECT_LT(hidden, 0.5 * hidden_share(in_region->eyes));
  // As it says, but for the error of 3600 and of 6000 rays.
  EXPECT_NEAR(1 - hidden, on_path->share.back(), 0.01);
}

TEST(PlaceNodes, beside_a_path_that_is_too_close_to_walls_nodes_stand_in_the_region) {
  const Scene scene = three_rooms();
  const Result<RayScene> rays = RayScene::create(scene);
  ASSERT_TRUE(rays.ok());
  PlacementOptions options = options_for_rooms();
  options.path = {{1, 1.6f, -1.95f}, {3, 1.6f, -1.95f}};
  const Result<Placement> placed = place_nodes(*rays, options);
  ASSERT_TRUE(placed.ok()) << placed.error().message();
  EXPECT_GT(placed->share.back(), 0.99);
  options.path = {{2, 1.6f, 0}};
  const Result<Placement> standing = place_nodes(*rays, options);
  ASSERT_TRUE(standing.ok()) << standing.error().message();
  ASSERT_EQ(standing->eyes.size(), 1u);
  EXPECT_EQ(glm::vec3(standing->eyes[0]), options.path[0]);
  EXPECT_EQ(standing->share[0], 1.0);
}

TEST(PlaceNodes, what_cannot_be_is_refused) {
  const Scene scene = three_rooms();
  const Result<RayScene> rays = RayScene::create(scene);
  ASSERT_TRUE(rays.ok());
  PlacementOptions options = options_for_rooms();
  options.region = {};
  EXPECT_FALSE(place_nodes(*rays, options).ok());
  options = options_for_rooms();
  options.path = {{1, 1.6f, 0}, {std::nanf(""), 1.6f, 0}};
  EXPECT_FALSE(place_nodes(*rays, options).ok());
  options = options_for_rooms();
  options.clearance = 50;
  const Result<Placement> crowded = place_nodes(*rays, options);
  ASSERT_FALSE(crowded.ok());
  EXPECT_NE(crowded.error().message().find("as far from surfaces"), std::string::npos);
}

}  // namespace
}  // namespace rilievo
