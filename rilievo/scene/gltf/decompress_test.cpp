#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <cmath>
#include <random>

#include "rilievo/scene/files/load_scene.h"
#include "rilievo/scene/gltf/document.h"
#include "rilievo/scene/gltf/gltf_test_helpers.h"

namespace rilievo::gltf {
namespace {

using test::GltfBuilder;

// The decoded content of a view that is compressed like this.
std::string decoded(const std::string& packed, std::size_t count, std::size_t stride,
                    const char* mode, const char* filter,
                    const char* extension = "EXT_meshopt_compression") {
  GltfBuilder b;
  const int view = b.view(packed);
  b.json["bufferViews"][view] = {{"buffer", 1},
                                 {"byteLength", count * stride},
                                 {"extensions",
                                  {{extension,
                                    {{"buffer", 0},
                                     {"byteLength", packed.size()},
                                     {"byteStride", stride},
                                     {"count", count},
                                     {"mode", mode},
                                     {"filter", filter}}}}}};
  const std::string file = b.glb();
  LoadContext context{"", {}, 0.0, MemoryBudget(1 << 24)};
  Document document = open_document(bytes_of(file), context);
  const Bytes bytes = read_view(document, 0);
  return {bytes.begin(), bytes.end()};
}

std::string encoded_vertices(const std::string& raw, std::size_t count, std::size_t stride) {
  std::string packed(meshopt_encodeVertexBufferBound(count, stride), '\0');
  packed.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(packed.data()),
                                           packed.size(), raw.data(), count, stride));
  return packed;
}

TEST(GltfMeshopt, every_mode_comes_back) {
  std::mt19937 rng(61);
  for (int round = 0; round < 100; ++round) {
    const std::size_t vertices = 3 + rng() % 300;
    const std::size_t stride = 4 * (1 + rng() % 10);
    std::string raw(vertices * stride, '\0');
    for (char& c : raw) c = char(rng() % 40);
    EXPECT_EQ(
        decoded(encoded_vertices(raw, vertices, stride), vertices, stride, "ATTRIBUTES", "NONE"),
        raw);

    std::vector<std::uint32_t> indices(3 * (1 + rng() % 100));
    for (std::uint32_t& i : indices) i = rng() % vertices;
    std::string packed(meshopt_encodeIndexSequenceBound(indices.size(), vertices), '\0');
    packed.resize(meshopt_encodeIndexSequence(reinterpret_cast<unsigned char*>(packed.data()),
                                              packed.size(), indices.data(), indices.size()));
    EXPECT_EQ(decoded(packed, indices.size(), 4, "INDICES", "NONE"),
              GltfBuilder::bytes_of(indices));
    const std::vector<std::uint16_t> narrow(indices.begin(), indices.end());
    EXPECT_EQ(decoded(packed, indices.size(), 2, "INDICES", "NONE"), GltfBuilder::bytes_of(narrow));

    packed.assign(meshopt_encodeIndexBufferBound(indices.size(), vertices), '\0');
    packed.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(packed.data()),
                                            packed.size(), indices.data(), indices.size()));
    // A triangle may come back with another of its corners first.
    const std::string back = decoded(packed, indices.size(), 4, "TRIANGLES", "NONE");
    for (std::size_t i = 0; i < indices.size(); i += 3) {
      std::uint32_t t[3];
      std::memcpy(t, back.data() + 4 * i, sizeof t);
      const std::uint32_t* const e = &indices[i];
      const auto turned = [&](int k) {
        return t[0] == e[k] && t[1] == e[(k + 1) % 3] && t[2] == e[(k + 2) % 3];
      };
      EXPECT_TRUE(turned(0) || turned(1) || turned(2));
    }
  }
}

