// A ring of trilithons on a plain, spheres between them and a torus in rainbow colours in the
// middle: the test scene of [Darsa, Costa, Varshney 1997].

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "rilievo/core/random.h"
#include "rilievo/scene/builtin/mesh_builder.h"
#include "rilievo/scene/builtin/parts.h"

namespace rilievo {
namespace {

constexpr int kRing = 12, kHorseshoe = 5, kSpheres = 9;
constexpr float kRingRadius = 11.0f, kHorseshoeRadius = 6.2f;

// Hue in [0, 1) at full saturation, linear.
glm::vec3 rainbow(float hue) {
  const auto wave = [&](float shift) {
    const float w = 0.5f + 0.5f * std::cos(kTwoPi * (hue - shift));
    return 0.03f + 0.75f * w * w;
  };
  return {wave(0.0f), wave(1.0f / 3), wave(2.0f / 3)};
}

// A weathered block between `low` and `high`; 12 n^2 triangles.
void add_stone(Mesh& mesh, const glm::vec3& low, const glm::vec3& high, int n, std::uint64_t seed) {
  BoxShape box;
  box.n = glm::ivec3(n);
  const glm::vec3 center = 0.5f * (low + high), half = 0.5f * (high - low);
  add_box(mesh, box, [&](const glm::vec3& cube) {
    const glm::vec3 p = center + rounded_box(cube, half, 0.12f, box.n);
    const float rough = noise(1.1f * p, seed) + 0.4f * noise(3.1f * p, seed + 1);
    const glm::vec3 out = glm::normalize(p - center + 1e-6f);
    const float tone = 1.0f + 0.25f * noise(2.0f * p, seed + 2) + 0.15f * noise(9.0f * p, seed + 3);
    return BuiltVertex{p + 0.06f * rough * out, tone * glm::vec3(0.33f, 0.32f, 0.29f)};
  });
}

// Two uprights and a lintel, `height` to the lintel's top, along x; 36 n^2 triangles.
Mesh make_trilithon(float height, int n, std::uint64_t seed) {
  Mesh mesh;
  mesh.name = "trilithon";
  const float top = height - 0.8f;
  add_stone(mesh, {-1.75f, -0.4f, -0.5f}, {-0.65f, top, 0.5f}, n, seed);
  add_stone(mesh, {0.65f, -0.4f, -0.5f}, {1.75f, top, 0.5f}, n, seed + 10);
  add_stone(mesh, {-2.0f, top - 0.05f, -0.55f}, {2.0f, height, 0.55f}, n, seed + 20);
  return mesh;
}

Mesh make_sphere(float radius, const glm::vec3& color, int n) {
  Mesh mesh;
  mesh.name = "sphere";
  add_blob(mesh, n, [&](const glm::vec3& d) { return BuiltVertex{radius * d, color}; });
  return mesh;
}

// Stands upright, its hole along z; the colours go around it. 4 n^2 triangles or so.
Mesh make_rainbow_torus(float radius, float thickness, int n) {
  Mesh mesh;
  mesh.name = "torus";
  GridShape shape;
  shape.nu = 2 * n, shape.nv = n;
  shape.closed_u = shape.closed_v = true;
  add_grid(mesh, shape, [&](float u, float v) {
    const float a = kTwoPi * u, b = kTwoPi * v, r = radius + thickness * std::cos(b);
    return BuiltVertex{{r * std::cos(a), r * std::sin(a), thickness * std::sin(b)}, rainbow(u)};
  });
  return mesh;
}

// At `angle` around the middle, facing it.
glm::mat4 around(float radius, float angle) {
  const glm::mat4 turned = glm::rotate(glm::mat4(1), angle, {0, 1, 0});
  return turned * glm::translate(glm::mat4(1), {0, 0, -radius});
}

}  // namespace

BuiltinScene make_stonehenge(std::uint64_t triangles, std::uint64_t seed) {
  BuiltinScene built;
  Scene& scene = built.scene;
  scene.name = "stonehenge";
  Material matt;
  matt.name = "matt", matt.roughness = 0.9f;
  scene.materials.push_back(matt);
  const double n = double(triangles);
  TriangleBudget budget;

  // A plain that rolls a little; 8 % of the triangles.
  Ground ground;
  ground.height = [seed](float x, float z) {
    const float far = std::max(0.0f, std::hypot(x, z) - 16.0f);
    return std::min(far * 0.05f, 3.0f) * noise({0.03f * x, 0.0f, 0.03f * z}, seed + 100);
  };
  ground.color = [seed](const glm::vec3& p) {
    const float tone =
        1.0f + 0.25f * noise(0.35f * p, seed + 101) + 0.2f * noise(1.7f * p, seed + 102);
    return tone * glm::vec3(0.10f, 0.16f, 0.05f);
  };
  const float plain = 160;
  const int cells = budget.divide(0.08 * n, 2, 0, 8);
  add_object(scene, "plain",
             add_model(scene, make_ground(ground, {-plain / 2, -plain / 2}, plain, cells), 0),
             glm::mat4(1));

  // Stones take 74 %, a sphere 1.2 % each, the torus the rest.
  const double each = 0.74 * n / (kRing + kHorseshoe);
  for (int i = 0; i < kRing + kHorseshoe; ++i) {
    const bool inner = i >= kRing;
    const float height = inner ? 6.0f : 4.4f;
    const int fine = budget.divide(each, 36, 0, 3);
    const int model =
        add_model(scene, make_trilithon(height, fine, combine(seed, std::uint64_t(i)) % 100000), 0);
    const float angle =
        inner ? 0.62f * float(i - kRing - kHorseshoe / 2) : kTwoPi * (float(i) + 0.5f) / kRing;
    add_object(scene, "trilithon", model, around(inner ? kHorseshoeRadius : kRingRadius, angle));
  }
  Random random(seed);
  for (int i = 0; i < kSpheres; ++i) {
    const int fine = budget.divide(0.012 * n, 8, 0, 4);
    const float radius = random.between(0.45f, 0.9f);
    const glm::vec3 color = rainbow((float(i) + 0.3f * random.unit()) / kSpheres);
    const int model = add_model(scene, make_sphere(radius, color, fine), 0);
    const float angle = kTwoPi * (float(i) + random.between(-0.2f, 0.2f)) / kSpheres;
    const glm::mat4 lifted = glm::translate(glm::mat4(1), {0, radius + random.between(0, 0.8f), 0});
    add_object(scene, "sphere", model, lifted * around(random.between(3.4f, 4.6f), angle));
  }
  const int fine = budget.divide(n * (1 - 0.08 - 0.74 - 0.012 * kSpheres), 4, 0, 6);
  add_object(scene, "torus", add_model(scene, make_rainbow_torus(1.25f, 0.38f, fine), 0),
             glm::translate(glm::mat4(1), {0, 1.9f, 0}));
  finish(scene);

  // From in front of the torus to its left, then in between the stones, looking at it.
  const glm::dvec3 eyes[] = {
      {0, 1.7, 8}, {-3, 1.7, 8}, {-5.2, 1.8, 6.4}, {-7.6, 1.7, 3.4}, {-8.6, 1.7, 0}};
  double time = 0;
  for (int i = 0; i < 5; ++i) {
    if (i) time += std::max(4.2, glm::distance(eyes[i], eyes[i - 1]) / kWalkingSpeed);
    built.path.keys.push_back(look_key(time, eyes[i], {0, 1.9, 0}, {0, 1, 0}, 0.9));
  }
  built.path.z_near = 0.1, built.path.z_far = 400;
  return built;
}

}  // namespace rilievo
