// Scenes that each show one thing about shading, so that every renderer can be held against the
// others, feature by feature.
#pragma once

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <random>
#include <string>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

struct ShadingScene {
  std::string name;
  Scene scene;
  Camera camera;
};

// Soft blobs of colour, so that a texel's neighbours resemble it, and so do all levels.
inline Rgba8Image blob_texture(unsigned seed, int width, int height) {
  std::mt19937 rng(seed);
  std::uniform_real_distribution<float> u(0, 1);
  Rgba8Image texture(width, height);
  glm::vec4 phase[3];
  for (glm::vec4& p : phase) p = glm::two_pi<float>() * glm::vec4(u(rng), u(rng), u(rng), u(rng));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x)
      for (int k = 0; k < 4; ++k) {
        // Periodic, so that it may be repeated.
        const float a = glm::two_pi<float>() * (float(x) + 0.5f) / float(width);
        const float b = glm::two_pi<float>() * (float(y) + 0.5f) / float(height);
        const float v = std::sin(a + phase[0][k]) + std::sin(b + phase[1][k]) +
                        std::sin(2 * a - b + phase[2][k]);
        texture(x, y)[k] = std::uint8_t(std::lround(127.5f + 40.0f * v));
      }
  return texture;
}

// A tangent-space normal map of gentle bumps.
inline Rgba8Image bump_texture(int size) {
  Rgba8Image texture(size, size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const float a = 2 * glm::two_pi<float>() * (float(x) + 0.5f) / float(size);
      const float b = glm::two_pi<float>() * (float(y) + 0.5f) / float(size);
      const glm::vec3 n =
          glm::normalize(glm::vec3(0.5f * std::sin(a), 0.35f * std::cos(b) * std::sin(a), 1));
      texture(x, y) = glm::u8vec4(glm::round(127.5f * (n + 1.0f)), 255);
    }
  return texture;
}

// Leaves: alpha that is nearly all in or out, in blobs larger than texels.
inline Rgba8Image leaf_texture(int size) {
  Rgba8Image texture = blob_texture(5, size, size);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x) {
      const float cx = 4 * (float(x) + 0.5f) / float(size),
                  cy = 4 * (float(y) + 0.5f) / float(size);
      const float r = std::hypot(cx - std::floor(cx) - 0.5f, cy - std::floor(cy) - 0.5f);
      texture(x, y).a =
          std::uint8_t(std::lround(255 * glm::clamp(0.5f + 12 * (0.38f - r), 0.0f, 1.0f)));
    }
  return texture;
}

// A square of two metres that faces +z; v of its texture grows downwards.
inline Mesh square_mesh() {
  Mesh mesh;
  mesh.positions = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}};
  mesh.normals.assign(4, {0, 0, 1});
  mesh.uv[0] = {{0, 1}, {1, 1}, {1, 0}, {0, 0}};
  mesh.uv[1] = {{0.2f, 2.1f}, {1.7f, 1.9f}, {1.5f, 0.1f}, {0.1f, 0.3f}};
  mesh.indices = {0, 1, 2, 0, 2, 3};
  mesh.material = 0;
  return mesh;
}

inline Mesh sphere_mesh(int rings = 32) {
  Mesh mesh;
  const int around = 2 * rings;
  for (int y = 0; y <= rings; ++y)
    for (int x = 0; x <= around; ++x) {
      const float u = float(x) / float(around), v = float(y) / float(rings);
      const float a = glm::two_pi<float>() * u, b = glm::pi<float>() * v;
      const glm::vec3 n(std::sin(b) * std::sin(a), std::cos(b), std::sin(b) * std::cos(a));
      mesh.positions.push_back(n);
      mesh.normals.push_back(n);
      mesh.uv[0].push_back({2 * u, v});
      mesh.uv[1].push_back({1 - u, 3 * v});
    }
  for (int y = 0; y < rings; ++y)
    for (int x = 0; x < around; ++x) {
      const auto a = std::uint32_t(y * (around + 1) + x), b = a + 1,
                 c = a + std::uint32_t(around) + 1, d = c + 1;
      if (y > 0) mesh.indices.insert(mesh.indices.end(), {a, c, b});
      if (y < rings - 1) mesh.indices.insert(mesh.indices.end(), {b, c, d});
    }
  mesh.material = 0;
  return mesh;
}

