// Vehicles: bodies bent out of rounded boxes, wheels turned on a lathe.
//
// Forward is +x, the ground is y = 0.

#include <algorithm>
#include <cmath>

#include "rilievo/scene/builtin/mesh_builder.h"
#include "rilievo/scene/builtin/parts.h"

namespace rilievo {
namespace {

const glm::vec3 kGlass{0.03f, 0.04f, 0.05f};
const glm::vec3 kRubber{0.025f, 0.025f, 0.027f};
const glm::vec3 kMetal{0.45f, 0.46f, 0.48f};

// A rounded box between `low` and `high`, bent and painted by `shape`, which is given the point and
// its place on the cube.
using Shaper = std::function<BuiltVertex(glm::vec3 point, const glm::vec3& cube)>;
void add_body(Mesh& mesh, const glm::vec3& low, const glm::vec3& high, float rounding, int n,
              const Shaper& shape) {
  BoxShape box;
  box.n = glm::ivec3(n);
  const glm::vec3 center = 0.5f * (low + high), half = 0.5f * (high - low);
  add_box(mesh, box, [&](const glm::vec3& cube) {
    return shape(center + rounded_box(cube, half, rounding, box.n), cube);
  });
}

// Tyre and hub, the axle along z; 20 n triangles.
void add_wheel(Mesh& mesh, const glm::vec3& center, float radius, float width, int n) {
  // Radius and offset along the axle: hub, rim, tread, and back on the other side.
  const glm::vec2 profile[] = {{0.0f, 0.35f},  {0.30f, 0.45f},  {0.58f, 0.38f},  {0.62f, 0.5f},
                               {0.90f, 0.5f},  {1.0f, 0.35f},   {1.0f, -0.35f},  {0.90f, -0.5f},
                               {0.62f, -0.5f}, {0.58f, -0.38f}, {0.30f, -0.45f}, {0.0f, -0.35f}};
  GridShape shape;
  shape.nu = n, shape.nv = 11;
  shape.closed_u = shape.pole_at_start = shape.pole_at_end = true;
  add_grid(mesh, shape, [&](float u, float v) {
    const glm::vec2 p = profile[std::lround(v * 11)];
    // u turns from +x to -y, v runs from +z to -z.
    const float angle = -kTwoPi * u;
    const glm::vec3 out{std::cos(angle), std::sin(angle), 0};
    return BuiltVertex{center + radius * p.x * out + glm::vec3(0, 0, width * p.y),
                       p.x < 0.6f ? kMetal : kRubber};
  });
}

void add_wheels(Mesh& mesh, std::initializer_list<float> axles, float track, float radius,
                float width, int n) {
  for (const float x : axles)
    for (const float side : {-1.0f, 1.0f})
      add_wheel(mesh, {x, radius, side * track}, radius, width, n);
}

// Four lamps: white in front, red behind.
void add_lamps(Mesh& mesh, float front, float back, float y, float z, int n) {
  for (const float side : {-1.0f, 1.0f}) {
    add_blob(mesh, n, [&](const glm::vec3& d) {
      return BuiltVertex{glm::vec3(front, y, side * z) + d * glm::vec3(0.08f, 0.09f, 0.16f),
                         {0.9f, 0.88f, 0.8f}};
    });
    add_blob(mesh, n, [&](const glm::vec3& d) {
      return BuiltVertex{glm::vec3(back, y, side * z) + d * glm::vec3(0.07f, 0.1f, 0.13f),
                         {0.5f, 0.02f, 0.02f}};
    });
  }
}

// Mirrors that reach from the flanks at +-z outwards by `reach`.
void add_mirrors(Mesh& mesh, const glm::vec3& flank, float reach, int n) {
  for (const float side : {-1.0f, 1.0f})
    add_blob(mesh, n, [&](const glm::vec3& d) {
      return BuiltVertex{glm::vec3(flank.x, flank.y, side * (flank.z + 0.4f * reach)) +
                             d * glm::vec3(0.06f, 0.5f * reach, 0.6f * reach),
                         kRubber};
    });
}

// Windows around the upper part of a cabin: glass where the cube's side faces are, pillars between.
glm::vec3 cabin_color(const glm::vec3& cube, const glm::vec3& paint, int pillars) {
  if (cube.y > 0.75f || cube.y < -0.8f) return paint;
  const bool flank = std::abs(cube.z) > 0.999f;
  const float along = (flank ? cube.x : cube.z) * 0.5f + 0.5f;
  const float cell = along * float(flank ? pillars : 1);
  const float to_pillar = std::abs(cell - std::round(cell)) / float(flank ? pillars : 1);
  return to_pillar < 0.035f ? paint : kGlass;
}

Mesh make_car(const glm::vec3& paint, int triangles) {
  Mesh mesh;
  mesh.name = "car";
  // 12 n^2 + 12 n^2 for the bodies, 4 * 20 n for the wheels, 6 * 8 (n / 4)^2 for lamps and mirrors.
  TriangleBudget budget;
  const int n = budget.divide(triangles, 27, 80, 6);
  add_body(mesh, {-2.1f, 0.28f, -0.87f}, {2.1f, 0.98f, 0.87f}, 0.22f, n,
           [&](glm::vec3 p, const glm::vec3& c) {
             // The bonnet falls towards the front, the flanks draw in towards the ends.
             const float high = 0.5f + 0.5f * c.y;
             p.y -= 0.16f * high * glm::smoothstep(0.3f, 1.0f, c.x);
             p.y -= 0.05f * high * glm::smoothstep(0.6f, 1.0f, -c.x);
             p.z *= 1 - 0.10f * c.x * c.x * c.x * c.x;
             return BuiltVertex{p, p.y < 0.38f ? kRubber : paint};
           });
  add_body(mesh, {-1.55f, 0.85f, -0.78f}, {1.0f, 1.46f, 0.78f}, 0.14f, n,
           [&](glm::vec3 p, const glm::vec3& c) {
             const float high = 0.5f + 0.5f * c.y;
             p.z *= 1 - 0.20f * high;
             p.x -= high * (c.x > 0 ? 0.55f * c.x : 0.25f * c.x);
             return BuiltVertex{p, cabin_color(c, paint, 2)};
           });
  add_wheels(mesh, {-1.3f, 1.3f}, 0.78f, 0.33f, 0.22f, n);
  add_lamps(mesh, 2.02f, -2.05f, 0.68f, 0.6f, std::max(1, n / 4));
  add_mirrors(mesh, {0.75f, 0.98f, 0.8f}, 0.22f, std::max(1, n / 4));
  return mesh;
}

Mesh make_truck(const glm::vec3& paint, int triangles) {
  Mesh mesh;
  mesh.name = "truck";
  TriangleBudget budget;
  const int n = budget.divide(triangles, 39, 120, 6);
  add_body(mesh, {1.7f, 0.5f, -1.15f}, {3.7f, 2.6f, 1.15f}, 0.2f, n,
           [&](glm::vec3 p, const glm::vec3& c) {
             p.x -= 0.25f * (0.5f + 0.5f * c.y) * std::max(0.0f, c.x);
             const bool glass = c.y > 0.05f && c.y < 0.8f && c.x > -0.3f &&
                                (std::abs(c.z) < 0.85f || std::abs(c.z) > 0.999f);
             return BuiltVertex{p, glass ? kGlass : paint};
           });
  // The load is 2.8 m wide: on the bridge it scrapes the parapet.
  add_body(mesh, {-3.7f, 0.95f, -1.4f}, {1.5f, 3.1f, 1.4f}, 0.08f, n,
           [&](glm::vec3 p, const glm::vec3& c) {
             // Ribs of the tarpaulin.
             const float rib = 0.02f * std::cos(c.x * 25.0f) * (1 - c.y * c.y);
             p.z += c.z > 0 ? rib : -rib;
             return BuiltVertex{p, glm::vec3(0.52f, 0.49f, 0.40f) * (0.9f + 4 * rib)};
           });
  add_body(mesh, {-3.6f, 0.5f, -0.5f}, {2.5f, 0.95f, 0.5f}, 0.05f, n,
           [](glm::vec3 p, const glm::vec3&) {
             return BuiltVertex{p, kRubber * 2.0f};
           });
  add_wheels(mesh, {-2.8f, -1.7f, 2.6f}, 1.05f, 0.5f, 0.32f, n);
  add_lamps(mesh, 3.7f, -3.7f, 0.9f, 0.85f, std::max(1, n / 4));
  add_mirrors(mesh, {3.3f, 1.9f, 1.15f}, 0.4f, std::max(1, n / 4));
  return mesh;
}

Mesh make_bus(const glm::vec3& paint, int triangles) {
  Mesh mesh;
  mesh.name = "bus";
  TriangleBudget budget;
  const int n = budget.divide(triangles, 15, 80, 8);
  add_body(
      mesh, {-4.8f, 0.35f, -1.25f}, {4.8f, 3.0f, 1.25f}, 0.2f, n,
      [&](glm::vec3 p, const glm::vec3& c) {
        glm::vec3 color = c.y > 0.05f && c.y < 0.75f ? cabin_color({c.x, 0, c.z}, paint, 7) : paint;
        if (c.y < -0.85f) color = kRubber * 2.0f;
        p.x -= 0.15f * (0.5f + 0.5f * c.y) * c.x * c.x * c.x;
        return BuiltVertex{p, color};
      });
  add_wheels(mesh, {-3.0f, 3.2f}, 1.08f, 0.48f, 0.3f, n);
  add_lamps(mesh, 4.78f, -4.78f, 0.85f, 0.95f, std::max(1, n / 4));
  add_mirrors(mesh, {4.6f, 2.0f, 1.25f}, 0.4f, std::max(1, n / 4));
  return mesh;
}

}  // namespace

Mesh make_vehicle(VehicleKind kind, const glm::vec3& paint, int triangles) {
  switch (kind) {
    case VehicleKind::car:
      return make_car(paint, triangles);
    case VehicleKind::truck:
      return make_truck(paint, triangles);
    case VehicleKind::bus:
      return make_bus(paint, triangles);
  }
  return {};
}

}  // namespace rilievo
