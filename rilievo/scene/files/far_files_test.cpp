// Files whose coordinates lie far from 0 load as those near it do, with an origin.
#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "rilievo/core/file_test_helpers.h"
#include "rilievo/scene/files/load_scene.h"
#include "rilievo/scene/files/save_glb.h"
#include "rilievo/scene/gltf/gltf_test_helpers.h"

namespace rilievo {
namespace {

const glm::dvec3 kFar(4.7e5, 412, -5.4e6);

// A staircase of triangles within 5 m, with steps of 7 mm.
std::vector<glm::dvec3> steps() {
  std::vector<glm::dvec3> corners;
  for (int i = 0; i < 60; ++i)
    for (const glm::dvec2& at : {glm::dvec2(0, 0), glm::dvec2(1, 0), glm::dvec2(0, 1)})
      corners.emplace_back(at.x * 5, 0.007 * i, 0.08 * i + at.y * 0.08);
  return corners;
}

// All corners of triangles, in world space.
std::vector<glm::dvec3> world_corners(const Scene& scene, double time = 0) {
  std::vector<glm::mat4> poses;
  pose(scene, time, poses);
  std::vector<glm::dvec3> corners;
  for (std::size_t i = 0; i < scene.objects.size(); ++i)
    for (const Part& part : scene.models[std::size_t(scene.objects[i].model)].parts) {
      const Mesh& mesh = scene.meshes[std::size_t(part.mesh)];
      for (const std::uint32_t at : mesh.indices)
        corners.push_back(scene.world.origin + glm::dvec3(poses[i] * part.model_from_mesh *
                                                          glm::vec4(mesh.positions[at], 1)));
    }
  return corners;
}

// Within 2e-6 of 5 m: roundings of floats.
void expect_steps(const Result<LoadedScene>& loaded, const glm::dvec3& at, const char* what) {
  ASSERT_TRUE(loaded.ok()) << what << ": " << loaded.error().message();
  const std::vector<glm::dvec3> corners = world_corners(loaded->scene), expected = steps();
  ASSERT_EQ(corners.size(), expected.size()) << what;
  for (std::size_t i = 0; i < corners.size(); ++i)
    ASSERT_LT(glm::distance(corners[i], expected[i] + at), 1e-5) << what << " " << i;
  EXPECT_LT(glm::distance(loaded->scene.world.origin, at), at == glm::dvec3(0) ? 1e-9 : 8) << what;
}

Result<LoadedScene> load_text(const std::string& text, const char* name) {
  return load_scene({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}, name);
}

TEST(FarFiles, texts_and_doubles_keep_every_digit) {
  for (const glm::dvec3& at : {glm::dvec3(0), kFar, -10.0 * kFar}) {
    const std::vector<glm::dvec3> corners = steps();
    std::string obj = "o steps\n", stl = "solid steps\n";
    std::string ply = "ply\nformat ascii 1.0\nelement vertex " + std::to_string(corners.size()) +
                      "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
                      std::to_string(corners.size() / 3) +
                      "\nproperty list uchar int vertex_indices\nend_header\n";
    std::string binary = ply;
    binary.replace(binary.find("ascii"), 5, "binary_little_endian");
    std::string faces, packed, vertices;
    for (std::size_t i = 0; i < corners.size(); ++i) {
      const glm::dvec3 p = corners[i] + at;
      char text[128];
      std::snprintf(text, sizeof text, "%.4f %.4f %.4f\n", p.x, p.y, p.z);
      obj += "v " + std::string(text);
      vertices += text;
      stl += (i % 3 == 0 ? "facet normal 0 0 0\nouter loop\nvertex " : "vertex ") +
             std::string(text) + (i % 3 == 2 ? "endloop\nendfacet\n" : "");
      packed.append(reinterpret_cast<const char*>(&p), sizeof p);
      if (i % 3 != 2) continue;
      faces += "3 " + std::to_string(i - 2) + " " + std::to_string(i - 1) + " " +
               std::to_string(i) + "\n";
      obj += "f " + std::to_string(i - 1) + " " + std::to_string(i) + " " + std::to_string(i + 1) +
             "\n";
    }
    for (std::int32_t i = 0; i < std::int32_t(corners.size()); i += 3) {
      packed += char(3);
      for (std::int32_t k = i; k < i + 3; ++k)
        packed.append(reinterpret_cast<const char*>(&k), sizeof k);
    }
    expect_steps(load_text(obj, "far.obj"), at, "OBJ");
    expect_steps(load_text(stl + "endsolid\n", "far.stl"), at, "STL");
    expect_steps(load_text(ply + vertices + faces, "far.ply"), at, "PLY");
    expect_steps(load_text(binary + packed, "far.ply"), at, "binary PLY");
  }
}

using test::GltfBuilder;

// The steps as a mesh whose numbers count from `from`, a place that floats hold.
int mesh_of_steps(GltfBuilder& b, const glm::dvec3& from = glm::dvec3(0)) {
  std::vector<float> p;
  std::vector<std::uint16_t> indices;
  for (const glm::dvec3& corner : steps())
    for (int c = 0; c < 3; ++c) p.push_back(float(corner[c] + from[c]));
  return b.mesh({{"attributes", {{"POSITION", b.floats(p, "VEC3")}}}});
}

Result<LoadedScene> load_glb_of(const GltfBuilder& b) { return load_text(b.glb(), "far.glb"); }

nlohmann::json list(const glm::dvec3& v) { return {v.x, v.y, v.z}; }

TEST(FarFiles, nodes_add_up_in_doubles) {
  // A root far away, above what is near it; and the other way round; and both cancelling.
  for (const auto& [root, child, at] :
       {std::tuple(kFar, glm::dvec3(0), kFar), std::tuple(glm::dvec3(0), kFar, kFar),
        std::tuple(kFar, -kFar, glm::dvec3(0)), std::tuple(1e3 * kFar, kFar - 1e3 * kFar, kFar)}) {
    GltfBuilder b;
    const int mesh = mesh_of_steps(b);
    b.node({{"translation", list(root)}, {"children", {1}}});
    b.node({{"translation", list(child)}, {"mesh", mesh}});
    const Result<LoadedScene> loaded = load_glb_of(b);
    ASSERT_TRUE(loaded.ok()) << loaded.error().message();
    expect_steps(loaded, at, "nodes");
  }
}

TEST(FarFiles, a_turned_root_above_many_parts) {
  GltfBuilder b;
  const int mesh = mesh_of_steps(b);
  const glm::dquat turn = glm::normalize(glm::dquat(1, 0.2, -0.7, 0.4));
  nlohmann::json children;
  for (int i = 1; i <= 48; ++i) children.push_back(i);
  b.node({{"translation", list(kFar)},
          {"rotation", {turn.x, turn.y, turn.z, turn.w}},
          {"children", children}});
  for (int i = 0; i < 48; ++i)
    b.node({{"translation", {0.25 * i, 0, 0}}, {"mesh", mesh}, {"name", std::to_string(i)}});
  const Result<LoadedScene> loaded = load_glb_of(b);
  ASSERT_TRUE(loaded.ok());
  const std::vector<glm::dvec3> corners = world_corners(loaded->scene), expected = steps();
  ASSERT_EQ(corners.size(), 48 * expected.size());
  for (std::size_t k = 0; k < corners.size(); ++k) {
    const glm::dvec3 moved(0.25 * double(k / expected.size()), 0, 0);
    EXPECT_LT(glm::distance(corners[k], kFar + turn * (expected[k % expected.size()] + moved)),
              1e-5);
  }
}

// Numbers that floats hold, taken back by a node: nothing is left of their distance.
// So that a scene that was moved as a whole draws the same frames to the last bit.
TEST(FarFiles, the_place_of_a_root_becomes_the_origin) {
  GltfBuilder b;
  const int mesh = mesh_of_steps(b);
  b.node({{"translation", list(kFar)}, {"children", {1}}});
  b.node({{"translation", {1.5, -2.25, 3}}, {"mesh", mesh}});
  const Result<LoadedScene> loaded = load_glb_of(b);
  ASSERT_TRUE(loaded.ok());
  EXPECT_EQ(loaded->scene.world.origin, kFar);
  EXPECT_EQ(loaded->scene.objects[0].placement[3], glm::vec4(1.5f, -2.25f, 3, 1));
}

TEST(FarFiles, meshes_far_from_0_are_placed_in_doubles) {
  const glm::dvec3 from(1 << 19, 0, -(1 << 19));
  GltfBuilder b, near;
  const int mesh = mesh_of_steps(b, from);
  b.node({{"translation", list(-from + glm::dvec3(1, 2, 3))}, {"mesh", mesh}});
  const Result<LoadedScene> loaded = load_glb_of(b);
  ASSERT_TRUE(loaded.ok());
  const std::vector<glm::dvec3> corners = world_corners(loaded->scene), expected = steps();
  ASSERT_EQ(corners.size(), expected.size());
  // The file's own floats have steps of 6 cm there.
  for (std::size_t i = 0; i < corners.size(); ++i) {
    glm::dvec3 rounded;
    for (int c = 0; c < 3; ++c) rounded[c] = double(float(expected[i][c] + from[c])) - from[c];
    EXPECT_LT(glm::distance(corners[i], rounded + glm::dvec3(1, 2, 3)), 1e-5);
  }
}

TEST(FarFiles, what_moves_is_far_too) {
  GltfBuilder b;
  const int mesh = mesh_of_steps(b);
  // Floats in the file: places that they hold. The child moves a metre in two seconds.
  const glm::dvec3 at(1 << 22, 512, -(1 << 23));
  b.node({{"translation", list(at)}, {"children", {1}}});
  b.node({{"translation", {0, 0, 0}}, {"mesh", mesh}});
  b.json["animations"] = {
      {{"samplers",
        {{{"input", b.floats({0, 2}, "SCALAR")},
          {"output", b.floats({0, 0, 0, 1, 0, 0}, "VEC3")}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 1}, {"path", "translation"}}}}}}}};
  const Result<LoadedScene> loaded = load_glb_of(b);
  ASSERT_TRUE(loaded.ok());
  const std::vector<glm::dvec3> expected = steps();
  for (const double time : {0.0, 0.3, 1.7}) {
    const std::vector<glm::dvec3> corners = world_corners(loaded->scene, time);
    for (std::size_t i = 0; i < corners.size(); ++i)
      EXPECT_LT(glm::distance(corners[i], expected[i] + at + glm::dvec3(0.5 * time, 0, 0)), 1e-5);
  }
}