// The mesh, with one material, turned a little, as a 96 x 96 camera sees it.
inline ShadingScene shading_scene(std::string name, Mesh mesh, const Material& material) {
  ShadingScene out;
  out.name = std::move(name);
  Scene& scene = out.scene;
  scene.name = out.name;
  scene.materials = {material};
  scene.meshes = {std::move(mesh)};
  scene.models.resize(1);
  scene.models[0].parts = {Part{}};
  scene.objects.resize(1);
  scene.objects[0].placement = glm::rotate(glm::mat4(1), 0.5f, glm::vec3(0.3f, 0.9f, 0.1f));
  Light sun;
  sun.direction = glm::normalize(glm::vec3(-0.4f, -0.7f, -0.6f));
  sun.intensity = {2.2f, 2.0f, 1.7f};
  scene.lights = {sun};
  out.camera = look_at({0.4, 0.5, 3.6}, {0, 0, 0}, {0, 1, 0}, 0.62, 96, 96, 0.5, 20);
  return out;
}

inline std::vector<ShadingScene> shading_scenes() {
  std::vector<ShadingScene> scenes;
  const auto add = [&](const std::string& name, const Material& material, auto&& change) {
    // What textures do shows on a square, what light does on a sphere; some on both.
    const bool both = name == "base texture" || name == "normal map" || name == "masked leaves" ||
                      name.starts_with("normals that");
    const bool flat = name.starts_with("wrap") || name.starts_with("second") ||
                      name.starts_with("texture") || name.starts_with("base texture of");
    for (const bool round : {false, true}) {
      if (!both && round == flat) continue;
      ShadingScene made = shading_scene(name + (round ? " on a sphere" : " on a square"),
                                        round ? sphere_mesh() : square_mesh(), material);
      made.scene.images = {blob_texture(1, 32, 32), blob_texture(2, 24, 40), bump_texture(64),
                           leaf_texture(128), blob_texture(3, 512, 512)};
      made.scene.textures.resize(made.scene.images.size());
      for (std::size_t i = 0; i < made.scene.images.size(); ++i)
        made.scene.textures[i].image = int(i);
      change(made.scene);
      // As OpenGL's vertices keep them, so that all renderers shade the same normals.
      for (glm::vec3& n : made.scene.meshes[0].normals) n = glm::round(511.0f * n) / 511.0f;
      finish(made.scene);
      scenes.push_back(std::move(made));
    }
  };
  const auto nothing = [](Scene&) {};
  Material plain;
  plain.base_color = {0.7f, 0.5f, 0.4f, 1};
  plain.roughness = 0.6f;
  add("plain", plain, nothing);
  Material m = plain;
  m.metallic = 0.8f, m.roughness = 0.35f;
  add("metal", m, nothing);
  m = plain, m.unlit = true;
  add("unlit", m, nothing);
  // A few bytes a texel: samples beside a triangle's edge are shaded in different places.
  m.code_from_mesh =
      glm::mat4x3(0.5f, 0.1f, -0.1f, -0.1f, 0.5f, 0.2f, 0.1f, 0.2f, 0.6f, 0.1f, 0.4f, 0.7f);
  add("position code", m, nothing);
  m = plain, m.emissive = {0.2f, 0.05f, 0.1f};
  add("emission", m, nothing);
  add("vertex colours", plain, [](Scene& s) {
    for (const glm::vec3& p : s.meshes[0].positions)
      s.meshes[0].colors.emplace_back(0.5f + 0.4f * p, 1.0f);
  });

  m = Material{}, m.base_color_texture.texture = 0;
  add("base texture", m, nothing);
  m.base_color_texture.texture = 1;
  add("base texture of odd size", m, nothing);
  m.base_color_texture.texture = 4;
  add("base texture from afar", m, [](Scene& s) {
    for (glm::vec2& uv : s.meshes[0].uv[0]) uv *= 2.0f;
  });
  m.base_color_texture.texture = 0;
  for (const Wrap wrap : {Wrap::repeat, Wrap::mirrored_repeat, Wrap::clamp_to_edge})
    add("wrap mode " + std::to_string(int(wrap)), m, [&](Scene& s) {
      s.textures[0].wrap_u = wrap;
      s.textures[0].wrap_v = wrap == Wrap::repeat ? Wrap::mirrored_repeat : wrap;
      for (glm::vec2& uv : s.meshes[0].uv[0]) uv = 2.3f * uv - 0.6f;
    });
  m.base_color_texture.uv_set = 1;
  add("second set of coordinates", m, nothing);
  m.base_color_texture.uv_set = 0;
  m.base_color_texture.texture_from_uv = {{1.1f, -0.7f, 0}, {0.6f, 0.9f, 0}, {0.2f, 0.3f, 1}};
  add("texture transform", m, nothing);

  m = plain, m.metallic = 1, m.roughness = 1, m.metallic_roughness_texture.texture = 0;
  add("metallic and roughness texture", m, nothing);
  m = plain, m.occlusion_texture.texture = 0, m.occlusion_strength = 0.8f;
  add("occlusion texture", m, nothing);
  m = plain, m.emissive = {0.5f, 0.6f, 0.4f}, m.emissive_texture.texture = 0;
  add("emission texture", m, nothing);
  m = plain, m.normal_texture.texture = 2, m.normal_scale = 0.8f;
  add("normal map", m, nothing);
  add("normal map, mirrored coordinates", m, [](Scene& s) {
    for (glm::vec2& uv : s.meshes[0].uv[0]) uv.x = -uv.x;
  });
  add("normal map, mirrored pose", m, [](Scene& s) {
    s.objects[0].placement = glm::scale(s.objects[0].placement, {-1, 1, 0.9f});
  });
  m.double_sided = true;
  add("normal map from the back", m, [](Scene& s) {
    s.objects[0].placement = glm::rotate(s.objects[0].placement, 2.9f, {0, 1, 0});
  });

  m = plain, m.double_sided = true;
  add("seen from the back", m, [](Scene& s) {
    s.objects[0].placement = glm::rotate(s.objects[0].placement, 2.9f, {0, 1, 0});
    s.meshes[0].indices.resize(s.meshes[0].indices.size() / 2 / 3 * 3);
  });
  add("mirrored pose", plain, [](Scene& s) {
    s.objects[0].placement = glm::scale(s.objects[0].placement, {1, -0.8f, 1});
  });
  // A sheet whose smooth normals point to the other side, or nearly along it.
  add("normals that disagree with their triangle", m, [](Scene& s) {
    for (glm::vec3& n : s.meshes[0].normals)
      n = glm::normalize(glm::vec3(0.8f * n.x + 0.5f, n.y, -0.4f * n.z));
  });

  add("lights of all kinds", plain, [](Scene& s) {
    Light point, spot;
    point.kind = Light::Kind::point, spot.kind = Light::Kind::spot;
    point.position = {1.5f, 1, 2}, point.intensity = {6, 3, 2}, point.range = 5;
    spot.position = {-1, 1.5f, 2.5f}, spot.intensity = {2, 12, 14};
    spot.direction = glm::normalize(-spot.position);
    spot.inner_cone = 0.1f, spot.outer_cone = 0.4f;
    s.lights.insert(s.lights.end(), {point, spot});
  });
  add("100 lights", plain, [](Scene& s) {
    std::mt19937 rng(8);
    std::uniform_real_distribution<float> u(-1, 1);
    s.lights.clear();
    for (int i = 0; i < 100; ++i) {
      Light light;
      light.kind = Light::Kind(i % 3);
      light.position = 2.0f * glm::vec3(u(rng), u(rng), 1.5f + u(rng));
      light.direction = glm::normalize(-light.position);
      light.intensity = 0.06f * (1.0f + glm::vec3(u(rng), u(rng), u(rng)));
      light.outer_cone = 0.6f;
      s.lights.push_back(light);
    }
  });

  m = Material{}, m.alpha_mode = AlphaMode::mask, m.double_sided = true;
  m.base_color_texture.texture = 3;
  add("masked leaves", m, nothing);
  return scenes;
}

}  // namespace rilievo