TEST(GltfMeshopt, every_filter_comes_back) {
  std::mt19937 rng(62);
  std::normal_distribution<float> normal;
  const std::size_t count = 100;
  std::vector<float> vectors;
  for (std::size_t i = 0; i < count; ++i) {
    glm::vec4 q(normal(rng), normal(rng), normal(rng), normal(rng));
    q = glm::normalize(q);
    vectors.insert(vectors.end(), {q.x, q.y, q.z, q.w});
  }
  std::string packed(8 * count, '\0');

  meshopt_encodeFilterQuat(packed.data(), count, 8, 16, vectors.data());
  std::string back =
      decoded(encoded_vertices(packed, count, 8), count, 8, "ATTRIBUTES", "QUATERNION");
  for (std::size_t i = 0; i < count; ++i) {
    std::int16_t q[4];
    std::memcpy(q, back.data() + 8 * i, sizeof q);
    double dot = 0;
    for (int c = 0; c < 4; ++c) dot += q[c] / 32767.0 * vectors[4 * i + c];
    EXPECT_NEAR(std::abs(dot), 1.0, 1e-4);  // 16 bits; a quaternion and its negative are the same
  }

  for (std::size_t i = 0; i < count; ++i) {
    glm::vec3 n = glm::normalize(glm::vec3(vectors[4 * i], vectors[4 * i + 1], vectors[4 * i + 2]));
    for (int c = 0; c < 3; ++c) vectors[4 * i + c] = n[c];
  }
  meshopt_encodeFilterOct(packed.data(), count, 8, 16, vectors.data());
  back = decoded(encoded_vertices(packed, count, 8), count, 8, "ATTRIBUTES", "OCTAHEDRAL");
  for (std::size_t i = 0; i < count; ++i) {
    std::int16_t n[4];
    std::memcpy(n, back.data() + 8 * i, sizeof n);
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(n[c] / 32767.0, vectors[4 * i + c], 1e-3);
  }

  std::string wide(16 * count, '\0');
  meshopt_encodeFilterExp(wide.data(), count, 16, 24, vectors.data());
  back = decoded(encoded_vertices(wide, count, 16), count, 16, "ATTRIBUTES", "EXPONENTIAL");
  for (std::size_t i = 0; i < 4 * count; ++i) {
    float f;
    std::memcpy(&f, back.data() + 4 * i, sizeof f);
    EXPECT_NEAR(f, vectors[i], 1e-6);  // 24 bits of a number up to 1, one exponent a vector
  }
}

TEST(GltfMeshopt, khronos_name_of_the_extension_means_the_same) {
  const std::string raw = "abcdefghijkl";
  EXPECT_EQ(
      decoded(encoded_vertices(raw, 3, 4), 3, 4, "ATTRIBUTES", "NONE", "KHR_meshopt_compression"),
      raw);
}

TEST(GltfMeshopt, what_the_decoder_would_not_survive_is_refused) {
  const auto why = [](std::size_t count, std::size_t stride, const char* mode, const char* filter) {
    try {
      return decoded("xxxx", count, stride, mode, filter);
    } catch (const LoadError& fault) {
      // Behind "bufferViews[0].extensions.EXT_meshopt_compression" and its dot or space.
      const std::size_t path = fault.reason.find("compression");
      return path == std::string::npos ? fault.reason : fault.reason.substr(path + 12);
    }
  };
  EXPECT_EQ(why(3, 3, "ATTRIBUTES", "NONE"), "byteStride is not a multiple of 4 up to 256");
  EXPECT_EQ(why(3, 260, "ATTRIBUTES", "NONE"), "byteStride is not a multiple of 4 up to 256");
  EXPECT_EQ(why(4, 4, "TRIANGLES", "NONE"), "count is not divisible by 3");
  EXPECT_EQ(why(3, 8, "INDICES", "NONE"), "byteStride is neither 2 nor 4");
  EXPECT_EQ(why(3, 12, "ATTRIBUTES", "OCTAHEDRAL"),
            "byteStride of octahedral vectors is neither 4 nor 8");
  EXPECT_EQ(why(3, 4, "ATTRIBUTES", "QUATERNION"), "byteStride of quaternions is not 8");
  EXPECT_EQ(why(3, 4, "ATTRIBUTES", "NONE"), "cannot be decompressed: the stream is damaged");
  EXPECT_NE(why(std::size_t(1) << 40, 4, "ATTRIBUTES", "NONE").find("more memory than 64 MiB"),
            std::string::npos);
}

