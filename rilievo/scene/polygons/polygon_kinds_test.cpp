// What only some programs write in OBJ, PLY and STL.
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>

#include "rilievo/core/color.h"
#include "rilievo/core/file.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/io/load_context.h"
#include "rilievo/io/png.h"
#include "rilievo/scene/files/load_scene.h"

namespace rilievo {
namespace {

LoadedScene loaded_from(const std::string& bytes, const std::string& name) {
  const Result<LoadedScene> loaded = load_scene(bytes_of(bytes), name);
  EXPECT_TRUE(loaded) << loaded.error().message();
  return loaded ? *loaded : LoadedScene{};
}

std::string refusal_of(const std::string& bytes, const std::string& name) {
  const Result<LoadedScene> loaded = load_scene(bytes_of(bytes), name);
  return loaded ? "ok" : loaded.error().reason;
}

using Lines = std::vector<std::string>;

// Four squares around the y axis, the sides of a box without lid and bottom; `before` stands before
// each face.
std::string sides(const std::array<const char*, 4>& before, const char* x = "") {
  std::string text =
      "v 1 0 1\nv 1 1 1\nv 1 0 -1\nv 1 1 -1\nv -1 0 -1\nv -1 1 -1\nv -1 0 1\nv -1 1 1\n";
  const char* faces[] = {"f 1 3 4 2\n", "f 3 5 6 4\n", "f 5 7 8 6\n", "f 7 1 2 8\n"};
  for (int i = 0; i < 4; ++i) text += std::string(before[std::size_t(i)]) + faces[i];
  return text + x;
}

// The normals that the corners of the k-th side have at its two edges, of which the first lies
// where the side before ends.
std::pair<glm::vec3, glm::vec3> edge_normals(const LoadedScene& loaded, int side) {
  const glm::vec3 begins[] = {{1, 0, 1}, {1, 0, -1}, {-1, 0, -1}, {-1, 0, 1}};
  std::pair<glm::vec3, glm::vec3> normals;
  int seen = -1;
  for (const Mesh& mesh : loaded.scene.meshes)
    for (std::size_t t = 0; t < mesh.indices.size() / 6; ++t) {
      if (++seen != side) continue;
      for (std::size_t k = 0; k < 6; ++k) {
        const std::uint32_t v = mesh.indices[6 * t + k];
        if (mesh.positions[v] == begins[side]) normals.first = mesh.normals[v];
        if (mesh.positions[v] == begins[(side + 1) % 4]) normals.second = mesh.normals[v];
      }
    }
  return normals;
}

TEST(Obj, smoothing_groups_decide_where_there_are_no_normals) {
  const glm::vec3 right(1, 0, 0), back(0, 0, -1);
  // Of two sides, one may count twice: it has two triangles at the corner.
  const auto between = [](const glm::vec3& n) {
    return std::abs(n.x) > 0.4f && std::abs(n.z) > 0.4f;
  };
  for (const char* off : {"s off\n", "s 0\n", "s OFF\n", ""}) {
    const LoadedScene flat = loaded_from(sides({off, "", "", ""}), "a.obj");
    EXPECT_EQ(edge_normals(flat, 0), std::pair(right, right)) << off;
    EXPECT_EQ(edge_normals(flat, 1), std::pair(back, back)) << off;
  }
  for (const char* on : {"s 1\n", "s on\n", "s 32\n"}) {
    const LoadedScene smooth = loaded_from(sides({on, "", "", ""}), "a.obj");
    for (int side = 0; side < 4; ++side) {
      EXPECT_TRUE(between(edge_normals(smooth, side).first)) << on << side;
      EXPECT_TRUE(between(edge_normals(smooth, side).second)) << on << side;
    }
  }
  // Groups 1 1 2 2: smooth within each alone.
  const LoadedScene two = loaded_from(sides({"s 1\n", "", "s 2\n", ""}), "a.obj");
  EXPECT_EQ(edge_normals(two, 0).first, right);
  EXPECT_TRUE(between(edge_normals(two, 0).second));
  EXPECT_TRUE(between(edge_normals(two, 1).first));
  EXPECT_EQ(edge_normals(two, 1).second, back);
  // The same number in another object is another group.
  const LoadedScene objects = loaded_from(sides({"o a\ns 1\n", "", "o b\n", ""}), "a.obj");
  EXPECT_EQ(edge_normals(objects, 0).first, right);
  EXPECT_TRUE(between(edge_normals(objects, 0).second));
  // Normals of the file count before any group.
  const LoadedScene own =
      loaded_from("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 1 0\ns off\nf 1//1 2//1 3//1\n", "a.obj");
  EXPECT_EQ(own.scene.meshes[0].normals[0], glm::vec3(0, 1, 0));
  EXPECT_EQ(refusal_of("s 1x\n", "a.obj"), "line 1 has '1x' where a number belongs");
}

// A gentle bend is flat by `s off`, smooth by angle without any s.
TEST(Obj, s_off_is_flat_even_where_the_angle_is_small) {
  const std::string bend = "v 0 0 0\nv 1 0 0\nv 0 1 0.1\nv 1 1 0.1\nv 0 2 0.3\nv 1 2 0.3\n";
  const auto count = [&](const std::string& s) {
    return loaded_from(bend + s + "f 1 2 4 3\nf 3 4 6 5\n", "a.obj").scene.meshes[0].normals.size();
  };
  EXPECT_EQ(count(""), 6u);
  EXPECT_EQ(count("s 5\n"), 6u);
  EXPECT_EQ(count("s off\n"), 8u);
}

// A place where many flat triangles meet.
TEST(Obj, a_crowded_place_is_flat_if_its_faces_are) {
  std::string text = "v 0 1 0\n";
  constexpr int kSides = 100;
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2 * 3.14159265358979 * i / kSides;
    text += "v " + std::to_string(std::cos(angle)) + " 0 " + std::to_string(std::sin(angle)) + "\n";
  }
  std::string faces;
  for (int i = 0; i < kSides; ++i)
    faces += "f 1 " + std::to_string(2 + (i + 1) % kSides) + " " + std::to_string(2 + i) + "\n";
  const Scene flat = loaded_from(text + "s off\n" + faces, "a.obj").scene;
  EXPECT_EQ(flat.meshes[0].positions.size(), 3u * kSides);
  const Scene smooth = loaded_from(text + "s 1\n" + faces, "a.obj").scene;
  EXPECT_EQ(smooth.meshes[0].positions.size(), std::size_t(kSides + 1));
}

TEST(Obj, a_comment_that_ends_in_a_backslash_does_not_swallow_the_next_line) {
  const LoadedScene loaded = loaded_from(
      "# exported to C:\\scans\\\nv 0 0 0\n  # C:\\\nv 1 0 0 # D:\\\nv 0 1 \\\n 0\nf 1 2 \\\n3\n",
      "a.obj");
  EXPECT_EQ(count_triangles(loaded.scene), 1u);
  EXPECT_EQ(refusal_of("# C:\\\nv 0 0 0\n#\\\nv x 0 0\n", "a.obj"),
            "line 4 has 'x' where a number belongs");
}

TEST(Obj, opacity_counts_before_transparency) {
  struct Case {
    const char* statements;
    float alpha;
    std::size_t warnings;
  };
  const Case cases[] = {{"d 0.3\nTr 0.3\n", 0.3f, 1},
                        {"Tr 0.3\nd 0.3\n", 0.3f, 1},
                        {"d 1.0\nTr 1.0\n", 1, 1},
                        {"Tr 1.0\nd 1.0\n", 1, 1},
                        {"d 0.25\nTr 0.75\n", 0.25f, 0},
                        {"Tr 0.7500\nd 0.250\n", 0.25f, 0},
                        {"Tr 0.75\n", 0.25f, 0},
                        {"Tr 0\n", 1, 0},
                        {"Tr 1\n", 1, 1},
                        {"d -halo 0.25\n", 0.25f, 1},
                        {"d 0\nTr 0\n", 1, 2}};
  for (const Case& c : cases) {
    const TemporaryFolder folder;
    (void)write_file(folder / "m.mtl", std::string("newmtl m\nKd 1 1 1\n") + c.statements);
    (void)write_file(folder / "a.obj",
                     "mtllib m.mtl\nusemtl m\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    const Result<LoadedScene> loaded = load_scene(folder / "a.obj");
    ASSERT_TRUE(loaded) << loaded.error().message();
    EXPECT_FLOAT_EQ(loaded->scene.materials[0].base_color.a, c.alpha) << c.statements;
    EXPECT_EQ(loaded->warnings.size(), c.warnings) << c.statements;
  }
}

TEST(PolygonFiles, vertices_that_no_face_uses_need_not_be_finite) {
  for (const char* bad : {"nan nan nan", "0 0 inf", "-1.#IND00 0 0", "1e300 0 0"}) {
    const std::string v(bad);
    const LoadedScene obj =
        loaded_from("v " + v + "\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv " + v + "\nf 2 3 4\n", "a.obj");
    EXPECT_EQ(world_bounds(obj.scene).max, glm::vec3(1, 1, 0));
    const std::string head =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"
        "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
    const LoadedScene ply = loaded_from(head + v + "\n0 0 0\n1 0 0\n0 1 0\n3 1 2 3\n", "a.ply");
    EXPECT_EQ(world_bounds(ply.scene).max, glm::vec3(1, 1, 0));
    EXPECT_EQ(refusal_of(head + "0 0 0\n1 0 0\n0 1 0\n" + v + "\n3 1 2 3\n", "a.ply"),
              "has a face with vertex 3, whose position is not finite");
  }
}

constexpr char kFour[] = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
constexpr char kSquare[] = "0 0 0\n1 0 0\n1 1 0\n0 1 0\n";
constexpr char kFaces[] = "property list uchar int vertex_indices\n";

std::string ply(const std::string& header, const std::string& body) {
  return "ply\nformat ascii 1.0\n" + header + "end_header\n" + body;
}

TEST(Ply, elements_come_in_any_order) {
  const LoadedScene text =
      loaded_from(ply("element other 1\nproperty int a\nelement face 1\n" + std::string(kFaces) +
                          kFour + "element face 1\n" + kFaces,
                      "7\n3 0 1 2\n" + std::string(kSquare) + "3 0 2 3\n"),
                  "a.ply");
  EXPECT_EQ(count_triangles(text.scene), 2u);
  std::string binary = "ply\nformat binary_little_endian 1.0\nelement face 2\n" +
                       std::string(kFaces) + kFour + "end_header\n";
  const auto append = [&](auto value) {
    binary.append(reinterpret_cast<const char*>(&value), sizeof value);
  };
  for (const std::array<int, 3>& face : {std::array{0, 1, 2}, {0, 2, 3}}) {
    append(std::uint8_t(3));
    for (int v : face) append(std::int32_t(v));
  }
  for (float c : {0.f, 0.f, 0.f, 1.f, 0.f, 0.f, 1.f, 1.f, 0.f, 0.f, 1.f, 0.f}) append(c);
  EXPECT_EQ(count_triangles(loaded_from(binary, "a.ply").scene), 2u);
  EXPECT_EQ(refusal_of(ply("element face 1\n" + std::string(kFaces) + kFour,
                           "3 0 1 4\n" + std::string(kSquare)),
                       "a.ply"),
            "has a face that refers to a vertex that does not exist");
  EXPECT_EQ(refusal_of(ply(std::string(kFour) + "element face 1\n" + kFaces,
                           std::string(kSquare) + "3 0 1 1.5\n"),
                       "a.ply"),
            "has a face that refers to a vertex that does not exist");
  EXPECT_EQ(refusal_of(ply("element face 1\n" + std::string(kFaces), "3 0 1 2\n"), "a.ply"),
            "is a PLY file without an element 'vertex'");
}

TEST(Ply, faces_have_colours_where_vertices_have_none) {
  const std::string face = "element face 2\n" + std::string(kFaces);
  const char* names[][3] = {{"red", "green", "blue"}, {"r", "g", "b"}};
  for (const auto& name : names) {
    std::string colored = face;
    for (const char* channel : name) colored += std::string("property uchar ") + channel + "\n";
    const Scene scene = loaded_from(ply(kFour + colored, std::string(kSquare) +
                                                             "3 0 1 2 255 0 51\n3 0 2 3 0 255 0\n"),
                                    "a.ply")
                            .scene;
    const Mesh& mesh = scene.meshes[0];
    ASSERT_EQ(mesh.positions.size(), 6u);
    EXPECT_EQ(scene.materials[std::size_t(mesh.material)].base_color, glm::vec4(1));
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(mesh.colors[mesh.indices[k]], glm::vec4(1, 0, linear_from_srgb(0.2f), 1));
      EXPECT_EQ(mesh.colors[mesh.indices[3 + k]], glm::vec4(0, 1, 0, 1));
    }
    // Vertices of several colours say more.
    const std::string both = std::string(kFour) +
                             "property uchar red\nproperty uchar green\nproperty uchar blue\n" +
                             colored;
    const std::string faces = "3 0 1 2 255 0 0\n3 0 2 3 0 255 0\n";
    const Mesh fine =
        loaded_from(ply(both, "0 0 0 9 9 9\n1 0 0 8 8 8\n1 1 0 9 9 9\n0 1 0 9 9 9\n" + faces),
                    "a.ply")
            .scene.meshes[0];
    EXPECT_EQ(fine.colors[fine.indices[0]].r, fine.colors[fine.indices[0]].g);
    const Mesh grey =
        loaded_from(ply(both, "0 0 0 9 9 9\n1 0 0 9 9 9\n1 1 0 9 9 9\n0 1 0 9 9 9\n" + faces),
                    "a.ply")
            .scene.meshes[0];
    EXPECT_EQ(grey.colors[grey.indices[0]], glm::vec4(1, 0, 0, 1));
  }
}

TEST(Ply, pictures_that_comments_name_are_shown) {
  const TemporaryFolder folder;
  const auto plain = [](const glm::u8vec4& c) { return encode_png(Rgba8Image(2, 2, c)); };
  for (const auto& [name, color] : {std::pair("skin.png", glm::u8vec4(255, 0, 0, 255)),
                                    {"other skin.png", glm::u8vec4(0, 255, 0, 255)}}) {
    const auto png = plain(color);
    (void)write_file(folder / name, std::string(png.begin(), png.end()));
  }
  const auto load = [&](const std::string& text) {
    (void)write_file(folder / "a.ply", text);
    const Result<LoadedScene> loaded = load_scene(folder / "a.ply");
    EXPECT_TRUE(loaded) << loaded.error().message();
    return loaded ? *loaded : LoadedScene{};
  };
  const auto color_of = [](const LoadedScene& loaded, std::size_t mesh) {
    const Scene& s = loaded.scene;
    const int texture =
        s.materials[std::size_t(s.meshes[mesh].material)].base_color_texture.texture;
    return texture < 0 ? glm::u8vec4(0)
                       : s.images[std::size_t(s.textures[std::size_t(texture)].image)](0, 0);
  };
  const std::string face = "element face 1\n" + std::string(kFaces);
  for (const char* words :
       {"comment TextureFile skin.png\n", "comment texturefile: skin.png\n",
        "obj_info TextureFile \"skin.png\"\n", "comment TextureFile .\\skin.png\n"})
    for (const char* uv : {"s\nproperty float t\n", "texture_u\nproperty float texture_v\n",
                           "u\nproperty float v\n"}) {
      const LoadedScene loaded =
          load(ply(words + std::string(kFour) + "property float " + uv + face,
                   "0 0 0 0 0.25\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n3 0 1 2\n"));
      EXPECT_EQ(color_of(loaded, 0), glm::u8vec4(255, 0, 0, 255)) << words;
      EXPECT_EQ(loaded.scene.meshes[0].uv[0][0], glm::vec2(0, 0.75f));
    }
  // Coordinates of corners, before and behind the vertices; two pictures, and a face without.
  const std::string two =
      "comment TextureFile skin.png\ncomment TextureFile other skin.png\n" + std::string(kFour);
  const LoadedScene corners =
      load(ply(two + "element face 3\nproperty list uchar float texcoord\n" + kFaces +
                   "property int texnumber\n",
               std::string(kSquare) +
                   "6 0 0 1 0 1 1 3 0 1 2 1\n6 0 0.25 1 1 0 1 3 0 2 3 0\n0 3 0 1 3 -1\n"));
  ASSERT_EQ(corners.scene.meshes.size(), 3u);
  EXPECT_EQ(color_of(corners, 0), glm::u8vec4(0, 255, 0, 255));
  EXPECT_EQ(color_of(corners, 1), glm::u8vec4(255, 0, 0, 255));
  EXPECT_EQ(color_of(corners, 2), glm::u8vec4(0));
  EXPECT_EQ(corners.scene.meshes[1].uv[0][0], glm::vec2(0, 0.75f));
  EXPECT_EQ(corners.scene.objects.size(), 1u);
  (void)write_file(folder / "a.ply",
                   ply(two + "element face 1\n" + kFaces + "property list uchar float texcoord\n",
                       std::string(kSquare) + "3 0 1 2 5 0 0 0 0 0\n"));
  EXPECT_EQ(load_scene(folder / "a.ply").error().reason,
            "has a face with 3 corners, but 5 texture coordinates");
  // What is missing is a warning.
  const LoadedScene gone = load(ply("comment TextureFile gone.png\n" + std::string(kFour) +
                                        "property float s\nproperty float t\n" + face,
                                    "0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n3 0 1 2\n"));
  EXPECT_EQ(gone.warnings, Lines{"a texture is left out: 'gone.png': No such file or directory"});
  const LoadedScene nowhere = load(ply("comment TextureFile skin.png\n" + std::string(kFour) + face,
                                       std::string(kSquare) + "3 0 1 2\n"));
  EXPECT_EQ(nowhere.warnings, Lines{"has a picture for its faces, but no texture coordinates"});
}

TEST(Ply, gaussian_splats_are_named) {
  const char* reason = "holds 3-D Gaussian splats";
  EXPECT_EQ(refusal_of(ply("element vertex 1\nproperty float x\nproperty float y\nproperty float "
                           "z\nproperty float f_dc_0\n",
                           "0 0 0 0\n"),
                       "a.ply")
                .find(reason),
            0u);
  EXPECT_EQ(refusal_of(ply("element chunk 1\nproperty float min_x\nelement vertex 1\nproperty uint "
                           "packed_position\n",
                           "0\n0\n"),
                       "a.ply")
                .find(reason),
            0u);
  for (const char* name : {"a.spz", "a.splat", "A.SPLAT"})
    EXPECT_EQ(refusal_of("\x1F\x8B\x08", name).find(reason), 0u) << name;
}

std::string facet(double x) {
  return "facet normal 0 0 0\nouter loop\nvertex " + std::to_string(x) + " 0 0\nvertex 1 0 0\n" +
         "vertex 0 1 0\nendloop\nendfacet\n";
}

TEST(Stl, each_solid_is_an_object) {
  const LoadedScene two =
      loaded_from("solid body A\n" + facet(0) + facet(2) +
                      "endsolid vertex A\nsolid empty\nendsolid\nSOLID body B\n" + facet(3) +
                      "endsolid\nsolid\n" + facet(4) + "endsolid\nsolid body B\n" + facet(5),
                  "a.stl");
  ASSERT_EQ(two.scene.objects.size(), 4u);
  const char* names[] = {"body A", "body B", "solid", "body B #4"};
  for (std::size_t i = 0; i < 4; ++i) EXPECT_EQ(two.scene.objects[i].name, names[i]);
  EXPECT_EQ(two.scene.models[0].triangles, 2u);
  EXPECT_EQ(loaded_from("solid\n" + facet(0), "a.stl").scene.objects[0].name, "a");
  EXPECT_EQ(loaded_from("solid OpenSCAD_Model\n" + facet(0), "a.stl").scene.objects[0].name,
            "OpenSCAD_Model");
}

TEST(Stl, what_is_cut_short_says_how_much_is_there) {
  for (const char* head : {"solid scan", "something"}) {
    std::string binary(head);
    binary.resize(80, ' ');
    const std::uint32_t count = 12;
    binary.append(reinterpret_cast<const char*>(&count), 4);
    for (int i = 0; i < 12; ++i) {
      const float numbers[] = {0, 0, 0, 0, 0, float(i), 1, 0, 0, 0, 1, 0};
      binary.append(reinterpret_cast<const char*>(numbers), sizeof numbers);
      binary.append(2, '\0');
    }
    EXPECT_EQ(count_triangles(loaded_from(binary, "a.stl").scene), 12u);
    EXPECT_EQ(refusal_of(binary.substr(0, binary.size() - 100), "a.stl"),
              "is a binary STL file that is cut short, or none: it announces 12 triangles, but has "
              "bytes for 10");
    std::string uncounted = binary;
    uncounted[80] = 0;
    const LoadedScene all = loaded_from(uncounted, "a.stl");
    EXPECT_EQ(count_triangles(all.scene), 12u);
    EXPECT_EQ(all.warnings, Lines{"announces no triangles, but has bytes for 12, which are read"});
    EXPECT_EQ(refusal_of(uncounted + "x", "a.stl"),
              "is a binary STL file that announces no triangles, and its 685 bytes are no whole "
              "number of them");
  }
  EXPECT_EQ(refusal_of("solid a\n" + facet(0) + "facet\nouter loop\nvertex 0 0 0\n", "a.stl"),
            "is an STL file that is cut short: it ends within a facet, after 1 whole ones");
}

}  // namespace
}  // namespace rilievo
