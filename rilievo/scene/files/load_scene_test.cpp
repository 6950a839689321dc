#include "rilievo/scene/files/load_scene.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>
#include <random>

#include "rilievo/core/file.h"
#include "rilievo/scene/gltf/gltf_test_helpers.h"

namespace rilievo {
namespace {

namespace fs = std::filesystem;
using test::GltfBuilder;

Result<LoadedScene> load_bytes(const std::string& bytes, const std::string& name = "test.glb",
                               LoadOptions options = {}) {
  return load_scene({reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()}, name,
                    options);
}

// What reason_of_bytes() makes of a refusal because a file costs far more than it holds.
constexpr char kTooMuch[] = "too much for its bytes";

std::string reason_of_bytes(const std::string& bytes, const std::string& name = "test.glb",
                            LoadOptions options = {}) {
  const Result<LoadedScene> loaded = load_bytes(bytes, name, options);
  if (loaded.ok()) return "ok";
  const std::string& reason_of_bytes = loaded.error().reason;
  const bool too_much =
      reason_of_bytes.starts_with("would take more memory than 64 MiB + 32 times its ") &&
      reason_of_bytes.find("--memory-limit-mb") != std::string::npos;
  return too_much ? kTooMuch : reason_of_bytes;
}

TEST(LoadScene, a_triangle) {
  const Result<LoadedScene> loaded = load_bytes(test::triangle().glb());
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  const Scene& scene = loaded->scene;
  EXPECT_EQ(loaded->warnings.size(), 0u);
  EXPECT_EQ(count_triangles(scene), 1u);
  ASSERT_EQ(scene.meshes[0].normals.size(), 3u);
  EXPECT_EQ(scene.meshes[0].normals[0], glm::vec3(0, 0, 1));
  EXPECT_EQ(world_bounds(scene).max, glm::vec3(1, 1, 0));
  EXPECT_EQ(scene.name, "test");
}

TEST(LoadScene, says_what_a_file_is_instead) {
  EXPECT_EQ(reason_of_bytes(""), "is empty");
  EXPECT_EQ(reason_of_bytes("\x89PNG\r\n", "a.gltf"), "is a PNG picture, not a scene");
  EXPECT_EQ(reason_of_bytes("solid", "a.glb"), "is not a .glb file: it does not begin with 'glTF'");
  EXPECT_EQ(reason_of_bytes("hello", "a.txt"),
            "is of no kind that can be read (.gltf, .glb, .obj, .ply, .stl)");
  EXPECT_EQ(reason_of_bytes("{}", "a"), "is JSON, but not a glTF document: it has no 'asset'");
  EXPECT_EQ(reason_of_bytes("hello", "a.ply"), "is not a PLY file: it does not begin with 'ply'");
  EXPECT_EQ(reason_of_bytes(std::string("v 1 2\0 3", 8), "a.obj"),
            "is not an OBJ file: it holds binary data");
  EXPECT_EQ(reason_of_bytes("glTF\1\0\0\0\0\0\0\0", "a.glb"),
            "is cut short: a .glb file has a header of 12 bytes");
  EXPECT_EQ(reason_of_bytes(std::string("glTF\1\0\0\0\x0C\0\0\0", 12), "a.glb"),
            "is glTF 1.0; only 2.0 can be read");
  EXPECT_EQ(reason_of_bytes("# nothing\n", "a.obj"),
            "is not an OBJ file: it has no statement of one");
  EXPECT_EQ(reason_of_bytes("v 0 0 0\n", "a.obj"), "has all that it shows in one point");
  EXPECT_EQ(reason_of_bytes("vn 0 0 1\ns 1\n", "a.obj"),
            "has no triangles, lines or points to draw");
}

TEST(LoadScene, a_missing_file_is_named) {
  const Result<LoadedScene> loaded = load_scene("/nowhere/there.glb");
  ASSERT_FALSE(loaded.ok());
  EXPECT_EQ(loaded.error().message(), "/nowhere/there.glb: No such file or directory");
}

TEST(LoadScene, what_is_required_and_unsupported_is_an_error_what_is_used_a_warning) {
  GltfBuilder b = test::triangle();
  b.json["extensionsUsed"] = {"KHR_materials_sheen", "KHR_texture_transform"};
  const Result<LoadedScene> loaded = load_bytes(b.glb());
  ASSERT_TRUE(loaded.ok());
  ASSERT_EQ(loaded->warnings.size(), 1u);
  EXPECT_EQ(loaded->warnings[0], "the extension KHR_materials_sheen is not supported and left out");
  b.json["extensionsRequired"] = {"EXT_unheard_of"};
  EXPECT_EQ(reason_of_bytes(b.glb()),
            "requires the extension EXT_unheard_of, which is not supported");
}

TEST(LoadScene, hostile_numbers_end_in_errors) {
  const auto damaged = [](auto&& damage) {
    GltfBuilder b = test::triangle();
    damage(b.json);
    return reason_of_bytes(b.glb());
  };
  using nlohmann::json;
  EXPECT_EQ(damaged([](json& j) { j["accessors"][0]["count"] = 4; }),
            "accessors[0] reaches behind the end of bufferViews[0]");
  EXPECT_EQ(damaged([](json& j) { j["accessors"][0]["byteOffset"] = 1; }),
            "accessors[0] reaches behind the end of bufferViews[0]");
  EXPECT_EQ(damaged([](json& j) { j["accessors"][0]["byteOffset"] = 9007199254740992; }),
            "accessors[0] reaches behind the end of bufferViews[0]");
  EXPECT_EQ(damaged([](json& j) { j["accessors"][0]["count"] = 4294967295; }), kTooMuch);
  EXPECT_EQ(damaged([](json& j) {
              j["accessors"][0].erase("bufferView"), j["accessors"][0]["count"] = 4294967295;
            }),
            kTooMuch);
  EXPECT_EQ(damaged([](json& j) { j["bufferViews"][0]["byteLength"] = 1000; }),
            "bufferViews[0] reaches behind the end of buffers[0]");
  EXPECT_EQ(damaged([](json& j) { j["bufferViews"][0]["byteOffset"] = -1; }),
            "bufferViews[0].byteOffset must be a whole number");
  EXPECT_EQ(damaged([](json& j) { j["nodes"][0]["mesh"] = 7; }),
            "nodes[0].mesh refers to 7, but there is only one");
  EXPECT_EQ(damaged([](json& j) { j["nodes"][0]["skin"] = 0; }),
            "nodes[0].skin refers to 0, but there are none");
  EXPECT_EQ(damaged([](json& j) { j["asset"]["version"] = ""; }),
            "does not say which glTF it is: asset.version is empty; 2.0 can be read");
  EXPECT_EQ(damaged([](json& j) { j["nodes"][0]["children"] = {0}; }),
            "has nodes that are their own ancestors");
  EXPECT_EQ(damaged([](json& j) {
              j["nodes"][0]["scale"] = {1, 2};
            }),
            "nodes[0].scale must have 3 numbers");
  EXPECT_EQ(damaged([](json& j) {
              j["nodes"][0]["scale"] = {0, 0, 0};
            }),
            "has all that it shows in one point");
}

TEST(LoadScene, positions_that_are_not_finite_are_refused) {
  GltfBuilder b;
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const int positions = b.floats({0, 0, 0, 1, 0, 0, 0, nan, 0}, "VEC3");
  b.node({{"mesh", b.mesh({{"attributes", {{"POSITION", positions}}}})}});
  EXPECT_EQ(reason_of_bytes(b.glb()),
            "meshes[0].primitives[0] has a vertex whose position is not finite");
}

TEST(LoadScene, memory_is_bounded) {
  // 10^6 instances of one triangle: 100 MB of objects out of 50 bytes.
  GltfBuilder b = test::triangle();
  const int instances = b.accessor({{"componentType", 5126}, {"count", 1000000}, {"type", "VEC3"}});
  b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["TRANSLATION"] =
      instances;
  EXPECT_EQ(reason_of_bytes(b.glb()), kTooMuch);
  // 10^4 of them cost little.
  b.json["accessors"].back()["count"] = 10000;
  EXPECT_EQ(reason_of_bytes(b.glb()), "ok");
  EXPECT_EQ(reason_of_bytes(b.glb(), "a.glb", {0.0, 1u << 20}),
            "needs more memory than the 1 MiB that --memory-limit-mb allows");
}

// An animation of 10^8 keys, all of them zero.
TEST(LoadScene, keys_that_no_byte_stands_for_are_not_worth_a_gigabyte) {
  GltfBuilder b = test::triangle();
  const auto keys = [&](const char* type) {
    return b.accessor({{"componentType", 5126}, {"count", 100000000}, {"type", type}});
  };
  const int times = keys("SCALAR"), values = keys("VEC3");
  b.json["animations"] = {
      {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}},
       {"samplers", {{{"input", times}, {"output", values}}}}}};
  EXPECT_EQ(reason_of_bytes(b.glb()), kTooMuch);
}

