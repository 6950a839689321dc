// Things that touch and cut each other on a table: teapots, rings and blocks, a wall through two of
// the teapots, and a ring that slides through a third. Cf. figure 1 of [Schaufler 1997].

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "rilievo/core/random.h"
#include "rilievo/scene/builtin/mesh_builder.h"
#include "rilievo/scene/builtin/parts.h"

namespace rilievo {
namespace {

constexpr float kTeapotsFov = 0.75f;  // 43 degrees

Mesh make_ring(float radius, float thickness, int triangles) {
  Mesh mesh;
  mesh.name = "ring";
  GridShape shape;
  shape.closed_u = shape.closed_v = true;
  shape.nv = std::max(6, int(std::lround(std::sqrt(triangles / 2.0 * thickness / radius))));
  shape.nu = std::max(12, int(std::lround(triangles / 2.0 / shape.nv)));
  add_grid(mesh, shape, [&](float u, float v) {
    const float a = kTwoPi * u, b = kTwoPi * v, r = radius + thickness * std::cos(b);
    return BuiltVertex{{r * std::sin(a), thickness * std::sin(b), r * std::cos(a)}};
  });
  return mesh;
}

Mesh make_block(const glm::vec3& half, float rounding, int triangles) {
  Mesh mesh;
  mesh.name = "block";
  BoxShape shape;
  shape.n = glm::ivec3(std::max(3, int(std::lround(std::sqrt(triangles / 12.0)))));
  add_box(mesh, shape,
          [&](const glm::vec3& c) { return BuiltVertex{rounded_box(c, half, rounding, shape.n)}; });
  return mesh;
}

int add_material(Scene& scene, const char* name, const glm::vec3& color, float roughness,
                 float metallic) {
  Material material;
  material.name = name;
  material.base_color = glm::vec4(color, 1);
  material.roughness = roughness, material.metallic = metallic;
  // The teapot is open between lid and rim, and its handle and spout are open tubes.
  material.double_sided = true;
  scene.materials.push_back(material);
  return int(scene.materials.size()) - 1;
}

glm::mat4 at(float x, float y, float z, float yaw_degrees, float scale = 1.0f) {
  glm::mat4 m = glm::translate(glm::mat4(1), {x, y, z});
  m = glm::rotate(m, glm::radians(yaw_degrees), {0, 1, 0});
  return glm::scale(m, glm::vec3(scale));
}

// Five degrees of arc for each half second at `distance` from `target`: 10 degrees a second.
CameraPath around(const glm::dvec3& target, double distance, double elevation, double azimuth) {
  CameraPath path;
  for (int i = 0; i <= 60; ++i) {
    const double a = glm::radians(azimuth + 5.0 * i), e = glm::radians(elevation);
    const glm::dvec3 out{std::sin(a) * std::cos(e), std::sin(e), std::cos(a) * std::cos(e)};
    path.keys.push_back(look_key(0.5 * i, target + distance * out, target, {0, 1, 0}, kTeapotsFov));
  }
  path.z_near = 0.05 * distance, path.z_far = 6 * distance;
  return path;
}

}  // namespace

BuiltinScene make_single_teapot(std::uint64_t triangles) {
  BuiltinScene built;
  built.scene.name = "teapot";
  const int glaze = add_material(built.scene, "glaze", {0.55f, 0.30f, 0.12f}, 0.35f, 0.0f);
  add_object(built.scene, "teapot", add_model(built.scene, make_teapot(int(triangles)), glaze),
             glm::mat4(1));
  finish(built.scene);
  built.path = around({0.2, 1.5, 0}, 10.5, 22, 20);
  return built;
}

BuiltinScene make_teapots(std::uint64_t triangles, std::uint64_t seed) {
  BuiltinScene built;
  Scene& scene = built.scene;
  scene.name = "teapots";
  Random random(seed);
  const glm::vec3 tints[] = {{0.60f, 0.33f, 0.12f}, {0.15f, 0.33f, 0.45f}, {0.55f, 0.14f, 0.10f},
                             {0.52f, 0.50f, 0.44f}, {0.18f, 0.38f, 0.17f}, {0.50f, 0.42f, 0.10f}};
  int glazes[6];
  for (int i = 0; i < 6; ++i) {
    const glm::vec3 shift{random.between(0.9f, 1.1f), random.between(0.9f, 1.1f),
                          random.between(0.9f, 1.1f)};
    glazes[i] = add_material(scene, "glaze", tints[i] * shift, 0.35f, 0.0f);
  }
  const int steel = add_material(scene, "steel", {0.55f, 0.56f, 0.58f}, 0.4f, 0.8f);
  const int plaster = add_material(scene, "plaster", {0.62f, 0.59f, 0.53f}, 0.9f, 0.0f);
  const int wood = add_material(scene, "wood", {0.30f, 0.19f, 0.10f}, 0.7f, 0.0f);

  // Six teapots take 72 %, five rings 20 %, four blocks 8 % of the triangles.
  const double n = double(triangles);
  int teapots[6];
  for (int i = 0; i < 6; ++i) teapots[i] = add_model(scene, make_teapot(int(n * 0.12)), glazes[i]);
  const int big_ring = add_model(scene, make_ring(1.6f, 0.28f, int(n * 0.04)), steel);
  const int small_ring = add_model(scene, make_ring(1.0f, 0.2f, int(n * 0.04)), glazes[5]);
  const int cube = add_model(scene, make_block(glm::vec3(0.9f), 0.12f, int(n * 0.02)), plaster);
  const int wall = add_model(scene, make_block({4.2f, 1.5f, 0.25f}, 0.04f, 12), plaster);
  const int table = add_model(scene, make_block({11, 0.3f, 8}, 0.1f, 12), wood);

  add_object(scene, "table", table, at(0, -0.3f, 0, 0));
  // Spouts through handles, a wall through two bodies, rings around spouts, blocks into sides.
  add_object(scene, "teapot", teapots[0], at(-4.6f, 0, 1.2f, 15));
  add_object(scene, "teapot", teapots[1], at(0.3f, 0, 2.2f, -10));
  add_object(scene, "teapot", teapots[2], at(4.9f, 0, 1.4f, 40));
  add_object(scene, "teapot", teapots[3], at(-2.3f, 0, -2.3f, -35));
  add_object(scene, "teapot", teapots[4], at(2.4f, 0, -2.2f, 70));
  add_object(scene, "teapot", teapots[5], at(6.6f, 0, -3.2f, 160, 0.8f));
  add_object(scene, "wall", wall, at(0, 1.5f, -2.3f, 4));
  add_object(scene, "ring", big_ring,
             at(-4.6f, 0.28f, 1.2f, 0) * glm::rotate(glm::mat4(1), 0.16f, {0, 0, 1}));
  add_object(scene, "ring", big_ring,
             at(4.9f, 1.5f, 1.4f, 40) * glm::rotate(glm::mat4(1), 1.2f, {1, 0, 0}));
  add_object(scene, "ring", small_ring, at(-7.2f, 0.2f, -1.6f, 0));
  add_object(scene, "ring", small_ring,
             at(-6.6f, 0.75f, -1.6f, 0) * glm::rotate(glm::mat4(1), 1.0f, {0, 0, 1}));
  add_object(scene, "block", cube, at(2.2f, 0.9f, 2.9f, 30));
  add_object(scene, "block", cube, at(-2.4f, 0.9f, 2.6f, 12, 0.6f));
  add_object(scene, "block", cube, at(7.9f, 0.9f, 1.0f, 55));
  add_object(scene, "block", cube, at(7.5f, 2.2f, 0.6f, 20, 0.7f));

  // A ring that passes over the middle teapot's spout and back in eight seconds, and turns.
  Node mover;
  mover.translation = {1.6f, 1.9f, 2.2f};
  scene.nodes.push_back(mover);
  Channel slide;
  slide.path = Channel::Path::translation;
  slide.times = {0, 4, 8};
  slide.values = {{1.6f, 1.9f, 2.2f, 0}, {4.4f, 2.3f, 2.6f, 0}, {1.6f, 1.9f, 2.2f, 0}};
  Channel turn;
  turn.path = Channel::Path::rotation;
  for (int i = 0; i <= 8; ++i) {
    const float half_angle = 0.5f * kTwoPi * float(i) / 8.0f;
    turn.times.push_back(float(i));
    turn.values.push_back({0, std::sin(half_angle), 0, std::cos(half_angle)});
  }
  scene.channels = {slide, turn};
  scene.duration = 8;
  Object ring;
  ring.name = "moving ring", ring.model = small_ring, ring.node = 0;
  ring.placement = glm::rotate(glm::mat4(1), 1.2f, {0, 0, 1});
  scene.objects.push_back(ring);
  finish(scene);
  built.path = around({0.6, 1.1, 0}, 16, 24, -25);
  return built;
}

}  // namespace rilievo
