#include "rilievo/scene/polygons/polygon_read.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstring>
#include <random>

#include "rilievo/core/color.h"
#include "rilievo/core/file.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/scene/files/load_scene.h"

namespace rilievo {
namespace {

Result<LoadedScene> load_polygons(const std::string& bytes, const std::string& name) {
  return load_scene(bytes_of(bytes), name);
}

std::string reason_of_polygons(const std::string& bytes, const std::string& name) {
  const Result<LoadedScene> loaded = load_polygons(bytes, name);
  return loaded.ok() ? "ok" : loaded.error().reason;
}

const Material& material_of(const Scene& scene, std::size_t mesh) {
  return scene.materials[scene.meshes[mesh].material];
}

using Triangle = std::array<glm::vec3, 3>;

std::vector<Triangle> triangles_of(const Scene& scene) {
  std::vector<Triangle> out;
  for (const Mesh& mesh : scene.meshes)
    for (std::size_t i = 0; i < mesh.indices.size(); i += 3)
      out.push_back({mesh.positions[mesh.indices[i]], mesh.positions[mesh.indices[i + 1]],
                     mesh.positions[mesh.indices[i + 2]]});
  return out;
}

template <class T>
void append(std::string& to, T value, bool big = false) {
  char bytes[sizeof(T)];
  std::memcpy(bytes, &value, sizeof value);
  if (big) std::reverse(bytes, bytes + sizeof value);
  to.append(bytes, sizeof value);
}

// One random mesh written in every format must come out the same.
TEST(PolygonFiles, the_same_mesh_in_every_format_is_the_same) {
  std::mt19937 rng(81);
  std::uniform_real_distribution<float> u(-1, 1);
  for (int round = 0; round < 50; ++round) {
    std::vector<glm::vec3> p(3 + rng() % 20);
    for (glm::vec3& v : p) v = {u(rng), u(rng), u(rng)};
    std::vector<std::array<std::uint32_t, 3>> faces(1 + rng() % 30);
    for (auto& f : faces) {
      f[0] = std::uint32_t(rng() % p.size());
      f[1] = std::uint32_t((f[0] + 1) % p.size());
      f[2] = std::uint32_t((f[0] + 2) % p.size());
    }
    std::vector<Triangle> expected;
    for (const auto& f : faces) expected.push_back({p[f[0]], p[f[1]], p[f[2]]});

    const auto number = [](float v) {
      char text[32];
      std::snprintf(text, sizeof text, "%.9g", double(v));  // nine digits hold a float exactly
      return std::string(text);
    };
    const auto point = [&](const glm::vec3& v) {
      return number(v.x) + " " + number(v.y) + " " + number(v.z);
    };
    std::string obj = "# mesh\r\n", relative, stl = "solid some name\n", binary_stl(80, ' ');
    for (const glm::vec3& v : p) obj += "v " + point(v) + "\r\n";
    relative = obj;
    for (const auto& f : faces) {
      obj += "f";
      relative += "f";
      for (std::uint32_t i : f) {
        obj += " " + std::to_string(i + 1);
        relative += " \\\r\n " + std::to_string(std::int64_t(i) - std::int64_t(p.size()));
      }
      obj += "\r\n";
      relative += "\r\n";
    }
    append(binary_stl, std::uint32_t(faces.size()));
    for (const Triangle& t : expected) {
      stl += "facet normal 0 0 0\n outer loop\n";
      for (const glm::vec3& v : t) stl += "  vertex " + point(v) + "\n";
      stl += " endloop\nendfacet\n";
      binary_stl.append(12, '\0');
      for (const glm::vec3& v : t)
        for (int c = 0; c < 3; ++c) append(binary_stl, v[c]);
      binary_stl.append(2, '\0');
    }
    EXPECT_EQ(triangles_of(load_polygons(obj, "a.obj")->scene), expected);
    EXPECT_EQ(triangles_of(load_polygons(relative, "a.obj")->scene), expected);
    EXPECT_EQ(triangles_of(load_polygons(stl + "endsolid\n", "a.stl")->scene), expected);
    EXPECT_EQ(triangles_of(load_polygons(stl, "no extension")->scene), expected);
    EXPECT_EQ(triangles_of(load_polygons(std::string(300, '\n') + "solid_" + stl, "a.stl")->scene),
              expected);
    std::string capitals = stl;
    for (char& c : capitals) c = char(std::toupper(c));
    EXPECT_EQ(triangles_of(load_polygons("\n" + capitals, "a.stl")->scene), expected);
    EXPECT_EQ(triangles_of(load_polygons(capitals, "no extension")->scene), expected);
    EXPECT_EQ(triangles_of(load_polygons(binary_stl, "a.stl")->scene), expected);

    for (const char* format : {"ascii", "binary_little_endian", "binary_big_endian"}) {
      // An element and a property that nobody knows lie in between.
      std::string ply = std::string("ply\nformat ") + format + " 1.0\ncomment c\nelement odd 1\n" +
                        "property list uchar short a\nelement vertex " + std::to_string(p.size()) +
                        "\nproperty float x\nproperty double y\nproperty uchar flags\n" +
                        "property float z\nelement face " + std::to_string(faces.size()) +
                        "\nproperty list uchar int vertex_indices\nend_header\n";
      if (format[0] == 'a') {
        ply += "2 7 8\n";
        for (const glm::vec3& v : p)
          ply += number(v.x) + " " + number(v.y) + " 3 " + number(v.z) + "\n";
        for (const auto& f : faces)
          ply += "3 " + std::to_string(f[0]) + " " + std::to_string(f[1]) + " " +
                 std::to_string(f[2]) + "\n";
      } else {
        const bool big = format[7] == 'b';
        append(ply, std::uint8_t(2)), append(ply, std::int16_t(7), big);
        append(ply, std::int16_t(8), big);
        for (const glm::vec3& v : p) {
          append(ply, v.x, big), append(ply, double(v.y), big);
          append(ply, std::uint8_t(3)), append(ply, v.z, big);
        }
        for (const auto& f : faces) {
          append(ply, std::uint8_t(3));
          for (std::uint32_t i : f) append(ply, std::int32_t(i), big);
        }
      }
      const Result<LoadedScene> loaded = load_polygons(ply, "a.ply");
      ASSERT_TRUE(loaded.ok()) << loaded.error().message();
      EXPECT_EQ(triangles_of(loaded->scene), expected) << format;
    }
  }
}

TEST(Obj, groups_are_objects_and_materials_parts) {
  const TemporaryFolder folder;
  (void)write_file(folder / "m.mtl",
                   "newmtl red paint\nKd 1 0 0\nNs 198\nnewmtl glass\nKd 1 1 1\nd 0.25\n"
                   "newmtl odd\nTr 1\nKe 2 1 0\n");
  (void)write_file(
      folder / "a.obj",
      "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\no one\nusemtl red paint\nf 1 2 3\n"
      "usemtl glass\nf 2 4 3\no two\nf 1 2 4\no one\nusemtl red paint\nf 1 2 4\n"
      "usemtl odd\nf 1 4 3\nusemtl none such\nf 1 2 3\n");
  const Result<LoadedScene> loaded = load_scene(folder / "a.obj");
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  const Scene& scene = loaded->scene;
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_EQ(scene.objects[0].name, "one");
  EXPECT_EQ(scene.models[0].parts.size(), 4u);
  EXPECT_EQ(scene.models[0].triangles, 5u);
  EXPECT_EQ(scene.models[1].triangles, 1u);
  EXPECT_EQ(material_of(scene, 0).base_color, glm::vec4(1, 0, 0, 1));
  EXPECT_NEAR(material_of(scene, 0).roughness, std::pow(0.01, 0.25), 1e-6);  // 2 / (198 + 2)
  EXPECT_TRUE(material_of(scene, 0).double_sided);
  EXPECT_EQ(material_of(scene, 1).alpha_mode, AlphaMode::blend);
  EXPECT_EQ(material_of(scene, 1).base_color.a, 0.25f);
  EXPECT_EQ(material_of(scene, 3).emissive, glm::vec3(2, 1, 0));
  EXPECT_EQ(material_of(scene, 3).base_color.a, 1.0f);
  EXPECT_EQ(material_of(scene, 4).name, "plain");
  const std::vector<std::string> expected = {
      "the material 'odd' is fully transparent; it is drawn opaque",
      "the material 'none such' is not defined"};
  EXPECT_EQ(loaded->warnings, expected);
}

TEST(Obj, attributes_are_kept_and_v_is_turned_round) {
  const Result<LoadedScene> loaded = load_polygons(
      "v 0 0 0 1 0.5 0\nv 1 0 0 1 1 1\nv 0 1 0\nvt 0.25 0.25\nvn 0 0 -2\nf 1/1/1 2/1/1 3/1/1\n",
      "a.obj");
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  const Mesh& mesh = loaded->scene.meshes[0];
  EXPECT_EQ(mesh.uv[0][0], glm::vec2(0.25f, 0.75f));
  EXPECT_EQ(mesh.normals[0], glm::vec3(0, 0, -1));
  EXPECT_EQ(mesh.colors[0], glm::vec4(1, linear_from_srgb(0.5f), 0, 1));
  EXPECT_EQ(mesh.colors[2], glm::vec4(1));
}

TEST(Obj, colours_may_be_bytes) {
  const Result<LoadedScene> loaded =
      load_polygons("v 0 0 0 255 51 0\nv 1 0 0 1 1 1 128\nv 0 1 0\nf 1 2 3\n", "a.obj");
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  const std::vector<glm::vec4>& colors = loaded->scene.meshes[0].colors;
  EXPECT_EQ(colors[0], glm::vec4(1, linear_from_srgb(0.2f), 0, 1));
  const float dark = linear_from_srgb(1 / 255.0f);
  EXPECT_EQ(colors[1], glm::vec4(dark, dark, dark, 128 / 255.0f));
  EXPECT_EQ(colors[2], glm::vec4(1));
}

// Sweet Home 3D's models have such faces; what they refer to is there once the file has been read.
TEST(Obj, a_face_may_refer_to_what_follows_it) {
  const Result<LoadedScene> loaded = load_polygons(
      "v 0 0 0\nv 1 0 0\nvt 0 0\nusemtl a\nf 1/2 2/1/1 3/2\nusemtl b\nf -2 -1 3\nv 0 1 0\n"
      "vt 0.5 0.25\nvn 0 0 1\n",
      "a.obj");
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  const Triangle expected = {glm::vec3(0, 0, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1, 0)};
  EXPECT_EQ(triangles_of(loaded->scene), (std::vector<Triangle>{expected, expected}));
  EXPECT_EQ(loaded->scene.meshes[0].uv[0][0], glm::vec2(0.5f, 0.75f));
  EXPECT_EQ(loaded->scene.meshes[0].uv[0][1], glm::vec2(0, 1));
}

TEST(Obj, a_missing_library_is_a_warning_only) {
  const TemporaryFolder folder;
  (void)write_file(folder / "a.obj",
                   "mtllib gone.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl x\nf 1 2 3\n");
  const Result<LoadedScene> loaded = load_scene(folder / "a.obj");
  ASSERT_TRUE(loaded.ok());
  ASSERT_EQ(loaded->warnings.size(), 1u);
  EXPECT_EQ(loaded->warnings[0],
            "the material library is left out: 'gone.mtl': No such file or directory");
}

TEST(Obj, utf_16_is_read) {
  const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\no \xC3\xA9\xF0\x9F\x98\x80\nf 1 2 3\n";
  const std::u16string wide = u"v 0 0 0\nv 1 0 0\nv 0 1 0\no \u00E9\U0001F600\nf 1 2 3\n";
  for (bool big : {false, true}) {
    std::string bytes;
    append(bytes, std::uint16_t(0xFEFF), big);
    for (char16_t c : wide) append(bytes, std::uint16_t(c), big);
    const Result<LoadedScene> loaded = load_polygons(bytes, "a.obj");
    ASSERT_TRUE(loaded.ok()) << loaded.error().message();
    EXPECT_EQ(loaded->scene.objects[0].name, load_polygons(text, "a.obj")->scene.objects[0].name);
    EXPECT_EQ(loaded->scene.objects[0].name, "\xC3\xA9\xF0\x9F\x98\x80");
  }
}

TEST(PolygonFiles, faults_are_named) {
  EXPECT_EQ(reason_of_polygons("v 0 0 0\nf 1 2 3\n", "a.obj"),
            "line 2 refers to vertex 2, but there is only one");
  EXPECT_EQ(reason_of_polygons("v 0 0 0\nf 1 1 0\n", "a.obj"),
            "line 2 refers to vertex 0, but there is only one");
  EXPECT_EQ(reason_of_polygons("v 0 0 0\nf 1 1 -2\n", "a.obj"),
            "line 2 refers to vertex -2, but there is only one");
  EXPECT_EQ(reason_of_polygons("v 0 0 0\nf 1 1 4294967296\n", "a.obj"),
            "line 2 refers to vertex 4294967296, but there is only one");
  EXPECT_EQ(reason_of_polygons("v 0 0 0\nf 1/2 1 1\nvt 0 0\nv 1 0 0\n", "a.obj"),
            "line 2 refers to texture coordinate 2, but there is only one");
  EXPECT_EQ(reason_of_polygons("v 0 0 0\nf 1//3 1 1\nvn 0 0 1\nvn 0 1 0\nv 1 0 0\n", "a.obj"),
            "line 2 refers to normal 3, but there are only 2");
  EXPECT_EQ(reason_of_polygons("v 0 0\n", "a.obj"),
            "line 1 has a vertex with fewer than three numbers");
  EXPECT_EQ(reason_of_polygons("v 0 0 0\nv 0 0 nan\nf 1 1 2\n", "a.obj"),
            "line 3 has a face with vertex 2, whose position is not finite");
  EXPECT_EQ(reason_of_polygons("v 0 0 1e39\nf 1 1 1\n", "a.obj"),
            "line 2 has a face with vertex 1, whose position is not finite");
  EXPECT_EQ(reason_of_polygons("v 0 x 0\n", "a.obj"), "line 1 has 'x' where a number belongs");
  EXPECT_EQ(reason_of_polygons("ply\nformat ascii 1.0\nelement vertex 99999\n", "a.ply"),
            "is a PLY file that announces more elements than it can hold");
  EXPECT_EQ(
      reason_of_polygons("ply\nformat ascii 1.0\nelement vertex 1\nproperty real x\n", "a.ply"),
      "is a PLY file with a property of the unknown type 'real'");
  EXPECT_EQ(reason_of_polygons("ply\nformat ascii 1.0\n", "a.ply"),
            "is a PLY file whose header has no end");
  EXPECT_EQ(reason_of_polygons("solid a\nvertex 0 0 x\n", "a.stl"),
            "line 2 has 'x' where a number belongs");
  EXPECT_EQ(reason_of_polygons("solid a\n", "a.stl"), "is an STL file without facets");
  EXPECT_EQ(reason_of_polygons("what\n", "a.stl"),
            "is not an STL file: it neither begins with 'solid' nor has the length it announces");
}

TEST(PolygonFiles, decimal_commas_are_read_and_other_words_name_their_line) {
  const Triangle expected = {glm::vec3(0.5f, 0, 0), glm::vec3(1, -0.25f, 0), glm::vec3(0, 1, 2)};
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  const Result<LoadedScene> loaded[] = {
      load_polygons("v 0,5 0 0\nv 1 -0,25 0\nv 0 1 2\nvt 0,5 0,5\nf 1 2 3\n", "a.obj"),
      load_polygons(ply + "0,5 0 0\n1 -0,25 0\n0 1 2\n3 0 1 2\n", "a.ply"),
      load_polygons("solid a\nvertex 0,5 0 0\nvertex 1 -0,25 0\nvertex 0 1 2\nendloop\n", "a.stl")};
  for (const Result<LoadedScene>& scene : loaded) {
    ASSERT_TRUE(scene) << scene.error().message();
    EXPECT_EQ(triangles_of(scene->scene), std::vector<Triangle>{expected});
  }
  const std::pair<std::string, std::string> obj[] = {
      {"v 0.5x 0 0\n", "line 1 has '0.5x' where a number belongs"},
      {"v 0 0 0\r\nv 1,2,3\n", "line 2 has '1,2,3' where a number belongs"},
      {"v 1, 2, 3\n", "line 1 has '1,' where a number belongs"},
      {"v 1,5 2\n", "line 1 has a vertex with fewer than three numbers"},
      {"vn 0 0 1.0f\n", "line 1 has '1.0f' where a number belongs"},
      {"vt 0,5\n", "line 1 has '0,5', one number or two"},
      {"v 0 0 0 0.5 0.5 0.5;\n", "line 1 has '0.5;' where a number belongs"},
      {"v 0 0 0\nf 1 1 1x\n", "line 2 has '1x' where a number belongs"}};
  for (const auto& [text, reason] : obj) EXPECT_EQ(reason_of_polygons(text, "a.obj"), reason);
  EXPECT_EQ(reason_of_polygons(ply + "0 0 0\n1 0 0\n0 1.5.5 0\n3 0 1 2\n", "a.ply"),
            "line 12 has '1.5.5' where a number belongs");
  EXPECT_EQ(reason_of_polygons("solid a\nfacet\nvertex 0 0 1,2.5\n", "a.stl"),
            "line 3 has '1,2.5' where a number belongs");
}

TEST(Obj, numbers_of_materials_may_have_commas_and_are_refused_by_line) {
  const TemporaryFolder folder;
  const std::string obj =
      "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nf 1/1 2/1 3/1\n";
  (void)write_file(folder / "a.obj", obj);
  (void)write_file(folder / "m.mtl", "newmtl m\nKd 0,8 0,25 0,125 # red\nd 0,5\n");
  const Result<LoadedScene> loaded = load_scene(folder / "a.obj");
  ASSERT_TRUE(loaded) << loaded.error().message();
  EXPECT_EQ(material_of(loaded->scene, 0).base_color, glm::vec4(0.8f, 0.25f, 0.125f, 0.5f));
  for (const char* statement : {"Kd 0.5 0.5x 0", "d 1..0", "Tr x", "Ns 10;", "Pr 1,2,3", "Ke 1f"}) {
    (void)write_file(folder / "m.mtl", std::string("newmtl m\n\n") + statement + "\n");
    const Result<LoadedScene> refused = load_scene(folder / "a.obj");
    ASSERT_FALSE(refused) << statement;
    EXPECT_EQ(refused.error().reason.find("'m.mtl' line 3 has '"), 0u) << refused.error().reason;
  }
}

std::string ply_of(const std::string& elements, const std::string& body) {
  return "ply\nformat ascii 1.0\n" + elements + "end_header\n" + body;
}

constexpr char kSixVertices[] =
    "element vertex 6\nproperty float x\nproperty float y\nproperty float z\n";
constexpr char kSixPositions[] = "0 0 0\n1 0 0\n0 1 0\n1 1 0\n0 2 0\n1 2 0\n";

TEST(Ply, strips_are_cut_into_triangles_that_all_run_the_same_way) {
  const std::string header =
      std::string(kSixVertices) + "element tristrips 1\nproperty list int int vertex_indices\n";
  // Two strips; the second turns on the spot, and a third is too short.
  const Result<LoadedScene> loaded = load_polygons(
      ply_of(header, std::string(kSixPositions) + "14 0 1 2 3 4 -1 2 3 3 4 5 -1 0 1\n"), "a.ply");
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  EXPECT_EQ(loaded->warnings.size(), 0u);
  const glm::vec3 p[] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}, {0, 2, 0}, {1, 2, 0}};
  const std::vector<Triangle> expected = {
      {p[0], p[1], p[2]}, {p[2], p[1], p[3]}, {p[2], p[3], p[4]}, {p[3], p[4], p[5]}};
  EXPECT_EQ(triangles_of(loaded->scene), expected);
  EXPECT_EQ(reason_of_polygons(ply_of(header, std::string(kSixPositions) + "3 0 1 -2\n"), "a.ply"),
            "has a face that refers to a vertex that does not exist");
}

