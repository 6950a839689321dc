#include <gtest/gtest.h>

#include <cstring>
#include <string>

#include "rilievo/scene/files/load_scene.h"
#include "rilievo/scene/files/save_glb.h"
#include "rilievo/scene/gltf/gltf_test_helpers.h"

namespace rilievo {
namespace {

Result<LoadedScene> load_text(const std::string& text, const std::string& name,
                              const PointSize& size = {}) {
  LoadOptions options;
  options.point_size = size;
  return load_scene(std::span(reinterpret_cast<const std::uint8_t*>(text.data()), text.size()),
                    name, options);
}

const char* const kFourVertices =
    "0 0 0 255 0 0\n1 0 0 0 255 0\n0 1 0 0 0 255\n1 1 0 255 255 255\n";

std::string ply(const std::string& elements, const std::string& values) {
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty "
         "float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n" +
         elements + "end_header\n" + kFourVertices + values;
}

TEST(PointsAndLines, a_ply_file_without_faces_shows_its_vertices_as_points) {
  const auto loaded = load_text(ply("", ""), "cloud.ply");
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  EXPECT_TRUE(loaded->warnings.empty());
  ASSERT_EQ(loaded->scene.meshes.size(), 1u);
  const Mesh& mesh = loaded->scene.meshes[0];
  EXPECT_EQ(mesh.primitive, Primitive::points);
  EXPECT_EQ(mesh.primitives(), 4u);
  EXPECT_EQ(mesh.triangles(), 0u);
  EXPECT_TRUE(mesh.normals.empty());
  ASSERT_EQ(mesh.colors.size(), 4u);
  for (std::size_t i = 0; i < 4; ++i)
    if (mesh.positions[i] == glm::vec3(1, 0, 0)) {
      EXPECT_EQ(mesh.colors[i], glm::vec4(0, 1, 0, 1));
    }
  EXPECT_EQ(count_triangles(loaded->scene), 4u);
}

TEST(PointsAndLines, what_a_scanner_did_not_measure_is_no_point) {
  std::string text = ply("", "");
  text.replace(text.find("1 1 0 255"), 9, "nan nan 0 255");
  const auto loaded = load_text(text, "cloud.ply");
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  EXPECT_EQ(loaded->scene.meshes[0].primitives(), 3u);
}

TEST(PointsAndLines, edges_of_a_ply_file_are_lines_and_its_vertices_are_then_no_points) {
  const auto loaded = load_text(
      ply("element edge 2\nproperty int vertex1\nproperty int vertex2\n", "0 3\n1 2\n"), "a.ply");
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  ASSERT_EQ(loaded->scene.meshes.size(), 1u);
  const Mesh& mesh = loaded->scene.meshes[0];
  EXPECT_EQ(mesh.primitive, Primitive::lines);
  ASSERT_EQ(mesh.primitives(), 2u);
  EXPECT_EQ(mesh.positions[mesh.indices[1]], glm::vec3(1, 1, 0));
  EXPECT_EQ(mesh.colors[mesh.indices[0]], glm::vec4(1, 0, 0, 1));
  EXPECT_EQ(mesh.width, 0);
  EXPECT_EQ(mesh.width_px, 1);
  const auto bad = load_text(
      ply("element edge 1\nproperty int vertex1\nproperty int vertex2\n", "0 4\n"), "a.ply");
  ASSERT_FALSE(bad.ok());
  EXPECT_EQ(bad.error().reason, "has an edge that refers to a vertex that does not exist");
}

TEST(PointsAndLines, an_obj_file_mixes_triangles_lines_and_points) {
  const auto loaded = load_text(
      "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\no all\nf 1 2 3\nl 1 2 4\nl 2/1 3/1\np 1 -1\nvt 0 0\n"
      "o other\np 2\n",
      "a.obj");
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  const Scene& scene = loaded->scene;
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_EQ(scene.models[0].parts.size(), 3u);
  EXPECT_EQ(scene.models[1].parts.size(), 1u);
  std::uint64_t count[3] = {0, 0, 0};
  for (const Mesh& mesh : scene.meshes) count[int(mesh.primitive)] += mesh.primitives();
  EXPECT_EQ(count[0], 1u);
  EXPECT_EQ(count[1], 3u);
  EXPECT_EQ(count[2], 3u);
  const auto bad = load_text("v 0 0 0\nv 1 0 0\np 1\nl 1 3\n", "a.obj");
  ASSERT_FALSE(bad.ok());
  EXPECT_EQ(bad.error().reason, "line 4 refers to vertex 3, but there are only 2");
}

TEST(PointsAndLines, an_obj_file_of_vertices_alone_is_a_cloud) {
  const auto loaded = load_text("v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\n", "a.obj");
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  EXPECT_EQ(loaded->scene.meshes.at(0).primitive, Primitive::points);
  EXPECT_EQ(loaded->scene.meshes.at(0).colors.size(), 3u);
}

// Four vertices, drawn in a mode by indices or without.
Result<LoadedScene> load_mode(int mode, bool indexed, const PointSize& size = {}) {
  using nlohmann::json;
  const float positions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const std::uint8_t order[] = {3, 2, 1, 0};
  std::string bytes(sizeof positions + sizeof order, '\0');
  std::memcpy(bytes.data(), positions, sizeof positions);
  std::memcpy(bytes.data() + sizeof positions, order, sizeof order);
  json primitive = {{"attributes", {{"POSITION", 0}}}, {"mode", mode}, {"material", 0}};
  if (indexed) primitive["indices"] = 1;
  json uri = "data:application/octet-stream;base64,";
  static const char* const k64 = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t v = 0;
    for (std::size_t k = 0; k < 3; ++k)
      v = v << 8 | (i + k < bytes.size() ? std::uint8_t(bytes[i + k]) : 0u);
    for (int k = 3; k >= 0; --k) text += k64[v >> (6 * k) & 63];
  }
  for (std::size_t i = 0; i < (3 - bytes.size() % 3) % 3; ++i) text[text.size() - 1 - i] = '=';
  const json document = {
      {"asset", {{"version", "2.0"}}},
      {"buffers", {{{"byteLength", bytes.size()}, {"uri", uri.get<std::string>() + text}}}},
      {"bufferViews",
       {{{"buffer", 0}, {"byteLength", sizeof positions}},
        {{"buffer", 0}, {"byteOffset", sizeof positions}, {"byteLength", sizeof order}}}},
      {"accessors",
       {{{"bufferView", 0}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}},
        {{"bufferView", 1}, {"componentType", 5121}, {"count", 4}, {"type", "SCALAR"}}}},
      {"materials", {{{"alphaMode", "BLEND"}}}},
      {"meshes", {{{"primitives", {primitive}}}}},
      {"nodes", {{{"mesh", 0}, {"scale", {2, 2, 2}}}}}};
  return load_text(document.dump(), "a.gltf", size);
}

