#include "rilievo/scene/bend.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <random>
#include <string>
#include <vector>

#include "rilievo/scene/files/load_scene.h"
#include "rilievo/scene/gltf/gltf_test_helpers.h"

namespace rilievo {
namespace {

using test::GltfBuilder;

struct Numbers {
  std::mt19937 rng;
  float operator()(float low, float high) {
    return std::uniform_real_distribution<float>(low, high)(rng);
  }
  std::vector<float> several(std::size_t n, float low, float high) {
    std::vector<float> out(n);
    for (float& v : out) v = (*this)(low, high);
    return out;
  }
  std::vector<float> turn() {
    // One after the other, for the same order with every compiler.
    glm::vec4 q;
    q.w = (*this)(0.5f, 1);
    for (const int i : {2, 1, 0}) q[i] = (*this)(-1, 1);
    q /= glm::length(q);
    return {q.x, q.y, q.z, q.w};
  }
};

// A chain of joints that turn, move and grow, a mesh on it whose two targets come and go, and a
// mesh with targets alone on a node that moves. `normals`: does the file have any? `longer`: than a
// second and a half, by this factor; 0: all keys are at 0, and nothing moves.
std::string bent_file(unsigned seed, bool normals, float longer = 1, bool animated = true) {
  Numbers any{std::mt19937(seed)};
  const std::size_t vertices = 30, joints = 2 + seed % 3, keys = 3;
  GltfBuilder b;
  nlohmann::json samplers = nlohmann::json::array(), channels = nlohmann::json::array();
  const auto animate = [&](int node, const char* path, const char* type, std::size_t numbers,
                           bool cubic, auto&& value) {
    std::vector<float> times{0.0f, any(0.3f, 0.7f), any(0.9f, 1.5f)}, values;
    for (float& time : times) time *= longer;
    for (std::size_t k = 0; k < keys * (cubic ? 3 : 1); ++k) {
      const std::vector<float> one =
          cubic && k % 3 != 1 ? any.several(numbers, -0.3f, 0.3f) : value();
      values.insert(values.end(), one.begin(), one.end());
    }
    samplers.push_back({{"input", b.floats(times, "SCALAR")},
                        {"output", b.floats(values, type)},
                        {"interpolation", cubic ? "CUBICSPLINE" : "LINEAR"}});
    channels.push_back(
        {{"sampler", samplers.size() - 1}, {"target", {{"node", node}, {"path", path}}}});
  };
  const auto mesh = [&](bool skinned) {
    nlohmann::json attributes = {{"POSITION", b.floats(any.several(3 * vertices, -1, 1), "VEC3")}};
    if (normals) attributes["NORMAL"] = b.floats(any.several(3 * vertices, 0.2f, 1), "VEC3");
    if (skinned) {
      std::vector<std::uint8_t> influence;
      for (std::size_t i = 0; i < 4 * vertices; ++i)
        influence.push_back(std::uint8_t(any.rng() % joints));
      // Not all add up to one.
      attributes["JOINTS_0"] = b.packed(influence, "VEC4", 5121);
      attributes["WEIGHTS_0"] = b.floats(any.several(4 * vertices, 0.1f, 0.5f), "VEC4");
    }
    nlohmann::json targets = nlohmann::json::array();
    for (int t = 0; t < 2; ++t)
      targets.push_back({{"POSITION", b.floats(any.several(3 * vertices, -0.5f, 0.5f), "VEC3")}});
    return b.mesh({{"attributes", attributes}, {"targets", targets}});
  };
  const int skinned = b.node({{"mesh", mesh(true)}, {"skin", 0}});
  const int plain = b.node({{"mesh", mesh(false)}, {"translation", {3, 0, 0}}});
  nlohmann::json skin;
  for (std::size_t j = 0; j < joints; ++j) {
    const int node =
        b.node({{"translation", any.several(3, -0.6f, 0.6f)}, {"rotation", any.turn()}});
    if (j > 0) b.json["nodes"][std::size_t(node - 1)]["children"] = nlohmann::json::array({node});
    skin["joints"].push_back(node);
    animate(node, "rotation", "VEC4", 4, false, [&] { return any.turn(); });
    if (j % 2)
      animate(node, "translation", "VEC3", 3, true, [&] { return any.several(3, -0.6f, 0.6f); });
    else
      animate(node, "scale", "VEC3", 3, false, [&] { return any.several(3, 0.7f, 1.3f); });
  }
  std::vector<float> bind;
  for (std::size_t j = 0; j < joints; ++j) {
    // Not mirrored: that is decided once, when a file is loaded.
    std::vector<float> m = any.several(16, -0.2f, 0.2f);
    m[0] += 1, m[5] += 1, m[10] += 1;
    m[3] = m[7] = m[11] = 0, m[15] = 1;
    bind.insert(bind.end(), m.begin(), m.end());
  }
  skin["inverseBindMatrices"] = b.floats(bind, "MAT4");
  b.json["skins"] = nlohmann::json::array({skin});
  for (const int node : {skinned, plain})
    animate(node, "weights", "SCALAR", 2, node == plain, [&] { return any.several(2, 0, 1); });
  animate(plain, "translation", "VEC3", 3, false, [&] { return any.several(3, 2, 4); });
  if (animated) b.json["animations"] = {{{"samplers", samplers}, {"channels", channels}}};
  return b.glb();
}

Result<LoadedScene> load_bent(const std::string& file, double time, bool deformations) {
  LoadOptions options;
  options.time = time, options.deformations = deformations;
  return load_scene({reinterpret_cast<const std::uint8_t*>(file.data()), file.size()}, "test.glb",
                    options);
}

// `relative`: to the size of the meshes.
void expect_same_meshes(const Scene& a, const Scene& b, float relative, const std::string& what) {
  ASSERT_EQ(a.meshes.size(), b.meshes.size());
  for (std::size_t m = 0; m < a.meshes.size(); ++m) {
    const Mesh &one = a.meshes[m], &two = b.meshes[m];
    ASSERT_EQ(one.positions.size(), two.positions.size()) << what;
    ASSERT_EQ(one.normals.size(), two.normals.size()) << what;
    ASSERT_EQ(one.tangents.size(), two.tangents.size()) << what;
    ASSERT_EQ(one.indices, two.indices) << what;
    const float size = two.bounds.radius();
    for (std::size_t i = 0; i < one.positions.size(); ++i) {
      ASSERT_LT(glm::length(one.positions[i] - two.positions[i]), relative * size) << what;
      // Normals of small faces turn with the rounding of their corners.
      ASSERT_GT(glm::dot(one.normals[i], two.normals[i]), 0.99f) << what << ' ' << m << ' ' << i;
    }
    EXPECT_LT(glm::length(one.bounds.min - two.bounds.min), relative * size) << what;
    EXPECT_LT(glm::length(one.bounds.max - two.bounds.max), relative * size) << what;
  }
}

// The slow twin: the file, read again for each time.
TEST(Bend, meshes_are_what_the_file_has_at_that_time) {
  std::mt19937 rng(7);
  for (unsigned seed = 0; seed < 12; ++seed) {
    const std::string file = bent_file(seed, seed % 2 == 0);
    const Result<LoadedScene> kept = load_bent(file, 0.4, true);
    ASSERT_TRUE(kept.ok()) << kept.error().message();
    ASSERT_EQ(kept->deformations.meshes.size(), 2u);
    for (int k = 0; k < 6; ++k) {
      const double time = std::uniform_real_distribution<double>(-1, 4)(rng);
      const Result<LoadedScene> again = load_bent(file, time, false);
      ASSERT_TRUE(again.ok());
      EXPECT_TRUE(again->deformations.meshes.empty());
      // The nodes' matrices are floats.
      expect_same_meshes(pose_at(kept->scene, kept->deformations, time), again->scene, 2e-5f,
                         std::to_string(seed));
    }
  }
}

TEST(Bend, the_animations_of_real_files_too) {
  const char* data = std::getenv("RILIEVO_DATA");
  if (!data) GTEST_SKIP() << "RILIEVO_DATA names no folder";
  for (const char* name :
       {"models/Fox.glb", "models/morph-stress-test.glb", "models/quaternius/animated/Stag.glb"}) {
    const std::filesystem::path path = std::filesystem::path(data) / name;
    if (!std::filesystem::exists(path)) continue;
    LoadOptions options;
    options.deformations = true;
    const Result<LoadedScene> kept = load_scene(path, options);
    ASSERT_TRUE(kept.ok());
    EXPECT_FALSE(kept->deformations.meshes.empty()) << name;
    EXPECT_GT(kept->deformations.rig.duration, 0) << name;
    for (const double time : {0.0, 0.31, 0.77, 1.9}) {
      LoadOptions at;
      at.time = time;
      const Result<LoadedScene> again = load_scene(path, at);
      ASSERT_TRUE(again.ok());
      expect_same_meshes(pose_at(kept->scene, kept->deformations, time), again->scene, 2e-5f, name);
    }
  }
}

TEST(Bend, no_vertex_is_faster_or_farther_than_its_bound) {
  std::mt19937 rng(8);
  for (unsigned seed = 0; seed < 12; ++seed) {
    const Result<LoadedScene> kept = load_bent(bent_file(seed, true), 0, true);
    ASSERT_TRUE(kept.ok());
    const Scene& scene = kept->scene;
    const std::vector<DeformationBounds> all = deformation_bounds(scene, kept->deformations);
    for (std::uint32_t object = 0; object < 2; ++object) {
      const auto model = std::size_t(scene.objects[object].model);
      const DeformationBounds& bounds = all[model];
      const auto mesh = std::size_t(scene.models[model].parts[0].mesh);
      double fastest = 0;
      for (int k = 0; k < 60; ++k) {
        const double from = std::uniform_real_distribution<double>(0, 3)(rng);
        const double step = std::pow(10.0, std::uniform_real_distribution<double>(-3, 0)(rng));
        const double again =
            std::floor((from + step) / bounds.period) - std::floor(from / bounds.period);
        const Scene a = pose_at(scene, kept->deformations, from),
                    b = pose_at(scene, kept->deformations, from + step);
        for (std::size_t i = 0; i < a.meshes[mesh].positions.size(); ++i) {
          const glm::vec3 p = a.meshes[mesh].positions[i], q = b.meshes[mesh].positions[i];
          const double moved = glm::length(glm::dvec3(p) - glm::dvec3(q));
          // 1e-5: positions are floats.
          ASSERT_LE(moved, bounds.speed * step + bounds.jump * again + 1e-5) << seed;
          if (again == 0) fastest = std::max(fastest, moved / step);
          for (int c = 0; c < 3; ++c) {
            ASSERT_GE(p[c], bounds.bounds.min[c] - 1e-5f);
            ASSERT_LE(p[c], bounds.bounds.max[c] + 1e-5f);
          }
        }
      }
      // All joints of a chain are at their fastest at once, and all lengths at their longest.
      EXPECT_LT(bounds.speed, 30 * fastest) << seed;
      EXPECT_GT(bounds.speed, 0);
    }
  }
}

// Of an hour they are bounded, and of 10^30 seconds nothing is kept: no bound would mean anything.
TEST(Bend, keys_may_be_far_apart) {
  const Result<LoadedScene> slow = load_bent(bent_file(1, true, 3600), 0, true);
  ASSERT_TRUE(slow.ok());
  const DeformationBounds bounds = deformation_bounds(
      slow->scene, slow->deformations)[std::size_t(slow->scene.objects[0].model)];
  EXPECT_GT(bounds.speed, 0);
  EXPECT_LT(bounds.speed, 1);  // metres a second: a few in half an hour, and all joints at once
  const Result<LoadedScene> ages = load_bent(bent_file(1, true, 1e30f), 0, true);
  ASSERT_TRUE(ages.ok());
  EXPECT_TRUE(ages->deformations.meshes.empty());
  EXPECT_FALSE(ages->warnings.empty());
  for (const DeformationBounds& of : deformation_bounds(ages->scene, ages->deformations))
    EXPECT_EQ(of.speed, 0);
}

// Methods that cannot bend draw them, as they draw any still object.
TEST(Bend, skins_that_no_animation_moves_are_still_objects_in_their_pose) {
  const std::string files[] = {bent_file(2, true, 1, false), bent_file(2, true, 0)};
  for (const std::string& file : files) {
    const Result<LoadedScene> kept = load_bent(file, 0.4, true);
    const Result<LoadedScene> posed = load_bent(file, 0.9, false);
    ASSERT_TRUE(kept.ok() && posed.ok());
    EXPECT_TRUE(kept->deformations.meshes.empty());
    EXPECT_TRUE(kept->deformations.rig.nodes.empty());
    ASSERT_EQ(kept->scene.meshes.size(), posed->scene.meshes.size());
    for (std::size_t m = 0; m < posed->scene.meshes.size(); ++m)
      EXPECT_EQ(kept->scene.meshes[m].positions, posed->scene.meshes[m].positions);
  }
}

TEST(Bend, what_has_no_deformations_stays_as_it_is) {
  const Result<LoadedScene> loaded = load_bent(bent_file(1, true), 0.2, false);
  ASSERT_TRUE(loaded.ok());
  EXPECT_EQ(pose_at(loaded->scene, loaded->deformations, 0.9).meshes[0].positions,
            loaded->scene.meshes[0].positions);
  for (const DeformationBounds& of : deformation_bounds(loaded->scene, loaded->deformations))
    EXPECT_EQ(of.speed, 0);
}

}  // namespace
}  // namespace rilievo
