#include <gtest/gtest.h>

#include <algorithm>
#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <numbers>
#include <random>

#include "rilievo/scene/files/load_scene.h"
#include "rilievo/scene/gltf/gltf_test_helpers.h"

namespace rilievo {
namespace {

using test::GltfBuilder;

Result<LoadedScene> load_glb(const GltfBuilder& b) {
  const std::string file = b.glb();
  return load_scene({reinterpret_cast<const std::uint8_t*>(file.data()), file.size()}, "test.glb");
}

float largest_difference(const glm::dmat4& a, const glm::mat4& b) {
  double largest = 0;
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r) largest = std::max(largest, std::abs(a[c][r] - double(b[c][r])));
  return float(largest);
}

// Random trees of nodes, half of them with matrices (sheared, mirrored, flattened), some animated:
// every object stands where the product of its ancestors' matrices puts it.
TEST(GltfRead, objects_stand_where_their_ancestors_put_them) {
  std::mt19937 rng(51);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int round = 0; round < 300; ++round) {
    GltfBuilder b = test::triangle();
    b.json["nodes"].clear();
    const int nodes = 1 + int(rng() % 7);
    std::vector<int> parent(nodes, -1);
    std::vector<glm::dmat4> local(nodes), end(nodes);
    std::vector<char> animated(nodes, 0);
    nlohmann::json channels, samplers;
    for (int i = 0; i < nodes; ++i) {
      nlohmann::json node = {{"mesh", 0}, {"name", "node " + std::to_string(i)}};
      if (i > 0) parent[i] = int(rng() % (i + 1)) - 1;
      if (rng() % 2) {
        glm::dmat4 m(1.0);
        for (int c = 0; c < 4; ++c)
          for (int r = 0; r < 3; ++r) m[c][r] = u(rng);
        if (rng() % 8 == 0) m[rng() % 3] = glm::dvec4(0);  // flattened
        for (int k = 0; k < 16; ++k) node["matrix"].push_back(m[k / 4][k % 4]);
        local[i] = end[i] = m;
      } else {
        const glm::dvec3 t(u(rng), u(rng), u(rng)), s(u(rng), u(rng), u(rng));
        const glm::dquat q = glm::normalize(glm::dquat(1 + u(rng), u(rng), u(rng), u(rng)));
        node["translation"] = {t.x, t.y, t.z};
        node["rotation"] = {q.x, q.y, q.z, q.w};
        node["scale"] = {s.x, s.y, s.z};
        const glm::dmat4 rest = glm::mat4_cast(q) * glm::scale(glm::dmat4(1.0), s);
        local[i] = end[i] = glm::translate(glm::dmat4(1.0), t) * rest;
        if (rng() % 2) {
          // Two seconds from here to there.
          const glm::dvec3 there(u(rng), u(rng), u(rng));
          animated[i] = 1;
          end[i] = glm::translate(glm::dmat4(1.0), 0.5 * (t + there)) * rest;
          const int input = b.floats({0, 2}, "SCALAR");
          const int output = b.floats(
              {float(t.x), float(t.y), float(t.z), float(there.x), float(there.y), float(there.z)},
              "VEC3");
          channels.push_back(
              {{"sampler", samplers.size()}, {"target", {{"node", i}, {"path", "translation"}}}});
          samplers.push_back({{"input", input}, {"output", output}});
        }
      }
      b.node(node);
      if (parent[i] >= 0) b.json["nodes"][parent[i]]["children"].push_back(i);
    }
    if (!channels.empty())
      b.json["animations"] = {{{"channels", channels}, {"samplers", samplers}}};

    const Result<LoadedScene> loaded = load_glb(b);
    if (!loaded.ok()) {
      EXPECT_EQ(loaded.error().reason, "has all that it shows in one point");
      continue;
    }
    const Scene& scene = loaded->scene;
    ASSERT_EQ(scene.objects.size(), std::size_t(nodes));
    EXPECT_EQ(scene.models.size(), 1u);  // one mesh, shared
    std::vector<glm::mat4> start, middle;
    pose(scene, 0.0, start);
    pose(scene, 1.0, middle);
    for (std::size_t k = 0; k < scene.objects.size(); ++k) {
      const int node = std::stoi(scene.objects[k].name.substr(5));
      glm::dmat4 at_start(1.0), at_middle(1.0);
      bool moves = false;
      for (int i = node; i >= 0; i = parent[i]) {
        at_start = local[i] * at_start, at_middle = end[i] * at_middle;
        moves = moves || animated[i];
      }
      // Floats through up to 7 matrices (14 where sheared ones are split) with entries up to 3.
      EXPECT_LT(largest_difference(at_start, start[k]), 3e-5f) << round;
      EXPECT_LT(largest_difference(at_middle, middle[k]), 3e-5f) << round;
      EXPECT_EQ(scene.objects[k].moving, moves);
      EXPECT_EQ(scene.objects[k].node >= 0, moves);
    }
  }
}

