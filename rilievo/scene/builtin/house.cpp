// Houses, towers, lamp posts and rocks.

#include <algorithm>
#include <cmath>

#include "rilievo/core/random.h"
#include "rilievo/scene/builtin/masonry.h"
#include "rilievo/scene/builtin/parts.h"

namespace rilievo {
namespace {

const glm::vec3 kTileColor{0.33f, 0.13f, 0.075f};
const glm::vec3 kTimber{0.16f, 0.11f, 0.07f};
const glm::vec3 kPane{0.035f, 0.045f, 0.055f};

void add_plain_box(Mesh& mesh, const glm::vec3& low, const glm::vec3& high,
                   const glm::vec3& color) {
  add_box(mesh, {}, [&](const glm::vec3& c) {
    return BuiltVertex{glm::mix(low, high, 0.5f + 0.5f * c), color};
  });
}

// A window of 1.1 x 1.4 m in a frame, its centre at `center` on a wall that looks along +-x or +-z.
void add_window(Mesh& mesh, const glm::vec3& center, bool along_x) {
  const auto box = [&](float half_width, float half_height, float half_depth,
                       const glm::vec3& color) {
    const glm::vec3 half = along_x ? glm::vec3(half_width, half_height, half_depth)
                                   : glm::vec3(half_depth, half_height, half_width);
    add_plain_box(mesh, center - half, center + half, color);
  };
  box(0.72f, 0.88f, 0.08f, kTimber);
  box(0.55f, 0.70f, 0.10f, kPane);
  box(0.03f, 0.70f, 0.11f, kTimber);
  box(0.85f, 0.06f, 0.16f, kTimber * 1.3f);
}

}  // namespace

Mesh make_house(std::uint64_t seed, int triangles) {
  Random random(seed);
  Mesh mesh;
  mesh.name = "house";
  constexpr float kHalfX = 4.5f, kHalfZ = 3.25f, kEaves = 4.4f, kRidge = 7.9f, kOverhang = 0.4f;
  const float rise = (kRidge - kEaves) / kHalfZ;

  // Windows and timber, 12 triangles a box.
  for (const float side : {-1.0f, 1.0f}) {
    for (const float x : {-2.8f, 2.8f}) add_window(mesh, {x, 2.4f, side * kHalfZ}, true);
    add_window(mesh, {side * kHalfX, 2.4f, 0}, false);
    add_window(mesh, {side * kHalfX, 5.6f, 0}, false);
    add_plain_box(mesh, {-0.65f, 0, side * (kHalfZ - 0.08f) - 0.02f},
                  {0.65f, 2.3f, side * (kHalfZ + 0.06f) + 0.02f}, kTimber);
  }
  add_plain_box(mesh, {2.2f, kEaves, -1.6f}, {3.1f, kRidge + 0.9f, -0.7f},
                glm::vec3(0.30f, 0.25f, 0.22f));

  // Walls of plastered stone and roofs of tiles share what is left of the triangles.
  Wall wall;
  wall.height = kRidge, wall.course = 0.32f, wall.shortest = 0.4f, wall.longest = 0.75f;
  wall.bulge = 0.025f, wall.joint = 0.012f;
  wall.color = glm::vec3(0.50f, 0.45f, 0.36f) * random.between(0.9f, 1.1f), wall.tints = 0.08f;
  Wall roof;
  roof.length = 2 * kHalfX + 2 * kOverhang;
  const float slope = std::hypot(1.0f, rise), reach = kHalfZ + kOverhang;
  roof.height = reach * slope;
  roof.course = 0.36f, roof.shortest = 0.25f, roof.longest = 0.3f;
  roof.bulge = 0.07f, roof.joint = 0.004f, roof.color = kTileColor, roof.tints = 0.18f;
  const double area =
      2.0 * (2 * kHalfX * kEaves + kHalfZ * (kEaves + kRidge)) + 2.0 * roof.length * roof.height;
  const double density = std::max(0.0, triangles - double(mesh.triangles())) / area;
  TriangleBudget budget;
  for (const float side : {-1.0f, 1.0f}) {
    wall.length = 2 * kHalfX, wall.height = kEaves, wall.upper = nullptr;
    wall.place = [&](const glm::vec3& w) {
      return glm::vec3(side * (w.x - kHalfX), w.y, side * (kHalfZ + w.z));
    };
    add_wall(mesh, wall, density, random.next(), budget);
    // Gables.
    wall.length = 2 * kHalfZ, wall.height = kRidge;
    wall.upper = [&](float s) { return kEaves + rise * (kHalfZ - std::abs(s - kHalfZ)); };
    wall.place = [&](const glm::vec3& w) {
      return glm::vec3(side * (kHalfX + w.z), w.y, -side * (w.x - kHalfZ));
    };
    add_wall(mesh, wall, density, random.next(), budget);
    roof.place = [&](const glm::vec3& w) {
      const float up = w.y / slope;  // how far in from the overhang
      const glm::vec3 normal = glm::vec3(0, 1, side * rise) / slope;
      return glm::vec3(side * (w.x - 0.5f * roof.length), kEaves + rise * (up - kOverhang) + 0.12f,
                       side * (reach - up)) +
             w.z * normal;
    };
    add_wall(mesh, roof, density, random.next(), budget);
  }
  return mesh;
}

Mesh make_tower(std::uint64_t seed, int triangles) {
  Random random(seed);
  Mesh mesh;
  mesh.name = "tower";
  constexpr float kRadius = 2.5f, kHeight = 12.0f, kRoof = 4.2f, kRoofRadius = 2.2f;
  // A wall around the axis; `radius` at height t above `base`.
  const auto ring = [](float length, float radius, float narrowing, float base, float rise) {
    return [=](const glm::vec3& w) {
      const float angle = kTwoPi * w.x / length;
      const float r = radius - narrowing * w.y + w.z;
      return glm::vec3(r * std::sin(angle), base + rise * w.y, r * std::cos(angle));
    };
  };
  Wall shaft;
  shaft.length = kTwoPi * kRadius, shaft.height = kHeight;
  shaft.color = {0.37f, 0.35f, 0.32f};
  shaft.place = ring(shaft.length, kRadius, 0.02f, 0, 1);
  Wall battlement;
  battlement.length = kTwoPi * 2.75f, battlement.height = 1.6f, battlement.two_sided = true;
  battlement.course = 0.4f, battlement.depth = 0.35f, battlement.color = shaft.color;
  battlement.shortest = battlement.longest = 0.72f;
  battlement.place = ring(battlement.length, 2.75f, 0, kHeight - 0.6f, 1);
  battlement.hole = [](float s, float t) { return t > 0.8f && std::fmod(s, 1.44f) < 0.72f; };
  Wall roof;
  // Up to nine tenths of the cone; a ball on top.
  roof.length = kTwoPi * kRoofRadius, roof.height = 0.9f * std::hypot(kRoof, kRoofRadius);
  roof.course = 0.36f, roof.shortest = 0.25f, roof.longest = 0.3f, roof.bulge = 0.06f;
  roof.joint = 0.004f, roof.color = kTileColor, roof.tints = 0.18f;
  const float slant = std::hypot(kRoof, kRoofRadius);
  roof.place = ring(roof.length, kRoofRadius, kRoofRadius / slant, kHeight + 0.2f, kRoof / slant);

  const double area = double(shaft.length) * shaft.height +
                      1.5 * double(battlement.length) * battlement.height +
                      double(roof.length) * roof.height;
  TriangleBudget budget;
  const int n = budget.divide(0.01 * triangles, 8, 0, 2);
  add_blob(mesh, n, [&](const glm::vec3& d) {
    return BuiltVertex{glm::vec3(0, kHeight + 0.2f + 0.95f * kRoof, 0) + 0.3f * d,
                       {0.45f, 0.35f, 0.12f}};
  });
  const double density = 0.99 * triangles / area;
  add_wall(mesh, shaft, density, random.next(), budget);
  add_wall(mesh, battlement, density, random.next(), budget);
  add_wall(mesh, roof, density, random.next(), budget);
  return mesh;
}

Mesh make_lamp_post(int triangles) {
  Mesh mesh;
  mesh.name = "lamp post";
  const glm::vec3 iron{0.05f, 0.055f, 0.06f}, glass{0.85f, 0.80f, 0.62f};
  TriangleBudget budget;
  // The post: 2 * 2n * n; the lamp and its cap: 8 n^2 / 2 each.
  const int n = budget.divide(triangles, 12, 0, 3), m = std::max(2, int(n * 0.7f));
  GridShape shape;
  shape.nu = 2 * n, shape.nv = n, shape.closed_u = true;
  add_grid(mesh, shape, [&](float u, float v) {
    const float y = 3.45f * v, angle = kTwoPi * u;
    const float foot = 0.11f * std::exp(-6 * y), bead = 0.03f * std::exp(-60 * (y - 3) * (y - 3));
    const float r = 0.06f - 0.006f * y + foot + bead;
    return BuiltVertex{{r * std::sin(angle), y, r * std::cos(angle)}, iron};
  });
  add_blob(mesh, m, [&](const glm::vec3& d) {
    return BuiltVertex{glm::vec3(0, 3.65f, 0) + d * glm::vec3(0.2f, 0.24f, 0.2f), glass};
  });
  add_blob(mesh, m, [&](const glm::vec3& d) {
    return BuiltVertex{glm::vec3(0, 3.88f, 0) + d * glm::vec3(0.25f, 0.09f, 0.25f), iron};
  });
  return mesh;
}

Mesh make_rock(std::uint64_t seed, int triangles) {
  Mesh mesh;
  mesh.name = "rock";
  TriangleBudget budget;
  Random random(seed);
  const glm::vec3 half{random.between(0.8f, 1.2f), random.between(0.55f, 0.8f),
                       random.between(0.8f, 1.2f)};
  add_blob(mesh, budget.divide(triangles, 8, 0, 2), [&](const glm::vec3& d) {
    const float rough = 0.22f * noise(1.6f * d, seed) + 0.08f * noise(4.5f * d, seed + 1) +
                        0.03f * noise(11.0f * d, seed + 2);
    const float light = 0.85f + 0.9f * rough;
    return BuiltVertex{half * d * (0.5f + 0.5f * rough), glm::vec3(0.27f, 0.26f, 0.235f) * light};
  });
  return mesh;
}

}  // namespace rilievo