TEST(FarFiles, cesium_s_centre_is_part_of_the_origin) {
  GltfBuilder b;
  b.node({{"mesh", mesh_of_steps(b)}});
  b.json["extensionsRequired"] = {"CESIUM_RTC"};
  b.json["extensions"] = {{"CESIUM_RTC", {{"center", list(kFar)}}}};
  expect_steps(load_glb_of(b), kFar, "CESIUM_RTC");
}

TEST(FarFiles, what_is_saved_lies_where_it_was) {
  GltfBuilder b;
  b.node({{"mesh", mesh_of_steps(b)}, {"translation", list(kFar)}});
  Result<LoadedScene> loaded = load_glb_of(b);
  ASSERT_TRUE(loaded.ok());
  loaded->scene.cameras.push_back({});
  const TemporaryFolder folder;
  const std::filesystem::path file = folder.path() / "far.glb";
  ASSERT_TRUE(save_glb(loaded->scene, file).ok());
  const Result<LoadedScene> again = load_scene(file);
  expect_steps(again, kFar, "saved");
  ASSERT_EQ(again->scene.cameras.size(), 1u);
  EXPECT_LT(glm::distance(again->scene.world.origin + again->scene.cameras[0].position(),
                          loaded->scene.world.origin),
            1e-6);
}

}  // namespace
}  // namespace rilievo
