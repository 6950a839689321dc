#include "rilievo/scene/builtin/builtin.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <string>

#include "rilievo/scene/builtin/parts.h"

namespace rilievo {
namespace {

// Triangles with no area, and triangles whose corners' normals point to the other side.
struct Faults {
  std::uint64_t empty = 0, turned = 0, all = 0;
};
void count_faults(const Mesh& mesh, Faults& faults) {
  for (std::size_t i = 0; i < mesh.indices.size(); i += 3) {
    const std::uint32_t a = mesh.indices[i], b = mesh.indices[i + 1], c = mesh.indices[i + 2];
    const glm::dvec3 p(mesh.positions[a]), u = glm::dvec3(mesh.positions[b]) - p,
                                           v = glm::dvec3(mesh.positions[c]) - p;
    const glm::dvec3 area = glm::cross(u, v);
    ++faults.all;
    // Thinner than a millionth of its longest side: degenerate for floats.
    faults.empty += glm::length(area) <= 1e-6 * std::max(glm::dot(u, u), glm::dot(v, v));
    const glm::dvec3 n(mesh.normals[a] + mesh.normals[b] + mesh.normals[c]);
    faults.turned += glm::dot(area, n) < 0;
  }
}

BuiltinScene made(const std::string& spec) {
  Result<BuiltinScene> result = make_builtin(spec);
  EXPECT_TRUE(result.ok()) << result.error().message();
  return *std::move(result);
}

class EveryScene : public testing::TestWithParam<const char*> {};

TEST_P(EveryScene, is_valid_and_of_the_size_asked_for) {
  for (const std::uint64_t triangles : {100'000, 300'000, 2'000'000}) {
    const BuiltinScene built =
        made(std::string("builtin:") + GetParam() + "?triangles=" + std::to_string(triangles));
    const Result<> valid = validate(built.scene);
    EXPECT_TRUE(valid.ok()) << valid.error().message();
    EXPECT_EQ(built.scene.name, GetParam());
    EXPECT_NEAR(double(count_triangles(built.scene)), double(triangles), 0.05 * triangles);

    Faults faults;
    for (const Mesh& mesh : built.scene.meshes) {
      ASSERT_EQ(mesh.normals.size(), mesh.positions.size());
      count_faults(mesh, faults);
    }
    EXPECT_EQ(faults.empty, 0u);
    EXPECT_LE(faults.turned, faults.all / 25);  // see Tree below
  }
}

TEST_P(EveryScene, is_seen_from_its_path) {
  const BuiltinScene built = made(std::string("builtin:") + GetParam() + "?triangles=100000");
  const Result<> valid = validate(built.path);
  ASSERT_TRUE(valid.ok()) << valid.error().message();
  EXPECT_GE(frame_count(built.path), 900);
  std::vector<glm::mat4> world_from_model;
  pose(built.scene, 0, world_from_model);
  for (const int frame : {0, 60, 119}) {
    const Camera camera = camera_at(built.path, frame_time(built.path, frame), 1280, 720);
    std::uint64_t in_view = 0, all = 0;
    for (std::size_t i = 0; i < built.scene.objects.size(); ++i) {
      const Model& model = built.scene.models[built.scene.objects[i].model];
      const Box box = transformed(world_from_model[i], model.bounds);
      const glm::dvec3 raster = raster_from_world(camera, box.center());
      all += model.triangles;
      if (raster.z > 0 && raster.x > 0 && raster.x < 1280 && raster.y > 0 && raster.y < 720)
        in_view += model.triangles;
      // All of it lies before the far plane.
      for (const glm::vec3& corner : box.corners())
        EXPECT_LT(raster_from_world(camera, corner).z, camera.z_far);
    }
    EXPECT_GT(in_view, all / 2);
  }
}

TEST_P(EveryScene, is_the_same_every_time) {
  const std::string spec = std::string("builtin:") + GetParam() + "?triangles=100000&seed=";
  const Scene a = made(spec + "7").scene, b = made(spec + "7").scene;
  ASSERT_EQ(a.meshes.size(), b.meshes.size());
  for (std::size_t i = 0; i < a.meshes.size(); ++i) {
    EXPECT_EQ(a.meshes[i].positions, b.meshes[i].positions);
    EXPECT_EQ(a.meshes[i].indices, b.meshes[i].indices);
    EXPECT_EQ(a.meshes[i].colors, b.meshes[i].colors);
  }
  ASSERT_EQ(a.objects.size(), b.objects.size());
  for (std::size_t i = 0; i < a.objects.size(); ++i)
    EXPECT_EQ(a.objects[i].placement, b.objects[i].placement);
}

INSTANTIATE_TEST_SUITE_P(Builtin, EveryScene,
                         testing::Values("bridge", "forest", "stonehenge", "teapots", "teapot",
                                         "fern", "fish", "cube"),
                         [](const auto& info) { return std::string(info.param); });

TEST(Builtin, a_wrong_specification_says_what_is_allowed) {
  EXPECT_TRUE(is_builtin("builtin:forest"));
  EXPECT_FALSE(is_builtin("forest.glb"));
  const std::pair<const char*, const char*> bad[] = {
      {"forest", "builtin:"},
      {"builtin:", "forest"},
      {"builtin:wood", "teapots"},
      {"builtin:forest?size=3", "triangles=N"},
      {"builtin:forest?triangles", "10000 to 100000000"},
      {"builtin:forest?triangles=", "10000 to 100000000"},
      {"builtin:forest?triangles=9999", "10000 to 100000000"},
      {"builtin:forest?triangles=1e6", "10000 to 100000000"},
      {"builtin:forest?triangles=-20000", "10000 to 100000000"},
      {"builtin:forest?triangles=99999999999999999999999", "10000 to 100000000"},
      {"builtin:forest?seed=x", "whole number"},
      {"builtin:forest?&", "no option \"\""},
  };
  for (const auto& [spec, reason] : bad) {
    const Result<BuiltinScene> result = make_builtin(spec);
    ASSERT_FALSE(result.ok()) << spec;
    EXPECT_EQ(result.error().where, spec);
    EXPECT_NE(result.error().reason.find(reason), std::string::npos) << result.error().message();
  }
}

TEST(Builtin, seeds_differ) {
  const Scene a = made("builtin:forest?triangles=60000&seed=1").scene;
  const Scene b = made("builtin:forest?triangles=60000&seed=2").scene;
  EXPECT_NE(a.meshes[0].positions, b.meshes[0].positions);
}

TEST(Forest, a_larger_one_contains_the_smaller_one_farther_out) {
  const BuiltinScene small = made("builtin:forest?triangles=300000");
  const BuiltinScene large = made("builtin:forest?triangles=3000000");
  double reach = 0;
  std::vector<glm::mat4> small_trees, large_trees;
  for (const Object& object : small.scene.objects)
    if (object.name == "tree") {
      small_trees.push_back(object.placement);
      reach = std::max(
          reach, double(glm::length(glm::vec2(object.placement[3].x, object.placement[3].z))));
    }
  for (const Object& object : large.scene.objects)
    if (object.name == "tree") large_trees.push_back(object.placement);
  ASSERT_LT(small_trees.size(), large_trees.size());
  EXPECT_TRUE(std::equal(small_trees.begin(), small_trees.end(), large_trees.begin()));
  for (std::size_t i = small_trees.size(); i < large_trees.size(); ++i)
    EXPECT_GE(glm::length(glm::vec2(large_trees[i][3].x, large_trees[i][3].z)), reach);
  for (const PathKey& a : small.path.keys)
    EXPECT_EQ(a.eye, large.path.keys[std::size_t(&a - small.path.keys.data())].eye);
}

TEST(Forest, no_tree_comes_near_the_walk_and_the_eye_is_above_ground) {
  const BuiltinScene built = made("builtin:forest?triangles=1000000");
  for (int frame = 0; frame < frame_count(built.path); frame += 30) {
    const glm::vec3 eye(camera_at(built.path, frame_time(built.path, frame), 8, 8).position());
    for (const Object& object : built.scene.objects) {
      const Box box = transformed(object.placement, built.scene.models[object.model].bounds);
      const glm::vec3 nearest = glm::clamp(eye, box.min, box.max);
      if (object.name == "tree") {
        EXPECT_GT(glm::distance(nearest, eye), 8.0f);
      }
    }
  }
}

TEST(Forest, a_hundred_million_triangles_are_few_bytes) {
  const BuiltinScene built = made("builtin:forest?triangles=100000000");
  EXPECT_NEAR(double(count_triangles(built.scene)), 1e8, 1e4);
  std::uint64_t stored = 0;
  for (const Mesh& mesh : built.scene.meshes) stored += mesh.triangles();
  EXPECT_LT(stored, 500'000u);
}

TEST(Bridge, heavy_objects_are_of_a_size_that_pays_as_pictures) {
  const Scene scene = made("builtin:bridge").scene;
  std::uint64_t heavy = 0, moving = 0, all = count_triangles(scene);
  for (const Object& object : scene.objects) {
    const std::uint64_t triangles = scene.models[object.model].triangles;
    EXPECT_LE(triangles, 80'000u) << object.name;
    if (triangles >= 2000) heavy += triangles;
    moving += object.moving;
  }
  EXPECT_GT(heavy, all * 9 / 10);
  EXPECT_GE(moving, 8u);
  EXPECT_LE(moving, 12u);
}

TEST(Bridge, vehicles_touch_the_bounds_of_the_bridge_and_of_each_other) {
  const Scene scene = made("builtin:bridge?triangles=100000").scene;
  int with_bridge = 0, with_each_other = 0;
  std::vector<glm::mat4> world_from_model;
  for (double time = 0; time < scene.duration; time += 0.25) {
    pose(scene, time, world_from_model);
    const auto box = [&](std::size_t i) {
      return transformed(world_from_model[i], scene.models[scene.objects[i].model].bounds);
    };
    const auto touch = [](const Box& a, const Box& b) {
      return glm::all(glm::lessThanEqual(a.min, b.max)) &&
             glm::all(glm::lessThanEqual(b.min, a.max));
    };
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
      if (!scene.objects[i].moving) continue;
      for (std::size_t j = 0; j < scene.objects.size(); ++j) {
        if (i == j || !touch(box(i), box(j))) continue;
        with_bridge += scene.objects[j].name == "parapet" || scene.objects[j].name == "paving";
        with_each_other += scene.objects[j].moving;
      }
    }
  }
  EXPECT_GT(with_bridge, 100);
  EXPECT_GT(with_each_other, 5);
}

TEST(Bridge, vehicles_stay_on_the_road_and_drive_evenly) {
  const Scene scene = made("builtin:bridge?triangles=100000").scene;
  std::vector<glm::mat4> before, after;
  for (double time = 0; time < scene.duration; time += 0.1) {
    pose(scene, time, before);
    pose(scene, time + 1.0 / 60, after);
    for (std::size_t i = 0; i < scene.objects.size(); ++i) {
      if (!scene.objects[i].moving) continue;
      const glm::vec3 a(before[i][3]), b(after[i][3]);
      EXPECT_LT(std::abs(a.z), 3.2f);
      // 200 m in 20 s, but for the frame in which it starts anew.
      const float speed = glm::distance(a, b) * 60;
      if (speed > 100) continue;
      EXPECT_NEAR(speed, 10.0f, 0.3f);
      // It looks where it goes.
      EXPECT_GT(glm::dot(glm::vec3(before[i][0]), glm::normalize(b - a)), 0.99f);
    }
  }
}

TEST(Teapot, its_parts_look_outwards_and_it_has_its_published_size) {
  for (const int triangles : {5000, 30000, 100000}) {
    const Mesh mesh = make_teapot(triangles);
    EXPECT_NEAR(double(mesh.triangles()), triangles, 0.05 * triangles);
    Box box;
    for (const glm::vec3& p : mesh.positions) box.add(p);
    // The spout bulges beyond its end: 3.43; the handle's curve stays within its hull: -3.
    EXPECT_NEAR(box.max.y, 3.15f, 1e-5f);
    EXPECT_NEAR(box.min.y, 0.0f, 1e-5f);
    EXPECT_NEAR(box.min.x, -3.0f, 0.05f);
    EXPECT_NEAR(box.max.x, 3.43f, 0.05f);
    EXPECT_NEAR(box.max.z, 2.0f, 0.01f);
    EXPECT_NEAR(box.min.z, -2.0f, 0.01f);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
      const glm::vec3 &p = mesh.positions[i], &n = mesh.normals[i];
      // The body between rim and bottom, away from handle and spout.
      if (std::abs(p.x) < 1.3f && p.y > 0.4f && p.y < 2.3f) {
        EXPECT_GT(n.x * p.x + n.z * p.z, 0) << p.x << " " << p.y << " " << p.z;
      }
      if (p.x < -2.95f) {  // the handle's outer side
        EXPECT_LT(n.x, 0);
      }
      if (p.y < 0.01f) {  // the bottom
        EXPECT_LT(n.y, 0);
      }
    }
  }
}

TEST(Tree, every_kind_stands_on_the_ground_at_any_fineness) {
  for (int kind = 0; kind < kTreeKinds; ++kind)
    for (const int triangles : {1500, 4000, 40000}) {
      const Mesh mesh = make_tree(TreeKind(kind), 3, triangles);
      Faults faults;
      count_faults(mesh, faults);
      EXPECT_EQ(faults.empty, 0u) << mesh.name;
      // At the sharp wavy rim of a whorl a facet may turn against the mean of its corners, which
      // belong to both sides: measured 2.3 %. A tree turned inside out would have nearly 100 %.
      EXPECT_LE(faults.turned, faults.all / 25) << mesh.name << " " << triangles;
      EXPECT_NEAR(double(mesh.triangles()), triangles, 0.05 * triangles) << mesh.name;
      Box box;
      for (const glm::vec3& p : mesh.positions) box.add(p);
      EXPECT_LE(box.min.y, 0.0f);
      EXPECT_GT(box.min.y, -1.5f);
      EXPECT_GT(box.max.y, 2.0f);
      EXPECT_LT(box.max.y, 16.0f);
    }
}

}  // namespace
}  // namespace rilievo