TEST(GltfRead, every_instance_is_an_object) {
  GltfBuilder b = test::triangle();
  nlohmann::json& attributes =
      b.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"];
  attributes["TRANSLATION"] = b.floats({1, 2, 3, 4, 5, 6}, "VEC3");
  attributes["SCALE"] = b.floats({1, 1, 1, 2, 2, 2}, "VEC3");
  // A quarter turn about z in normalised 16-bit integers.
  attributes["ROTATION"] =
      b.packed(std::vector<std::int16_t>{0, 0, 0, 32767, 0, 0, 23170, 23170}, "VEC4", 5122, true);
  b.json["nodes"][0]["translation"] = {10, 0, 0};
  const Result<LoadedScene> loaded = load_glb(b);
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  const Scene& scene = loaded->scene;
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_EQ(scene.models.size(), 1u);
  EXPECT_EQ(glm::vec3(scene.objects[0].placement[3]), glm::vec3(11, 2, 3));
  const glm::vec3 x(scene.objects[1].placement * glm::vec4(1, 0, 0, 1));
  EXPECT_LT(glm::length(x - glm::vec3(14, 7, 6)), 1e-4f);  // 23170 / 32767 is 0.70711
}

TEST(GltfRead, only_the_default_scene_is_shown) {
  GltfBuilder b = test::triangle();
  b.node({{"mesh", 0}, {"name", "child"}});
  b.node({{"mesh", 0}, {"name", "other"}});
  b.json["nodes"][0]["name"] = "root";
  b.json["nodes"][0]["children"] = {1};
  const auto names = [&] {
    const Result<LoadedScene> loaded = load_glb(b);
    std::string all;
    for (const Object& object : loaded->scene.objects) all += object.name + " ";
    return all;
  };
  EXPECT_EQ(names(), "root other child ");
  b.json["scenes"] = {{{"nodes", {2}}}, {{"nodes", {0}}}};
  EXPECT_EQ(names(), "other ");
  b.json["scene"] = 1;
  EXPECT_EQ(names(), "root child ");
}