// 10^10 elements of nothing would take minutes to pass over.
TEST(Ply, elements_without_properties_take_no_time) {
  std::string elements;
  for (int i = 0; i < 20000; ++i)
    elements += i % 2 ? "element face 400000\n" : "element some 400000\n";
  EXPECT_EQ(
      reason_of_polygons(ply_of(std::string(kSixVertices) + elements, kSixPositions), "a.ply"),
      "ok");  // six points
}

TEST(Ply, a_list_of_impossible_length_is_refused) {
  for (const char* element : {"face", "tristrips", "some"})
    for (const char* length : {"nan", "-1", "inf"})
      EXPECT_EQ(reason_of_polygons(ply_of(std::string(kSixVertices) + "element " + element +
                                              " 1\nproperty list float int vertex_indices\n",
                                          std::string(kSixPositions) + length + "\n"),
                                   "a.ply"),
                "has a list of impossible length");
  EXPECT_EQ(reason_of_polygons(ply_of("element vertex 1\nproperty float x\nproperty float y\n"
                                      "property float z\nproperty list double int w\n",
                                      "0 0 0 nan\n"),
                               "a.ply"),
            "has a list of impossible length");
}

TEST(PolygonFiles, a_polygon_that_is_cut_short_is_a_warning) {
  PolygonSoup soup;
  soup.positions = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  soup.triangles = {{0}, {1}, {2}};
  soup.parts = {0};
  soup.cut_short = true;
  LoadContext context{"a", {}, 0.0, MemoryBudget(1 << 24)};
  (void)scene_of(std::move(soup), {{"a", -1}}, {}, context);
  const std::vector<std::string> expected = {
      "polygons that cross themselves, or have too many corners, are drawn as fans"};
  EXPECT_EQ(context.warnings.lines(), expected);
}

TEST(Ply, colours_of_scans_become_linear) {
  const Result<LoadedScene> loaded = load_polygons(
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
      "element face 1\nproperty list uchar int vertex_index\nend_header\n"
      "0 0 0 255 0 51\n1 0 0 0 0 0\n0 1 0 0 0 0\n3 0 1 2\n",
      "a.ply");
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  const glm::vec4 c = loaded->scene.meshes[0].colors[0];
  EXPECT_EQ(c, glm::vec4(1, 0, linear_from_srgb(0.2f), 1));
  EXPECT_EQ(material_of(loaded->scene, 0).base_color, glm::vec4(1));
}

}  // namespace
}  // namespace rilievo
