#include "rilievo/scene/gltf/mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <glm/gtc/quaternion.hpp>
#include <random>

#include "rilievo/scene/files/load_scene.h"
#include "rilievo/scene/gltf/gltf_test_helpers.h"

namespace rilievo {
namespace {

using test::GltfBuilder;

Result<LoadedScene> load(const GltfBuilder& b, double time = 0.0) {
  const std::string file = b.glb();
  LoadOptions options;
  options.time = time;
  return load_scene({reinterpret_cast<const std::uint8_t*>(file.data()), file.size()}, "test.glb",
                    options);
}

std::vector<float> random_floats(std::mt19937& rng, std::size_t n, float low = -1, float high = 1) {
  std::uniform_real_distribution<float> u(low, high);
  std::vector<float> out(n);
  for (float& v : out) v = u(rng);
  return out;
}

using Triangle = std::array<glm::vec3, 3>;

std::vector<Triangle> triangles_of(const Mesh& mesh) {
  std::vector<Triangle> out;
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    out.push_back({mesh.positions[mesh.indices[i]], mesh.positions[mesh.indices[i + 1]],
                   mesh.positions[mesh.indices[i + 2]]});
  return out;
}

TEST(GltfMesh, lists_strips_and_fans_with_every_kind_of_index) {
  std::mt19937 rng(41);
  for (int round = 0; round < 300; ++round) {
    const std::size_t vertices = 3 + rng() % 20;
    const std::vector<float> p = random_floats(rng, 3 * vertices);
    const int mode = 4 + int(rng() % 3), index_type = int(rng() % 4);
    std::vector<std::uint32_t> order;
    if (index_type == 3)
      for (std::uint32_t i = 0; i < vertices; ++i) order.push_back(i);
    else
      for (std::size_t i = 3 + rng() % 30; i > 0; --i) order.push_back(rng() % vertices);

    GltfBuilder b;
    nlohmann::json primitive = {{"attributes", {{"POSITION", b.floats(p, "VEC3")}}},
                                {"mode", mode}};
    if (index_type == 0)
      primitive["indices"] =
          b.packed(std::vector<std::uint8_t>(order.begin(), order.end()), "SCALAR", 5121);
    if (index_type == 1)
      primitive["indices"] =
          b.packed(std::vector<std::uint16_t>(order.begin(), order.end()), "SCALAR", 5123);
    if (index_type == 2) primitive["indices"] = b.packed(order, "SCALAR", 5125);
    b.node({{"mesh", b.mesh(primitive)}});

    // The definitions of section 3.7.2.1, one triangle at a time.
    std::vector<Triangle> expected;
    const auto at = [&](std::uint32_t i) {
      return glm::vec3(p[3 * i], p[3 * i + 1], p[3 * i + 2]);
    };
    for (std::size_t i = 0; mode == 4 ? 3 * i + 2 < order.size() : i + 2 < order.size(); ++i) {
      std::array<std::size_t, 3> v;
      if (mode == 4) v = {3 * i, 3 * i + 1, 3 * i + 2};
      if (mode == 5) v = {i, i + (1 + i % 2), i + (2 - i % 2)};
      if (mode == 6) v = {i + 1, i + 2, 0};
      const std::array<std::uint32_t, 3> n{order[v[0]], order[v[1]], order[v[2]]};
      if (mode != 4 && (n[0] == n[1] || n[1] == n[2] || n[2] == n[0])) continue;
      expected.push_back({at(n[0]), at(n[1]), at(n[2])});
    }
    const Result<LoadedScene> loaded = load(b);
    if (expected.empty()) {
      EXPECT_FALSE(loaded.ok());
      continue;
    }
    if (!loaded.ok()) {
      // All triangles of a list may have been one vertex.
      EXPECT_EQ(loaded.error().reason, "has all that it shows in one point");
      continue;
    }
    EXPECT_EQ(triangles_of(loaded->scene.meshes[0]), expected) << "mode " << mode;
  }
}

TEST(GltfMesh, keeps_the_vertices_in_use_with_all_their_attributes) {
  std::mt19937 rng(42);
  for (int round = 0; round < 100; ++round) {
    const std::size_t vertices = 3 + rng() % 50;
    const std::vector<float> p = random_floats(rng, 3 * vertices),
                             uv = random_floats(rng, 2 * vertices);
    std::vector<float> n = random_floats(rng, 3 * vertices);
    for (std::size_t i = 0; i < vertices; ++i) n[3 * i] += 2;  // none of length zero
    std::vector<std::uint16_t> indices;
    const std::size_t corners = 3 * (1 + rng() % 10);
    for (std::size_t i = 0; i < corners; ++i) indices.push_back(std::uint16_t(rng() % vertices));
    indices[1] = std::uint16_t((indices[0] + 1) % vertices);
    GltfBuilder b;
    b.node({{"mesh", b.mesh({{"attributes",
                              {{"POSITION", b.floats(p, "VEC3")},
                               {"NORMAL", b.floats(n, "VEC3")},
                               {"TEXCOORD_1", b.floats(uv, "VEC2")}}},
                             {"indices", b.packed(indices, "SCALAR", 5123)}})}});
    const Result<LoadedScene> loaded = load(b);
    ASSERT_TRUE(loaded.ok()) << loaded.error().message();
    const Mesh& mesh = loaded->scene.meshes[0];
    ASSERT_EQ(mesh.indices.size(), indices.size());
    for (std::size_t i = 0; i < indices.size(); ++i) {
      const std::size_t from = indices[i], to = mesh.indices[i];
      const glm::vec3 normal =
          glm::normalize(glm::vec3(n[3 * from], n[3 * from + 1], n[3 * from + 2]));
      EXPECT_EQ(mesh.positions[to], glm::vec3(p[3 * from], p[3 * from + 1], p[3 * from + 2]));
      EXPECT_EQ(mesh.uv[1][to], glm::vec2(uv[2 * from], uv[2 * from + 1]));
      EXPECT_LT(glm::length(mesh.normals[to] - normal), 1e-6f);  // rounding of one division
    }
    std::sort(indices.begin(), indices.end());
    const auto used = std::unique(indices.begin(), indices.end()) - indices.begin();
    EXPECT_EQ(mesh.positions.size(), std::size_t(used));
  }
}

TEST(GltfMesh, colours_of_every_kind_mean_the_same) {
  // 0, 1/5, 1: what 8, 16 bits and floats all hold exactly.
  const std::vector<float> expected = {0, 0.2f, 1, 1};
  for (int numbers : {3, 4})
    for (int component : {5121, 5123, 5126}) {
      GltfBuilder b = test::triangle();
      const char* const type = numbers == 3 ? "VEC3" : "VEC4";
      std::vector<float> all;
      for (int v = 0; v < 3; ++v)
        all.insert(all.end(), expected.begin(), expected.begin() + numbers);
      int accessor = -1;
      if (component == 5126) accessor = b.floats(all, type);
      if (component == 5121) {
        std::vector<std::uint8_t> bytes;
        for (float f : all) bytes.push_back(std::uint8_t(f * 255));
        accessor = b.packed(bytes, type, component, true);
      }
      if (component == 5123) {
        std::vector<std::uint16_t> words;
        for (float f : all) words.push_back(std::uint16_t(f * 65535));
        accessor = b.packed(words, type, component, true);
      }
      b.json["meshes"][0]["primitives"][0]["attributes"]["COLOR_0"] = accessor;
      const Result<LoadedScene> loaded = load(b);
      ASSERT_TRUE(loaded.ok()) << loaded.error().message();
      for (const glm::vec4& c : loaded->scene.meshes[0].colors)
        for (int k = 0; k < 4; ++k) EXPECT_FLOAT_EQ(c[k], expected[k]) << component;
    }
}

// The slow twin: every vertex by the formula of section 3.7.3.3, weights and all.
TEST(GltfMesh, skins_and_morph_targets_are_posed_as_defined) {
  std::mt19937 rng(43);
  for (int round = 0; round < 100; ++round) {
    const std::size_t vertices = 6, joints = 1 + rng() % 4;
    const std::vector<float> p = random_floats(rng, 3 * vertices);
    const std::vector<float> d0 = random_floats(rng, 3 * vertices),
                             d1 = random_floats(rng, 3 * vertices);
    std::vector<float> weights = random_floats(rng, 4 * vertices, 0, 1);
    std::vector<std::uint8_t> influence;
    for (std::size_t i = 0; i < 4 * vertices; ++i)
      influence.push_back(std::uint8_t(rng() % joints));
    for (std::size_t v = 0; v < vertices; ++v) {
      const float sum =
          weights[4 * v] + weights[4 * v + 1] + weights[4 * v + 2] + weights[4 * v + 3];
      for (int k = 0; k < 4; ++k) weights[4 * v + k] /= sum;
    }
    std::vector<float> bind;
    for (std::size_t j = 0; j < joints; ++j) {
      std::vector<float> m = random_floats(rng, 16);
      m[3] = m[7] = m[11] = 0, m[15] = 1;
      bind.insert(bind.end(), m.begin(), m.end());
    }
    GltfBuilder b;
    nlohmann::json primitive = {
        {"attributes",
         {{"POSITION", b.floats(p, "VEC3")},
          {"JOINTS_0", b.packed(influence, "VEC4", 5121)},
          {"WEIGHTS_0", b.floats(weights, "VEC4")}}},
        {"targets", {{{"POSITION", b.floats(d0, "VEC3")}}, {{"POSITION", b.floats(d1, "VEC3")}}}}};
    const int mesh = b.mesh(primitive);
    b.node({{"mesh", mesh}, {"skin", 0}, {"translation", {9, 9, 9}}});  // ignored for a skin
    nlohmann::json skin;
    std::vector<glm::dmat4> world_from_joint;
    glm::dmat4 parent(1.0);
    for (std::size_t j = 0; j < joints; ++j) {
      const std::vector<float> t = random_floats(rng, 3);
      const int node = b.node({{"translation", t}});
      if (j > 0) b.json["nodes"][node - 1]["children"] = nlohmann::json::array({node});
      skin["joints"].push_back(node);
      parent[3] += glm::dvec4(t[0], t[1], t[2], 0);
      world_from_joint.push_back(parent);
    }
    skin["inverseBindMatrices"] = b.floats(bind, "MAT4");
    b.json["skins"] = nlohmann::json::array({skin});
    // Weights from 0.25, 0.75 to 1, 0 within two seconds.
    b.json["animations"] = {
        {{"samplers",
          {{{"input", b.floats({0, 2}, "SCALAR")},
            {"output", b.floats({0.25f, 0.75f, 1, 0}, "SCALAR")}}}},
         {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "weights"}}}}}}}};
    const double time = 1.0, w0 = 0.625, w1 = 0.375;

    const Result<LoadedScene> loaded = load(b, time);
    ASSERT_TRUE(loaded.ok()) << loaded.error().message();
    const Mesh& posed = loaded->scene.meshes[0];
    EXPECT_EQ(loaded->scene.objects[0].placement, glm::mat4(1.0f));
    std::vector<glm::dvec3> expected;
    int mirrored = 0;
    for (std::size_t v = 0; v < vertices; ++v) {
      glm::dmat4 m(0.0);
      for (int k = 0; k < 4; ++k) {
        const std::size_t j = influence[4 * v + k];
        glm::dmat4 inverse_bind(1.0);
        for (int i = 0; i < 16; ++i) inverse_bind[i / 4][i % 4] = bind[16 * j + i];
        m += double(weights[4 * v + k]) * (world_from_joint[j] * inverse_bind);
      }
      mirrored += glm::determinant(glm::dmat3(m)) < 0;
      glm::dvec4 q(0, 0, 0, 1);
      for (int c = 0; c < 3; ++c) q[c] = p[3 * v + c] + w0 * d0[3 * v + c] + w1 * d1[3 * v + c];
      expected.push_back(glm::dvec3(m * q));
    }
    // Without normals every triangle has its own corners, in order; mirrored ones are turned round.
    ASSERT_EQ(posed.positions.size(), vertices);
    for (std::size_t i = 0; i < vertices; ++i) {
      const bool turned = mirrored > int(vertices / 2) && i % 3 != 0;
      const std::size_t from = turned ? i - i % 3 + (3 - i % 3) : i;
      // Floats in, floats out: some 1e-7 of numbers up to 10.
      EXPECT_LT(glm::length(glm::dvec3(posed.positions[i]) - expected[from]), 1e-5) << round;
    }
  }
}

TEST(GltfMesh, flat_normals_face_the_front) {
  const Result<LoadedScene> loaded = load(test::triangle());
  ASSERT_TRUE(loaded.ok());
  for (const glm::vec3& n : loaded->scene.meshes[0].normals) EXPECT_EQ(n, glm::vec3(0, 0, 1));
}

TEST(GltfMesh, bad_normals_are_repaired_from_the_triangles) {
  GltfBuilder b = test::triangle();
  const float nan = std::numeric_limits<float>::quiet_NaN();
  b.json["meshes"][0]["primitives"][0]["attributes"]["NORMAL"] =
      b.floats({0, 0, 0, nan, 0, 1, 0, 2, 0}, "VEC3");
  const Result<LoadedScene> loaded = load(b);
  ASSERT_TRUE(loaded.ok());
  const std::vector<glm::vec3>& n = loaded->scene.meshes[0].normals;
  EXPECT_EQ(n[0], glm::vec3(0, 0, 1));
  EXPECT_EQ(n[1], glm::vec3(0, 0, 1));
  EXPECT_EQ(n[2], glm::vec3(0, 1, 0));
}

}  // namespace
}  // namespace rilievo