TEST(GltfRead, materials_and_texture_transforms) {
  GltfBuilder b = test::triangle();
  // A PNG of one red texel.
  b.json["images"] = {
      {{"uri",
        "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAYAAAAfFcSJAAAADUlEQVR4nGP4z8DwHwAF"
        "AAH/iZk9HQAAAABJRU5ErkJggg=="}}};
  b.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
  b.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
  b.json["materials"] = {{{"pbrMetallicRoughness",
                           {{"baseColorFactor", {0.5, 0.25, 1, 0.75}},
                            {"metallicFactor", 0.5},
                            {"roughnessFactor", 0.125},
                            {"baseColorTexture",
                             {{"index", 0},
                              {"texCoord", 1},
                              {"extensions",
                               {{"KHR_texture_transform",
                                 {{"offset", {0.5, 0.25}},
                                  {"scale", {2, 3}},
                                  {"rotation", std::numbers::pi / 2}}}}}}}}},
                          {"alphaMode", "MASK"},
                          {"alphaCutoff", 0.25},
                          {"doubleSided", true},
                          {"emissiveFactor", {1, 0.5, 0}},
                          {"extensions",
                           {{"KHR_materials_unlit", nlohmann::json::object()},
                            {"KHR_materials_emissive_strength", {{"emissiveStrength", 4}}}}}}};
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  const Result<LoadedScene> loaded = load_glb(b);
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  EXPECT_EQ(loaded->warnings.size(), 0u);
  const Scene& scene = loaded->scene;
  const Material& m = scene.materials[scene.meshes[0].material];
  EXPECT_EQ(m.base_color, glm::vec4(0.5f, 0.25f, 1, 0.75f));
  EXPECT_EQ(m.metallic, 0.5f);
  EXPECT_EQ(m.roughness, 0.125f);
  EXPECT_EQ(m.alpha_mode, AlphaMode::mask);
  EXPECT_EQ(m.alpha_cutoff, 0.25f);
  EXPECT_TRUE(m.double_sided);
  EXPECT_TRUE(m.unlit);
  EXPECT_EQ(m.emissive, glm::vec3(4, 2, 0));
  EXPECT_EQ(m.base_color_texture.uv_set, 1);
  // Scaled to (2, 3), turned counter-clockwise on a picture whose v grows downwards, moved.
  const glm::vec3 uv = m.base_color_texture.texture_from_uv * glm::vec3(1, 1, 1);
  EXPECT_NEAR(uv.x, 3 + 0.5, 1e-6);
  EXPECT_NEAR(uv.y, -2 + 0.25, 1e-6);
  ASSERT_EQ(scene.textures.size(), 1u);
  const Texture& t = scene.textures[0];
  EXPECT_EQ(scene.images.at(std::size_t(t.image))(0, 0), glm::u8vec4(255, 0, 0, 255));
  EXPECT_EQ(t.wrap_u, Wrap::clamp_to_edge);
  EXPECT_EQ(t.wrap_v, Wrap::mirrored_repeat);
  EXPECT_TRUE(t.nearest);
}

TEST(GltfRead, glass_is_blended_and_keeps_what_a_ray_tracer_needs) {
  GltfBuilder b = test::triangle();
  b.json["materials"] = {{{"extensions",
                           {{"KHR_materials_transmission", {{"transmissionFactor", 0.5}}},
                            {"KHR_materials_ior", {{"ior", 1.25}}},
                            {"KHR_materials_volume", {{"thicknessFactor", 0.1}}}}}}};
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  const Result<LoadedScene> loaded = load_glb(b);
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  const Material& m = loaded->scene.materials[0];
  EXPECT_EQ(m.alpha_mode, AlphaMode::blend);
  EXPECT_FLOAT_EQ(m.base_color.a, 0.55f);
  EXPECT_EQ(m.transmission, 0.5f);
  EXPECT_EQ(m.ior, 1.25f);
  EXPECT_TRUE(m.refracts);
}

TEST(GltfRead, a_picture_that_cannot_be_read_is_left_out) {
  GltfBuilder b = test::triangle();
  b.json["images"] = {{{"uri", "data:image/png;base64,AAAA"}}};
  b.json["textures"] = {{{"source", 0}}};
  b.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  b.json["meshes"][0]["primitives"][0]["material"] = 0;
  const Result<LoadedScene> loaded = load_glb(b);
  ASSERT_TRUE(loaded.ok());
  ASSERT_EQ(loaded->warnings.size(), 1u);
  EXPECT_EQ(loaded->warnings[0].find("images[0] is left out: "), 0u) << loaded->warnings[0];
  EXPECT_EQ(loaded->scene.materials[0].base_color_texture.texture, -1);
}

