#include "rilievo/environment_nodes/environment_nodes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "rilievo/capture/photograph_source.h"
#include "rilievo/core/file.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/core/random.h"
#include "rilievo/environment_nodes/bake_nodes.h"
#include "rilievo/environment_nodes/cube_grid.h"
#include "rilievo/environment_nodes/environment_drawable.h"
#include "rilievo/environment_nodes/environment_kind.h"
#include "rilievo/environment_nodes/file.h"
#include "rilievo/environment_nodes/node_test_helpers.h"
#include "rilievo/environment_nodes/seurat_test_helpers.h"
#include "rilievo/environment_nodes/working_set.h"

namespace rilievo {
namespace {

// Two rooms side by side, joined by a door: boxes from x = -4 to 0 and 0 to 4.
constexpr double kDoor = 0.6;
double two_rooms(const glm::dvec3& eye, const glm::dvec3& d) {
  const double side = eye.x < 0 ? -1 : 1;
  const auto leave = [&](const glm::dvec3& low, const glm::dvec3& high) {
    double nearest = INFINITY;
    for (int k = 0; k < 3; ++k)
      if (d[k] != 0) nearest = std::min(nearest, ((d[k] > 0 ? high[k] : low[k]) - eye[k]) / d[k]);
    return nearest;
  };
  const double here = side < 0 ? leave({-4, -1, -2}, {0, 1, 2}) : leave({0, -1, -2}, {4, 1, 2});
  const glm::dvec3 at = eye + here * d;
  if (std::abs(at.x) > 1e-9 || std::abs(at.z) > kDoor) return here;
  return side < 0 ? leave({-9, -1, -2}, {4, 1, 2}) : leave({-4, -1, -2}, {9, 1, 2});
}

EnvironmentMap room_node(const glm::dvec3& eye, int size = 16) {
  return make_node(
      size, [&](const glm::dvec3& d) { return two_rooms(eye, d); }, nullptr, eye);
}

EnvironmentNodes nodes_at(const std::vector<glm::dvec3>& eyes, int size = 16) {
  std::vector<DepthImage> pictures;
  for (const glm::dvec3& eye : eyes) {
    const EnvironmentMap map = room_node(eye, size);
    pictures.insert(pictures.end(), map.faces.begin(), map.faces.end());
  }
  Result<EnvironmentNodes> nodes = make_environment_nodes(std::move(pictures), {});
  EXPECT_TRUE(nodes.ok()) << nodes.error().message();
  return std::move(*nodes);
}

std::vector<glm::dvec3> random_eyes(Random& random, int count) {
  std::vector<glm::dvec3> eyes;
  while (int(eyes.size()) < count) {
    const glm::dvec3 eye(double(random.between(-3.8f, 3.8f)), double(random.between(-0.8f, 0.8f)),
                         double(random.between(-1.8f, 1.8f)));
    if (std::abs(eye.x) > 0.2) eyes.push_back(eye);
  }
  return eyes;
}

TEST(EnvironmentNodes, an_eye_is_served_by_the_nearest_nodes_that_see_it) {
  Random random(1);
  const std::vector<glm::dvec3> places = random_eyes(random, 12);
  const EnvironmentNodes nodes = nodes_at(places, 48);
  int hidden = 0, wrong = 0, asked = 0;
  for (const glm::dvec3& eye : random_eyes(random, 300)) {
    const std::vector<std::size_t> order = nodes_for_eye(nodes, eye);
    ASSERT_EQ(order.size(), places.size());
    std::vector<std::size_t> sorted = order;
    std::sort(sorted.begin(), sorted.end());
    for (std::size_t i = 0; i < sorted.size(); ++i) ASSERT_EQ(sorted[i], i);
    bool blind = false;
    for (std::size_t k = 0; k < order.size(); ++k) {
      const bool seen = sees(nodes.nodes[order[k]], eye);
      EXPECT_FALSE(seen && blind);  // those that see it come first
      if (k > 0 && seen == !blind) {
        EXPECT_LE(glm::distance(places[order[k - 1]], eye), glm::distance(places[order[k]], eye));
      }
      blind = !seen;
      // The slow way: is anything in between?
      const glm::dvec3 to = eye - places[order[k]];
      const bool truth = two_rooms(places[order[k]], to) >= 1;
      hidden += !truth;
      wrong += truth != seen;
      ++asked;
    }
  }
  EXPECT_GT(hidden, asked / 10);
  // A sketch's texel is 4 degrees wide; it errs beside the door's edges.
  EXPECT_LT(wrong, asked / 20);
}

// The slow way: the nearest texel within the angle, of all.
TEST(EnvironmentNodes, nothing_is_seen_nearer_than_where_a_sketch_is_clear) {
  Random random(7);
  const EnvironmentNodes made = nodes_at(random_eyes(random, 2));
  int asked = 0, wide = 0;
  for (const NodeSketch& node : made.nodes) {
    const int size = node.disparity[0].width();
    const auto direction = [&](std::size_t f, double x, double y) {
      const FaceAxes& axes = face_axes()[f];
      return glm::normalize(glm::dvec3(axes.forward) + x * glm::dvec3(axes.right) -
                            y * glm::dvec3(axes.up));
    };
    for (int i = 0; i < 100; ++i) {
      const auto f = std::size_t(random.between(0, 5.99f));
      const double u = double(random.between(-0.999f, 0.999f)),
                   v = double(random.between(-0.999f, 0.999f));
      const auto cell = [](double at) { return int(0.5 * (at + 1) * NodeSketch::kClearSize); };
      const double clear = double(node.clear[f](cell(u), cell(v)));
      double nearest = INFINITY;
      for (std::size_t g = 0; g < 6; ++g)
        for (int y = 0; y < size; ++y)
          for (int x = 0; x < size; ++x) {
            const double at_x = 2 * (x + 0.5) / size - 1, at_y = 2 * (y + 0.5) / size - 1;
            if (glm::dot(direction(g, at_x, at_y), direction(f, u, v)) <
                std::cos(NodeSketch::kClearAngle))
              continue;
            const double disparity =
                double(std::bit_cast<float>(std::uint32_t(node.disparity[g](x, y)) << 16));
            nearest = std::min(nearest, std::sqrt(1 + at_x * at_x + at_y * at_y) / disparity);
          }
      EXPECT_LE(clear, nearest * 1.0001);  // it is in single precision
      wide += clear > 0.5 * nearest;
      ++asked;
    }
  }
  // Cones around parts and around blocks of texels are wider than what they hold.
  EXPECT_GT(wide, asked / 2);
}

TEST(EnvironmentNodes, a_file_gives_back_every_node_and_keeps_the_pictures) {
  const TemporaryFolder folder;
  Random random(2);
  EnvironmentNodes made = nodes_at(random_eyes(random, 3));
  made.mesh.triangles = 300, made.mesh.error_px = 0.25, made.mesh.reach = 1.5;
  const std::filesystem::path path = folder / "rooms.exr";
  ASSERT_TRUE(save_environment_nodes(path, made).ok());
  const Result<EnvironmentNodes> back = open_environment_nodes(path);
  ASSERT_TRUE(back.ok()) << back.error().message();
  EXPECT_TRUE(back->pictures.empty());
  EXPECT_EQ(back->mesh.triangles, 300u);
  EXPECT_EQ(back->mesh.error_px, 0.25);
  EXPECT_EQ(back->mesh.reach, 1.5);
  EXPECT_EQ(back->name, "rooms");
  ASSERT_EQ(back->nodes.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_EQ(back->nodes[i].eye(), made.nodes[i].eye());
    const Result<EnvironmentMap> a = load_node(made, i), b = load_node(*back, i);
    ASSERT_TRUE(a.ok() && b.ok());
    const NodeMesh mesh_a = triangulate(*a, made.mesh), mesh_b = triangulate(*b, back->mesh);
    EXPECT_EQ(mesh_a.indices, mesh_b.indices);
    for (std::size_t f = 0; f < 6; ++f) {
      EXPECT_EQ(a->faces[f].color, b->faces[f].color);
      EXPECT_EQ(a->faces[f].depth, b->faces[f].depth);
      EXPECT_EQ(back->nodes[i].distance[f], made.nodes[i].distance[f]);
    }
  }
  // Again from the file, byte for byte.
  ASSERT_TRUE(save_environment_nodes(folder / "again.exr", *back).ok());
  EXPECT_EQ(*read_file(path, 1u << 24), *read_file(folder / "again.exr", 1u << 24));
}

TEST(EnvironmentNodes, files_that_hold_none_are_refused_by_name) {
  const TemporaryFolder folder;
  const EnvironmentNodes made = nodes_at({{-1, 0, 0}});
  const std::filesystem::path path = folder / "bad.exr";
  FileAttributes attributes;
  attributes.file["representation"] = "environment-nodes";
  attributes.file["mesh"] = "0 0.5 0";
  const auto expect_refused = [&](std::vector<DepthImage> pictures, const char* reason) {
    ASSERT_TRUE(save_pictures(path, pictures, attributes).ok());
    const Result<EnvironmentNodes> nodes = open_environment_nodes(path);
    ASSERT_FALSE(nodes.ok()) << reason;
    EXPECT_EQ(nodes.error().where, path.string());
    EXPECT_NE(nodes.error().reason.find(reason), std::string::npos) << nodes.error().reason;
  };
  std::vector<DepthImage> pictures = made.pictures;
  pictures.pop_back();
  expect_refused(pictures, "six faces");
  // Of different sizes.
  pictures = made.pictures;
  pictures[4] = room_node({-1, 0, 0}, 8).faces[4];
  expect_refused(pictures, "node 0: face 4");
  // In another order.
  pictures = made.pictures;
  std::swap(pictures[0], pictures[3]);
  expect_refused(pictures, "node 0: face");
  // From another point.
  pictures = made.pictures;
  pictures[5] = room_node({-2, 0, 0}).faces[5];
  expect_refused(pictures, "another point");
  pictures = made.pictures;
  for (const char* mesh :
       {"", "1 2", "0 0 0", "-1 1 1", "1.5 1 1", "x 1 1", "1 1 1 1", "1 inf 1"}) {
    attributes.file["mesh"] = mesh;
    expect_refused(pictures, "triangulate");
  }
  attributes.file.erase("mesh");
  expect_refused(pictures, "triangulated");
  attributes.file.clear();
  expect_refused(pictures, "no environment nodes");
}

// What was taken all around one point comes back from views of it that look elsewhere.
TEST(EnvironmentNodes, views_around_a_point_are_a_node) {
  const glm::dvec3 eye(-1.5, 0.2, 0.3);
  const EnvironmentMap truth = room_node(eye, 64);
  // Turned by a third of a right angle about the vertical.
  std::vector<DepthImage> views;
  const glm::dmat3 turn(glm::dvec3(std::cos(0.5), 0, std::sin(0.5)), glm::dvec3(0, 1, 0),
                        glm::dvec3(-std::sin(0.5), 0, std::cos(0.5)));
  for (DepthImage view : truth.faces) {
    for (int k = 0; k < 3; ++k)
      view.camera.world_from_eye[k] =
          glm::dvec4(turn * glm::dvec3(view.camera.world_from_eye[k]), 0);
    for (int y = 0; y < 64; ++y)
      for (int x = 0; x < 64; ++x)
        view.depth(x, y) =
            float(two_rooms(eye, world_from_raster(view.camera, {x + 0.5, y + 0.5}, 1.0) - eye));
    views.push_back(std::move(view));
  }
  const Result<EnvironmentMap> made = environment_around(views, 64);
  ASSERT_TRUE(made.ok()) << made.error().message();
  int off = 0;
  for (std::size_t f = 0; f < 6; ++f)
    for (std::size_t i = 0; i < truth.faces[f].depth.texels().size(); ++i) {
      const float a = truth.faces[f].depth.texels()[i], b = made->faces[f].depth.texels()[i];
      // Nearest texels: a texel's angle off on a slanted wall, another surface at silhouettes.
      off += !(std::abs(a - b) < 0.15f * a);
    }
  EXPECT_LT(off, 6 * 64 * 64 / 100);
  // One view alone leaves the rest empty.
  const Result<EnvironmentMap> part = environment_around(std::span(views).first(1), 32);
  ASSERT_TRUE(part.ok());
  std::size_t covered = 0;
  for (const DepthImage& face : part->faces)
    for (const float depth : face.depth.texels()) covered += depth != kNoDepth;
  EXPECT_NEAR(double(covered), 32 * 32, 120);
}

TEST(EnvironmentNodes, a_capture_in_seurats_format_is_baked_as_the_node_that_it_was) {
  const TemporaryFolder folder;
  std::vector<DepthImage> views;
  for (const glm::dvec3& eye : {glm::dvec3(-1.5, 0.2, 0.3), glm::dvec3(2, 0, -0.5)}) {
    const std::filesystem::path of_node = folder / std::to_string(views.size());
    ASSERT_TRUE(save_seurat_capture(of_node, room_node(eye)).ok());
    const Result<SeuratCapture> capture = load_seurat_capture(of_node);
    ASSERT_TRUE(capture.ok()) << capture.error().message();
    views.insert(views.end(), capture->groups[0].begin(), capture->groups[0].end());
  }
  PhotographSource source("capture", views);
  NodeBakeOptions options;
  options.face = 16;
  const Result<NodeBake> baked = bake_nodes(source, options);
  ASSERT_TRUE(baked.ok()) << baked.error().message();
  EXPECT_FALSE(baked->held.has_value());
  ASSERT_EQ(baked->nodes.nodes.size(), 2u);
  for (std::size_t i = 0; i < 12; ++i) {
    EXPECT_EQ(baked->nodes.pictures[i].color, views[i].color) << i;
    for (std::size_t t = 0; t < views[i].depth.texels().size(); ++t)
      // There and back between eye_z and the length of the ray.
      EXPECT_NEAR(baked->nodes.pictures[i].depth.texels()[t], views[i].depth.texels()[t],
                  1e-5f * views[i].depth.texels()[t]);
  }
  // Its own nodes, no others.
  options.at = {{0, 0, 0}};
  EXPECT_FALSE(bake_nodes(source, options).ok());
}

TEST(EnvironmentNodes, a_capture_does_not_take_the_places_of_a_scenes_nodes) {
  const EnvironmentMap map = room_node({-1.5, 0.2, 0.3});
  PhotographSource source("capture", {map.faces.begin(), map.faces.end()});
  for (const auto& [name, value] : {std::pair("auto", "2"), {"region", "0,0,0,1,1,1"}}) {
    OptionValues values(environment_nodes_kind().bake_options);
    ASSERT_TRUE(values.set("face", "16").ok());
    EXPECT_TRUE(environment_nodes_kind().bake({source, {}}, values, {}).ok());
    ASSERT_TRUE(values.set(name, value).ok());
    const Result<Baked> baked = environment_nodes_kind().bake({source, {}}, values, {});
    ASSERT_FALSE(baked.ok()) << name;
    EXPECT_EQ(baked.error().where, std::string("--") + name);
  }
}

TEST(EnvironmentNodes, as_many_are_in_memory_as_are_drawn) {
  using Given = std::vector<std::pair<const char*, const char*>>;
  const auto options = [](const Given& given) {
    OptionValues values(environment_nodes_kind().draw_options);
    for (const auto& [name, value] : given) EXPECT_TRUE(values.set(name, value).ok());
    return environment_draw_options(values);
  };
  EXPECT_EQ(options({})->nodes, 2u);
  EXPECT_EQ(options({})->resident, 4u);
  EXPECT_EQ(options({{"nodes", "8"}})->nodes, 8u);
  EXPECT_EQ(options({{"nodes", "8"}})->resident, 8u);
  EXPECT_EQ(options({{"resident", "1"}})->nodes, 2u);
  EXPECT_EQ(options({{"resident", "1"}})->resident, 3u);
  EXPECT_EQ(options({{"more", "0"}, {"resident", "1"}})->resident, 2u);
  EXPECT_EQ(options({{"nodes", "1"}, {"resident", "1"}})->resident, 1u);
  EXPECT_EQ(options({{"nodes", "3"}, {"resident", "2"}})->resident, 4u);
  EXPECT_TRUE(options({})->fills);
  EXPECT_FALSE(options({{"more", "0"}})->fills);
  EXPECT_FALSE(options({{"nodes", "1"}})->fills);
}

// Seurat's own test data: its one view has parallel rays, which no node has.
TEST(EnvironmentNodes, a_view_that_is_not_from_a_point_is_refused) {
  DepthImage view = room_node({-1, 0, 0}).faces[0];
  view.name = "flat";
  view.camera.projection = Projection::parallel;
  PhotographSource source("capture", {view});
  const Result<NodeBake> baked = bake_nodes(source, {});
  ASSERT_FALSE(baked.ok());
  EXPECT_EQ(baked.error().where, "flat");
}

TEST(EnvironmentNodes, a_walk_passes_through_every_node) {
  Random random(3);
  for (const int count : {1, 2, 7}) {
    const std::vector<glm::dvec3> eyes = random_eyes(random, count);
    const CameraPath path = walk_through(nodes_at(eyes));
    ASSERT_TRUE(validate(path).ok());
    if (count == 1) continue;
    for (const glm::dvec3& eye : eyes)
      EXPECT_TRUE(std::any_of(path.keys.begin(), path.keys.end(),
                              [&](const PathKey& key) { return key.eye == eye; }));
  }
}

TEST(NodeWorkingSet, holds_no_more_nodes_than_it_may_and_always_gets_those_it_waits_for) {
  Random random(4);
  const EnvironmentNodes nodes = nodes_at(random_eyes(random, 9), 8);
  for (const std::size_t most : {1u, 2u, 4u}) {
    std::vector<std::size_t> held;
    NodeWorkingSet working(nodes, most);
    const auto take_all = [&] {
      while (std::optional<LoadedNode> node = working.take()) {
        EXPECT_EQ(glm::dvec3(node->mesh.world_from_node[3]), nodes.nodes[node->node].eye());
        EXPECT_EQ(std::count(held.begin(), held.end(), node->node), 0);
        held.push_back(node->node);
      }
    };
    for (int step = 0; step < 200; ++step) {
      const std::vector<std::size_t> wanted = nodes_for_eye(nodes, random_eyes(random, 1)[0]);
      working.want(wanted, [&](std::size_t node) {
        ASSERT_EQ(std::count(held.begin(), held.end(), node), 1);
        held.erase(std::find(held.begin(), held.end(), node));
      });
      // Some frames draw nothing, some one node, some as many as there may be.
      for (std::size_t k = 0; k < std::min<std::size_t>(most, std::size_t(random.below(5))); ++k) {
        take_all();
        if (std::count(held.begin(), held.end(), wanted[k]) == 0) {
          ASSERT_TRUE(working.wait_for(wanted[k]));
          take_all();
        }
        ASSERT_EQ(std::count(held.begin(), held.end(), wanted[k]), 1);
      }
      EXPECT_LE(held.size(), working.in_memory());
      EXPECT_LE(working.in_memory(), most);
    }
    EXPECT_EQ(working.most_in_memory(), most);
    EXPECT_FALSE(working.error().has_value());
  }
}

TEST(NodeWorkingSet, says_what_cannot_be_loaded_and_goes_on_without_it) {
  const TemporaryFolder folder;
  const std::filesystem::path path = folder / "n.exr";
  ASSERT_TRUE(save_environment_nodes(path, nodes_at({{-1, 0, 0}, {1, 0, 0}}, 8)).ok());
  const Result<EnvironmentNodes> nodes = open_environment_nodes(path);
  ASSERT_TRUE(nodes.ok());
  NodeWorkingSet working(*nodes, 2);
  const std::size_t first[] = {1}, both[] = {0, 1};
  working.want(first, [](std::size_t) {});
  ASSERT_TRUE(working.wait_for(1));
  ASSERT_TRUE(working.take().has_value());
  std::filesystem::remove(path);
  working.want(both, [](std::size_t) {});
  EXPECT_FALSE(working.wait_for(0));
  ASSERT_TRUE(working.error().has_value());
  EXPECT_EQ(working.error()->where, path.string());
  EXPECT_EQ(working.in_memory(), 1u);
}

}  // namespace
}  // namespace rilievo