TEST(GltfDraco, a_mesh_comes_back_within_its_quantisation) {
  std::mt19937 rng(63);
  std::uniform_real_distribution<float> u(-1, 1);
  const int faces = 50;
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(faces);
  const int position =
      builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int color = builder.AddAttribute(draco::GeometryAttribute::COLOR, 4, draco::DT_UINT8);
  std::vector<std::array<glm::vec3, 3>> corners(faces);
  std::vector<std::array<std::uint8_t, 4>> colors(faces);
  for (int f = 0; f < faces; ++f) {
    for (glm::vec3& c : corners[f]) c = {u(rng), u(rng), u(rng)};
    for (std::uint8_t& c : colors[f]) c = std::uint8_t(rng());
    builder.SetAttributeValuesForFace(position, draco::FaceIndex(f), &corners[f][0], &corners[f][1],
                                      &corners[f][2]);
    builder.SetAttributeValuesForFace(color, draco::FaceIndex(f), &colors[f], &colors[f],
                                      &colors[f]);
  }
  const std::unique_ptr<draco::Mesh> mesh = builder.Finalize();
  draco::Encoder encoder;
  encoder.SetAttributeQuantization(draco::GeometryAttribute::POSITION, 16);
  draco::EncoderBuffer packed;
  ASSERT_TRUE(encoder.EncodeMeshToBuffer(*mesh, &packed).ok());

  GltfBuilder b;
  const int view = b.view(std::string(packed.data(), packed.size()));
  const nlohmann::json count = mesh->num_points();
  const int p = b.accessor({{"componentType", 5126}, {"count", count}, {"type", "VEC3"}});
  const int c = b.accessor(
      {{"componentType", 5121}, {"count", count}, {"type", "VEC4"}, {"normalized", true}});
  b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", p}, {"COLOR_0", c}}},
                           {"extensions",
                            {{"KHR_draco_mesh_compression",
                              {{"bufferView", view},
                               {"attributes",
                                {{"POSITION", mesh->attribute(position)->unique_id()},
                                 {"COLOR_0", mesh->attribute(color)->unique_id()}}}}}}}})}});
  const std::string file = b.glb();
  const Result<LoadedScene> loaded = load_scene(bytes_of(file), "draco.glb");
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  const Mesh& out = loaded->scene.meshes[0];
  ASSERT_EQ(out.triangles(), std::uint64_t(faces));
  // The coder may put faces in another order: each must be there once, with its colour. 16 bits
  // over an extent of 2: 1.5e-5 a coordinate, doubled.
  for (int f = 0; f < faces; ++f) {
    int found = 0;
    for (std::size_t i = 0; i < out.indices.size(); i += 3)
      for (int turn = 0; turn < 3; ++turn) {
        bool same = true;
        for (int k = 0; k < 3; ++k) {
          const std::uint32_t v = out.indices[i + (k + turn) % 3];
          same = same && glm::length(out.positions[v] - corners[f][k]) < 6e-5f;
          for (int n = 0; n < 4; ++n)
            same = same && std::abs(out.colors[v][n] - colors[f][n] / 255.0f) < 1e-6f;
        }
        found += same;
      }
    EXPECT_EQ(found, 1) << f;
  }
}

// A few bytes that announce 2^28 faces, or 255 kinds of seams over 2^20 faces: refused before the
// decoder allocates them.
TEST(GltfDraco, what_a_stream_announces_is_held_against_the_budget) {
  const auto why = [](const std::string& numbers) {
    GltfBuilder b = test::triangle();
    const std::string head("DRACO\2\2\1\1\0\0\0", 12);
    nlohmann::json& primitive = b.json["meshes"][0]["primitives"][0];
    primitive["extensions"]["KHR_draco_mesh_compression"] = {{"bufferView", b.view(head + numbers)},
                                                             {"attributes", {{"POSITION", 0}}}};
    LoadOptions options;
    options.max_bytes = 1u << 30;
    const std::string file = b.glb();
    return load_scene(bytes_of(file), "draco.glb", options).error().reason;
  };
  EXPECT_NE(why("\3\xFF\xFF\xFF\x7F").find("more memory than 64 MiB"), std::string::npos);
  EXPECT_NE(why("\3\xFF\xFF\x3F\xFF").find("more memory than 64 MiB"), std::string::npos);
  EXPECT_EQ(why("\3\1").find("more memory"), std::string::npos);
}

}  // namespace
}  // namespace rilievo::gltf
