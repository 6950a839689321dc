// What is saved and loaded again, against what it was.
#include "rilievo/scene/files/save_glb.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <cstring>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <nlohmann/json.hpp>
#include <random>

#include "rilievo/core/file.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/scene/files/load_scene.h"

namespace rilievo {
namespace {

Scene saved_and_loaded(const Scene& scene, const TemporaryFolder& folder) {
  const Result<> saved = save_glb(scene, folder / "scene.glb");
  EXPECT_TRUE(saved.ok()) << saved.error().message();
  Result<LoadedScene> loaded = load_scene(folder / "scene.glb");
  EXPECT_TRUE(loaded.ok()) << loaded.error().message();
  if (!loaded) return {};
  for (const std::string& warning : loaded->warnings) ADD_FAILURE() << warning;
  return std::move(loaded->scene);
}

struct SavedCorner {
  glm::vec3 position, normal;
  glm::vec4 color, tangent;
  glm::vec2 uv[2];
};

// Where every corner of every triangle is at `time`, for objects in the order of their centres: all
// that is drawn, whatever objects and meshes it is made of.
std::vector<SavedCorner> corners_of(const Scene& scene, double time) {
  std::vector<glm::mat4> world_from_model;
  pose(scene, time, world_from_model);
  std::vector<std::vector<SavedCorner>> objects;
  for (std::size_t i = 0; i < scene.objects.size(); ++i) {
    std::vector<SavedCorner> corners;
    for (const Part& part : scene.models[scene.objects[i].model].parts) {
      const Mesh& m = scene.meshes[part.mesh];
      const glm::mat4 world = world_from_model[i] * part.model_from_mesh;
      const glm::mat3 normals = glm::transpose(glm::inverse(glm::mat3(world)));
      const bool mirrored = glm::determinant(glm::mat3(world)) < 0;
      for (std::size_t k = 0; k < m.indices.size(); ++k) {
        // Seen from outside, corners run counter-clockwise, whichever way the mesh is placed.
        const std::size_t at = mirrored && k % 3 ? k + (k % 3 == 1 ? 1 : -1) : k;
        const std::uint32_t v = m.indices[at];
        SavedCorner c{};
        c.position = glm::vec3(world * glm::vec4(m.positions[v], 1));
        c.normal = glm::normalize(normals * m.normals[v]);
        if (!m.colors.empty()) c.color = m.colors[v];
        if (!m.tangents.empty())
          c.tangent = glm::vec4(glm::normalize(glm::mat3(world) * glm::vec3(m.tangents[v])),
                                mirrored ? -m.tangents[v].w : m.tangents[v].w);
        for (int set = 0; set < 2; ++set)
          if (!m.uv[set].empty()) c.uv[set] = m.uv[set][v];
        corners.push_back(c);
      }
    }
    objects.push_back(std::move(corners));
  }
  std::stable_sort(objects.begin(), objects.end(), [](const auto& a, const auto& b) {
    // Rounded: matrices come back with a few bits of noise, and equal centres must stay equal.
    const auto key = [](const std::vector<SavedCorner>& corners) {
      glm::dvec3 sum(0.0);
      for (const SavedCorner& c : corners) sum += glm::dvec3(c.position);
      const glm::dvec3 mean =
          glm::round(sum / double(std::max<std::size_t>(1, corners.size())) * 1e2);
      return std::array{double(corners.size()), mean.x, mean.y, mean.z};
    };
    return key(a) < key(b);
  });
  std::vector<SavedCorner> all;
  for (const auto& corners : objects) all.insert(all.end(), corners.begin(), corners.end());
  return all;
}

// `tolerance` in metres.
void expect_same_geometry(const Scene& a, const Scene& b, double time, float tolerance) {
  const std::vector<SavedCorner> x = corners_of(a, time), y = corners_of(b, time);
  ASSERT_EQ(x.size(), y.size());
  float position = 0, direction = 0, rest = 0;
  for (std::size_t i = 0; i < x.size(); ++i) {
    position = std::max(position, glm::distance(x[i].position, y[i].position));
    direction = std::max({direction, glm::distance(x[i].normal, y[i].normal),
                          glm::distance(x[i].tangent, y[i].tangent)});
    rest = std::max({rest, glm::distance(x[i].color, y[i].color),
                     glm::distance(x[i].uv[0], y[i].uv[0]), glm::distance(x[i].uv[1], y[i].uv[1])});
  }
  EXPECT_LE(position, tolerance);
  // 1e-3: loading makes normals unit again, and rotations are rebuilt from quaternions.
  EXPECT_LE(direction, 1e-3f);
  EXPECT_EQ(rest, 0.0f);
}

Mesh random_mesh(std::mt19937& rng, int triangles) {
  std::uniform_real_distribution<float> u(-1, 1);
  Mesh mesh;
  const auto vec = [&] { return glm::vec3(u(rng), u(rng), u(rng)); };
  for (int i = 0; i < 2 * triangles; ++i) {
    mesh.positions.push_back(vec());
    mesh.normals.push_back(glm::normalize(vec() + 1e-3f));
    mesh.tangents.push_back(glm::vec4(glm::normalize(vec() + 1e-3f), i % 2 ? 1 : -1));
    mesh.uv[0].push_back(vec());
    mesh.uv[1].push_back(vec());
    mesh.colors.push_back(glm::abs(glm::vec4(vec(), u(rng))));
  }
  // Every vertex is used, in this order first: loading keeps what is used.
  for (std::uint32_t i = 0; i < std::uint32_t(2 * triangles); ++i) mesh.indices.push_back(i);
  for (int i = 0; i < triangles; ++i) mesh.indices.push_back(rng() % mesh.positions.size());
  return mesh;
}

// A chain of three nodes, the last with an object, moved by curves of every kind.
void add_animation(Scene& scene, std::mt19937& rng) {
  std::uniform_real_distribution<float> u(-1, 1);
  for (int i = 0; i < 3; ++i) {
    Node node;
    node.parent = i - 1;
    node.translation = {u(rng), u(rng), u(rng)};
    node.rotation = glm::normalize(glm::quat(u(rng), u(rng), u(rng), 1.0f));
    node.scale = glm::vec3(1.0f + 0.2f * float(i));
    scene.nodes.push_back(node);
    Channel channel;
    channel.node = i;
    channel.path = Channel::Path(i);
    channel.interpolation = Channel::Interpolation((i + 2) % 3);
    const bool cubic = channel.interpolation == Channel::Interpolation::cubic_spline;
    for (int k = 0; k < 5; ++k) {
      channel.times.push_back(0.3f * float(k) + 0.1f);
      for (int v = 0; v < (cubic ? 3 : 1); ++v)
        channel.values.push_back(i == 1 ? glm::normalize(glm::vec4(u(rng), u(rng), u(rng), 1.5f))
                                 : i == 2
                                     ? glm::vec4(1.5f + u(rng), 1.5f, 1.5f, 0) * (v == 1 ? 1 : 0.1f)
                                     : glm::vec4(u(rng), u(rng), u(rng), 0));
    }
    // A rotation by splines has tangents that are no unit vectors: any numbers will do.
    scene.channels.push_back(channel);
  }
  scene.duration = 2;  // the curves end before it
}

Scene random_scene(std::mt19937& rng) {
  std::uniform_real_distribution<float> u(-1, 1);
  Scene scene;
  for (int i = 0; i < 3; ++i) scene.meshes.push_back(random_mesh(rng, 2 + int(rng() % 20) * 2));
  Model plain, moved;
  plain.name = "plain", moved.name = "moved";
  plain.parts = {{0, glm::mat4(1)}, {1, glm::mat4(1)}};
  const glm::mat4 mirror = glm::scale(
      glm::rotate(glm::translate(glm::mat4(1), {0.3f, 1, 2}), 0.7f, {0, 1, 0}), {-1, 2, 0.5f});
  moved.parts = {{2, mirror}, {0, glm::mat4(1)}};
  scene.models = {plain, moved};
  for (int i = 0; i < 6; ++i) {
    Object object;
    object.name = "object " + std::to_string(i);
    object.model = i % 2;
    object.placement = glm::translate(glm::mat4(1), {float(i) * 5, u(rng), u(rng)});
    object.placement = glm::rotate(object.placement, u(rng), glm::vec3(0.6f, 0.8f, 0));
    object.placement = glm::scale(object.placement, glm::vec3(i == 3 ? -1.5f : 1.5f, 1, 1));
    scene.objects.push_back(object);
  }
  add_animation(scene, rng);
  scene.objects[4].node = 2;
  scene.objects[5].node = 1;
  finish(scene);
  return scene;
}

TEST(SaveGlb, geometry_and_poses_over_time_come_back) {
  std::mt19937 rng(1);
  for (int i = 0; i < 20; ++i) {
    const TemporaryFolder folder;
    const Scene scene = random_scene(rng);
    const Scene loaded = saved_and_loaded(scene, folder);
    EXPECT_EQ(count_triangles(loaded), count_triangles(scene));
    EXPECT_EQ(loaded.duration, scene.duration);
    for (const double time : {0.0, 0.25, 0.7, 1.31, 1.9})
      // 1e-4 m: rounding of matrices of floats, over a scene of 30 m and a chain of three nodes.
      expect_same_geometry(scene, loaded, time, 1e-4f);
  }
}

// glTF wants matrices that are a translation, a rotation and a scale.
void expect_no_shear(const std::string& glb) {
  std::uint32_t length = 0;
  std::memcpy(&length, glb.data() + 12, sizeof length);
  const nlohmann::json json = nlohmann::json::parse(glb.substr(20, length));
  for (const nlohmann::json& node : json.at("nodes")) {
    if (!node.contains("matrix")) continue;
    const auto column = [&](int c) {
      const nlohmann::json& m = node.at("matrix");
      return glm::normalize(glm::vec3(m.at(4 * c), m.at(4 * c + 1), m.at(4 * c + 2)));
    };
    for (int c = 0; c < 3; ++c)
      // 1e-4: rounding of floats, as in expect_same_geometry().
      EXPECT_NEAR(glm::dot(column(c), column((c + 1) % 3)), 0, 1e-4) << node.dump();
  }
}

TEST(SaveGlb, sheared_objects_come_back_from_nodes_without_shear) {
  std::mt19937 rng(8);
  std::uniform_real_distribution<float> u(-1, 1);
  for (int i = 0; i < 20; ++i) {
    const TemporaryFolder folder;
    Scene scene = random_scene(rng);
    for (Object& object : scene.objects) {
      glm::mat4 shear(1);
      shear[1][0] = u(rng), shear[2][0] = u(rng), shear[2][1] = u(rng);
      object.placement = object.placement * shear;
    }
    const Scene loaded = saved_and_loaded(scene, folder);
    for (const double time : {0.0, 0.7}) expect_same_geometry(scene, loaded, time, 1e-4f);
    expect_no_shear(*read_file(folder / "scene.glb", 1 << 28));
  }
}

TEST(SaveGlb, the_built_in_scenes_come_back) {
  for (const char* name : {"bridge", "teapots", "forest"}) {
    const TemporaryFolder folder;
    const Scene scene = make_builtin(std::string("builtin:") + name + "?triangles=150000")->scene;
    const Scene loaded = saved_and_loaded(scene, folder);
    EXPECT_EQ(loaded.objects.size(), scene.objects.size());
    EXPECT_EQ(loaded.materials.size(), scene.materials.size());
    for (const double time : {0.0, 3.3}) expect_same_geometry(scene, loaded, time, 1e-4f);
  }
}

TEST(SaveGlb, a_forest_is_a_small_file) {
  const TemporaryFolder folder;
  const Scene scene = make_builtin("builtin:forest?triangles=10000000")->scene;
  const Scene loaded = saved_and_loaded(scene, folder);
  EXPECT_EQ(count_triangles(loaded), 0u + count_triangles(scene));
  ASSERT_EQ(loaded.objects.size(), scene.objects.size());
  EXPECT_LT(std::filesystem::file_size(folder / "scene.glb"), 3'000'000u);
  // Every tree stands where it stood: 1e-3 m over a forest of 700 m is rounding of floats.
  const auto feet = [](const Scene& s) {
    std::vector<std::array<float, 3>> out;
    for (const Object& object : s.objects)
      out.push_back({object.placement[3].x, object.placement[3].y, object.placement[3].z});
    std::sort(out.begin(), out.end());
    return out;
  };
  const auto a = feet(scene), b = feet(loaded);
  for (std::size_t i = 0; i < a.size(); ++i)
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(a[i][k], b[i][k], 1e-3f);
}

TEST(SaveGlb, materials_and_textures_come_back) {
  const TemporaryFolder folder;
  std::mt19937 rng(2);
  Scene scene;
  for (int i = 0; i < 2; ++i) {
    Texture texture;
    texture.name = "texture " + std::to_string(i);
    texture.image = i;
    for (glm::u8vec4& t : scene.images.emplace_back(7, 3 + i).texels())
      t = glm::u8vec4(rng(), rng(), rng(), i ? 255 : rng());
    texture.wrap_u = i ? Wrap::clamp_to_edge : Wrap::mirrored_repeat;
    texture.nearest = i;
    scene.textures.push_back(std::move(texture));
  }
  Material m;
  m.name = "all";
  m.base_color = {0.1f, 0.2f, 0.3f, 0.4f};
  m.metallic = 0.7f, m.roughness = 0.35f, m.emissive = {2, 3, 0.5f};
  m.normal_scale = 0.5f, m.occlusion_strength = 0.25f;
  m.alpha_mode = AlphaMode::mask, m.alpha_cutoff = 0.3f, m.double_sided = true;
  glm::mat3 transform(1);
  transform[0] = {2 * std::cos(0.4f), -2 * std::sin(0.4f), 0};
  transform[1] = {-3 * std::sin(0.4f), -3 * std::cos(0.4f), 0};
  transform[2] = {0.25f, -4, 1};
  m.base_color_texture = {0, 1, transform};
  m.metallic_roughness_texture = {1, 0, glm::mat3(1)};
  m.normal_texture = {1, 0, glm::mat3(1)};
  m.occlusion_texture = {0, 0, glm::mat3(1)};
  m.emissive_texture = {1, 1, glm::mat3(1)};
  Material unlit;
  unlit.name = "unlit", unlit.unlit = true, unlit.alpha_mode = AlphaMode::blend;
  scene.materials = {m, unlit};
  Model model;
  for (int i = 0; i < 3; ++i) {
    scene.meshes.push_back(random_mesh(rng, 2));
    scene.meshes.back().material = i < 2 ? i : -1;
    model.parts.push_back({i, glm::mat4(1)});
  }
  scene.models = {model};
  scene.objects.resize(1);
  finish(scene);

  const Scene loaded = saved_and_loaded(scene, folder);
  ASSERT_EQ(loaded.materials.size(), 3u);
  const Material &a = loaded.materials[0], &b = loaded.materials[1], &plain = loaded.materials[2];
  EXPECT_EQ(a.name, m.name);
  EXPECT_EQ(a.base_color, m.base_color);
  EXPECT_EQ(a.metallic, m.metallic);
  EXPECT_EQ(a.roughness, m.roughness);
  // 1e-6: a factor times a strength.
  EXPECT_LT(glm::distance(a.emissive, m.emissive), 1e-6f);
  EXPECT_EQ(a.normal_scale, m.normal_scale);
  EXPECT_EQ(a.occlusion_strength, m.occlusion_strength);
  EXPECT_EQ(a.alpha_mode, m.alpha_mode);
  EXPECT_EQ(a.alpha_cutoff, m.alpha_cutoff);
  EXPECT_TRUE(a.double_sided);
  EXPECT_FALSE(a.unlit);
  EXPECT_TRUE(b.unlit);
  EXPECT_FALSE(b.double_sided);
  EXPECT_EQ(b.alpha_mode, AlphaMode::blend);
  EXPECT_EQ(plain.metallic, Material{}.metallic);
  EXPECT_EQ(plain.roughness, Material{}.roughness);
  const auto same_texture = [&](const TextureUse& x, const TextureUse& y) {
    ASSERT_GE(x.texture, 0);
    const Texture &p = loaded.textures[x.texture], &q = scene.textures[y.texture];
    EXPECT_TRUE(loaded.images[p.image] == scene.images[q.image]);
    EXPECT_EQ(p.wrap_u, q.wrap_u);
    EXPECT_EQ(p.wrap_v, q.wrap_v);
    EXPECT_EQ(p.nearest, q.nearest);
    EXPECT_EQ(x.uv_set, y.uv_set);
    for (int c = 0; c < 3; ++c)
      EXPECT_LT(glm::distance(x.texture_from_uv[c], y.texture_from_uv[c]), 1e-5f);
  };
  same_texture(a.base_color_texture, m.base_color_texture);
  same_texture(a.metallic_roughness_texture, m.metallic_roughness_texture);
  same_texture(a.normal_texture, m.normal_texture);
  same_texture(a.occlusion_texture, m.occlusion_texture);
  same_texture(a.emissive_texture, m.emissive_texture);
}

TEST(SaveGlb, lights_and_cameras_come_back) {
  const TemporaryFolder folder;
  std::mt19937 rng(3);
  Scene scene = random_scene(rng);
  Light sun = default_sun(), spot, point;
  sun.direction = {0, -1, 0};  // straight down, where "up" is no help
  spot.kind = Light::Kind::spot, point.kind = Light::Kind::point;
  spot.direction = glm::normalize(glm::vec3(1, -2, 0.5f)), spot.position = {3, 9, 1};
  spot.inner_cone = 0.2f, spot.outer_cone = 0.6f, spot.range = 30;
  spot.intensity = {40, 20, 10};
  point.position = {-4, 6, 2}, point.intensity = {5, 50, 25};
  scene.lights = {sun, spot, point};
  Camera parallel = look_at({3, 2, 9}, {0, 0, 0}, {0, 1, 0}, 0.8, 1280, 720, 0.1, 90),
         off = parallel;
  parallel.projection = Projection::parallel;
  off.window.left *= 2;
  scene.cameras = {look_at({3, 2, 9}, {0, 1, 0}, {0, 1, 0}, 0.8, 1280, 720, 0.1, 90), parallel,
                   off};

  const Scene loaded = saved_and_loaded(scene, folder);
  ASSERT_EQ(loaded.lights.size(), 3u);
  // Loading scales all lights by one factor.
  const float factor = loaded.lights[0].intensity.x / sun.intensity.x;
  for (std::size_t i = 0; i < 3; ++i) {
    const Light &a = loaded.lights[i], &b = scene.lights[i];
    EXPECT_EQ(a.kind, b.kind);
    EXPECT_LT(glm::distance(a.direction, b.direction), 1e-5f);
    EXPECT_LT(glm::distance(a.position, b.position), 1e-5f);
    EXPECT_LT(glm::distance(a.intensity, factor * b.intensity), 1e-4f * glm::length(a.intensity));
    EXPECT_EQ(a.range, b.range);
  }
  EXPECT_EQ(loaded.lights[1].inner_cone, spot.inner_cone);
  EXPECT_EQ(loaded.lights[1].outer_cone, spot.outer_cone);

  ASSERT_EQ(loaded.cameras.size(), 2u);  // the third is off its axis
  for (std::size_t i = 0; i < 2; ++i) {
    const Camera &a = loaded.cameras[i], &b = scene.cameras[i];
    EXPECT_EQ(a.projection, b.projection);
    EXPECT_LT(glm::length(a.position() - b.position()), 1e-6);
    EXPECT_LT(glm::length(a.forward() - b.forward()), 1e-6);
    EXPECT_NEAR(a.window.top, b.window.top, 1e-6);
    EXPECT_NEAR(a.window.right, b.window.right, 1e-6);
    EXPECT_NEAR(a.z_near, b.z_near, 1e-6);
    EXPECT_NEAR(a.z_far, b.z_far, 1e-6);
  }
}

TEST(SaveGlb, the_same_scene_makes_the_same_bytes) {
  const TemporaryFolder folder;
  const Scene scene = make_builtin("builtin:bridge?triangles=100000")->scene;
  ASSERT_TRUE(save_glb(scene, folder / "a").ok());
  ASSERT_TRUE(save_glb(scene, folder / "b").ok());
  EXPECT_EQ(*read_file(folder / "a", 1 << 28), *read_file(folder / "b", 1 << 28));
}

TEST(SaveGlb, what_is_no_scene_is_not_written) {
  const TemporaryFolder folder;
  std::mt19937 rng(4);
  Scene scene = random_scene(rng);
  scene.meshes[0].positions[1].y = std::numeric_limits<float>::quiet_NaN();
  const Result<> saved = save_glb(scene, folder / "x.glb");
  ASSERT_FALSE(saved.ok());
  EXPECT_NE(saved.error().message().find("x.glb"), std::string::npos);
  EXPECT_FALSE(std::filesystem::exists(folder / "x.glb"));
  EXPECT_FALSE(save_glb(random_scene(rng), folder / "no" / "x.glb").ok());
}

// Every model that loads can be saved, and is the same again.
TEST(SaveGlb, models_of_others_come_back) {
  const char* const data = std::getenv("RILIEVO_DATA");
  if (!data) GTEST_SKIP() << "RILIEVO_DATA is not set";
  int saved = 0;
  for (const auto& entry :
       std::filesystem::recursive_directory_iterator(std::filesystem::path(data) / "models")) {
    const std::string extension = entry.path().extension().string();
    if (extension != ".glb" && extension != ".gltf") continue;
    const Result<LoadedScene> loaded = load_scene(entry.path());
    if (!loaded) continue;
    SCOPED_TRACE(entry.path());
    const TemporaryFolder folder;
    const Scene again = saved_and_loaded(loaded->scene, folder);
    ASSERT_EQ(count_triangles(again), count_triangles(loaded->scene));
    for (const double time : {0.0, 0.4}) {
      const Box a = world_bounds(loaded->scene, time), b = world_bounds(again, time);
      const float reach = 1e-4f * (a.radius() + glm::length(a.center()));
      EXPECT_LE(glm::distance(a.min, b.min), reach);
      EXPECT_LE(glm::distance(a.max, b.max), reach);
    }
    ++saved;
  }
  EXPECT_GT(saved, 0);
}

}  // namespace
}  // namespace rilievo