// The second image is known by its URI, and must not be taken for the first of the scene.
TEST(GltfRead, a_picture_that_cannot_be_read_is_left_out_for_all_its_images) {
  GltfBuilder b = test::triangle();
  nlohmann::json each = b.json["meshes"][0]["primitives"][0];
  for (int i = 0; i < 2; ++i) {
    b.json["images"].push_back({{"uri", "data:image/png;base64"}});  // without a comma
    b.json["textures"].push_back({{"source", i}});
    b.json["materials"].push_back(
        {{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", i}}}}}});
    each["material"] = i;
    b.json["meshes"][0]["primitives"].push_back(each);
  }
  const Result<LoadedScene> loaded = load_glb(b);
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  EXPECT_EQ(loaded->scene.textures.size(), 0u);
  for (const Material& m : loaded->scene.materials) EXPECT_EQ(m.base_color_texture.texture, -1);
}

TEST(GltfRead, lights_keep_their_proportions_and_light_like_the_default_sun) {
  GltfBuilder b = test::triangle();
  b.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "directional"}, {"intensity", 5000}, {"color", {1, 1, 1}}},
      {{"type", "directional"}, {"intensity", 15000}, {"color", {1, 1, 1}}}};
  for (int i = 0; i < 2; ++i)
    b.node({{"extensions", {{"KHR_lights_punctual", {{"light", i}}}}},
            {"rotation", {-std::numbers::sqrt2 / 2, 0, 0, std::numbers::sqrt2 / 2}}});
  const Result<LoadedScene> loaded = load_glb(b);
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  const std::vector<Light>& lights = loaded->scene.lights;
  ASSERT_EQ(lights.size(), 2u);
  // -z turned by -90 degrees about x points down.
  EXPECT_LT(glm::length(lights[0].direction - glm::vec3(0, -1, 0)), 1e-6f);
  EXPECT_NEAR(lights[1].intensity.g / lights[0].intensity.g, 3.0f, 1e-5f);
  const glm::vec3 sun = default_sun().intensity;
  const float total = lights[0].intensity.g + lights[1].intensity.g;
  EXPECT_NEAR(total, 0.2126f * sun.r + 0.7152f * sun.g + 0.0722f * sun.b, 1e-5f);
}

TEST(GltfRead, cameras_see_what_the_file_says) {
  GltfBuilder b = test::triangle();
  b.json["cameras"] = {
      {{"type", "perspective"},
       {"perspective", {{"yfov", std::numbers::pi / 2}, {"aspectRatio", 2}, {"znear", 0.5}}}},
      {{"type", "orthographic"},
       {"orthographic", {{"xmag", 3}, {"ymag", 1.5}, {"znear", 0}, {"zfar", 8}}}}};
  b.node({{"camera", 0}, {"translation", {1, 2, 3}}, {"scale", {5, 5, 5}}});
  b.node({{"camera", 1}});
  const Result<LoadedScene> loaded = load_glb(b);
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  ASSERT_EQ(loaded->scene.cameras.size(), 2u);
  const Camera& eye = loaded->scene.cameras[0];
  EXPECT_EQ(eye.position(), glm::dvec3(1, 2, 3));
  EXPECT_EQ(eye.forward(), glm::dvec3(0, 0, -1));
  EXPECT_NEAR(eye.window.top, 1, 1e-12);
  EXPECT_NEAR(eye.window.right, 2, 1e-12);
  EXPECT_EQ(eye.width, 2 * eye.height);
  const Camera& parallel = loaded->scene.cameras[1];
  EXPECT_EQ(parallel.projection, Projection::parallel);
  // It began at its eye; ours begins a little before, and ends in the same place.
  EXPECT_NEAR(parallel.position().z - parallel.z_far, -8, 1e-12);
  EXPECT_NEAR(parallel.position().z - parallel.z_near, 0, 1e-12);
}

TEST(GltfRead, a_camera_whose_window_is_empty_is_left_out) {
  GltfBuilder b = test::triangle();
  b.json["cameras"] = {{{"type", "orthographic"},
                        {"orthographic", {{"xmag", 0}, {"ymag", 0}, {"znear", 1}, {"zfar", 8}}}}};
  b.node({{"camera", 0}});
  const Result<LoadedScene> loaded = load_glb(b);
  ASSERT_TRUE(loaded.ok()) << loaded.error().message();
  EXPECT_EQ(loaded->scene.cameras.size(), 0u);
  const std::vector<std::string> expected = {"cameras[0] is left out: the image window is empty"};
  EXPECT_EQ(loaded->warnings, expected);
}

}  // namespace
}  // namespace rilievo