// What a document of JSON takes, against what is allowed for it: a bracket is worth a hundred
// bytes.
TEST(LoadScene, brackets_are_counted_before_they_are_parsed) {
  const std::string deep = "{\"asset\": " + std::string(1 << 20, '[');
  EXPECT_EQ(reason_of_bytes(deep, "a.gltf"), kTooMuch);
  const std::string flat = "{\"asset\": {}, \"a\": \"" + std::string(1 << 20, '[') + "\"}";
  EXPECT_EQ(reason_of_bytes(flat, "a.gltf"), "asset.version is missing");
}

// Bytes changed at random, and cut: an Error or a valid scene, never anything else.
TEST(LoadScene, damaged_bytes_never_do_harm) {
  GltfBuilder b = test::triangle();
  b.json["nodes"][0]["children"] = {1};
  b.node({{"mesh", 0}, {"rotation", {0, 0, 0, 1}}});
  b.json["animations"] = {
      {{"samplers",
        {{{"input", b.floats({0, 1}, "SCALAR")},
          {"output", b.floats({0, 0, 0, 1, 1, 1}, "VEC3")}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
  const std::string good = b.glb();
  ASSERT_EQ(reason_of_bytes(good), "ok");
  std::mt19937 rng(21);
  int loaded = 0;
  for (int i = 0; i < 3000; ++i) {
    std::string bad = good;
    for (unsigned k = 0; k < 1 + rng() % 4; ++k) bad[rng() % bad.size()] = char(rng());
    if (i % 5 == 0) bad.resize(rng() % bad.size());
    const Result<LoadedScene> scene = load_bytes(bad, "a.glb", {0.5, 256u << 20});
    if (!scene) continue;
    ++loaded;
    EXPECT_TRUE(validate(scene->scene).ok());
  }
  EXPECT_GT(loaded, 0);
}

class Data : public testing::TestWithParam<const char*> {};

// Everything under a folder of RILIEVO_DATA loads, or says in one line why it does not.
TEST_P(Data, loads_or_says_why_not) {
  const char* const data = std::getenv("RILIEVO_DATA");
  if (!data) GTEST_SKIP() << "RILIEVO_DATA is not set";
  const fs::path folder = fs::path(data) / GetParam();
  const bool must_load = std::string(GetParam()) == "models";
  int files = 0;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(folder)) {
    std::string extension = entry.path().extension().string();
    const bool scene = extension == ".glb" || extension == ".gltf" || extension == ".obj" ||
                       extension == ".ply" || extension == ".stl";
    if (!entry.is_regular_file() || (must_load && !scene)) continue;
    ++files;
    const Result<LoadedScene> loaded = load_scene(entry.path());
    if (!loaded) {
      EXPECT_FALSE(loaded.error().reason.empty());
      EXPECT_EQ(loaded.error().reason.find('\n'), std::string::npos) << loaded.error().message();
      const bool allowed =
          !must_load || loaded.error().reason.find("KHR_texture_basisu") != std::string::npos;
      EXPECT_TRUE(allowed) << loaded.error().message();
      continue;
    }
    EXPECT_TRUE(validate(loaded->scene).ok()) << entry.path();
    EXPECT_GT(count_triangles(loaded->scene), 0u) << entry.path();
    for (const Mesh& mesh : loaded->scene.meshes)
      if (mesh.primitive == Primitive::triangles) {
        EXPECT_EQ(mesh.normals.size(), mesh.positions.size()) << entry.path();
      }
  }
  EXPECT_GT(files, 0);
}

INSTANTIATE_TEST_SUITE_P(Folders, Data,
                         testing::Values("models", "odd_valid", "obj", "ply", "invalid"));

}  // namespace
}  // namespace rilievo