TEST(PointsAndLines, modes_of_gltf_become_points_and_pairs) {
  // Of each mode: the number of primitives, and the positions of the first and the last corner.
  struct Expected {
    int mode;
    Primitive primitive;
    std::uint64_t count;
    glm::vec3 last;  // without indices
  };
  for (const Expected& e :
       {Expected{1, Primitive::lines, 2, {0, 1, 0}}, Expected{2, Primitive::lines, 4, {0, 0, 0}},
        Expected{3, Primitive::lines, 3, {0, 1, 0}}, Expected{0, Primitive::points, 4, {0, 0, 0}}})
    for (const bool indexed : {false, true}) {
      const auto loaded = load_mode(e.mode, indexed);
      ASSERT_TRUE(loaded.ok()) << loaded.error().message();
      const Mesh& mesh = loaded->scene.meshes.at(0);
      EXPECT_EQ(mesh.primitive, e.primitive);
      EXPECT_EQ(mesh.primitives(), e.count) << e.mode;
      EXPECT_TRUE(mesh.normals.empty());
      if (!indexed && e.primitive == Primitive::lines) {
        EXPECT_EQ(mesh.positions[mesh.indices.back()], e.last) << e.mode;
      }
      // They are opaque, whatever the material says.
      EXPECT_EQ(loaded->scene.materials[std::size_t(mesh.material)].alpha_mode, AlphaMode::opaque);
    }
}

TEST(PointsAndLines, a_point_size_is_one_of_the_world_whatever_placements_do) {
  const auto loaded = load_mode(0, false, {0.5f, 0});
  ASSERT_TRUE(loaded.ok());
  EXPECT_FLOAT_EQ(loaded->scene.meshes[0].width, 0.25f);  // the node doubles it
  const Box bounds = world_bounds(loaded->scene);
  EXPECT_FLOAT_EQ(bounds.min.x, -0.25f);
  EXPECT_FLOAT_EQ(bounds.max.y, 2.25f);
  EXPECT_FLOAT_EQ(bounds.max.z, 0.25f);
  const auto pixels = load_mode(0, false, {0, 3});
  ASSERT_TRUE(pixels.ok());
  EXPECT_EQ(pixels->scene.meshes[0].width, 0);
  EXPECT_EQ(pixels->scene.meshes[0].width_px, 3);
}

TEST(PointsAndLines, are_saved_as_glb_and_read_again) {
  for (const int mode : {0, 1}) {
    const auto loaded = load_mode(mode, false);
    ASSERT_TRUE(loaded.ok());
    const std::string path = ::testing::TempDir() + "strokes" + std::to_string(mode) + ".glb";
    ASSERT_TRUE(save_glb(loaded->scene, path).ok());
    const auto again = load_scene(path);
    ASSERT_TRUE(again.ok()) << again.error().message();
    EXPECT_EQ(again->scene.meshes[0].primitive, loaded->scene.meshes[0].primitive);
    EXPECT_EQ(again->scene.meshes[0].positions, loaded->scene.meshes[0].positions);
  }
}

}  // namespace
}  // namespace rilievo
