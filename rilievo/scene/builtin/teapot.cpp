// The teapot of Martin Newell (University of Utah, 1975), from its published control points.
//
// 32 bicubic Bezier patches. 24 of them are quarters of surfaces of revolution, whose circles are
// approximated by cubics with handles of 0.56 radii: kept here as their profiles. The other 8 are
// handle and spout, symmetric about z = 0: kept here as the half with z <= 0. In the original z is
// up; here y is, and the front is turned accordingly.

#include <algorithm>
#include <array>
#include <cmath>

#include "rilievo/scene/builtin/mesh_builder.h"
#include "rilievo/scene/builtin/parts.h"

namespace rilievo {
namespace {

using Curve = std::array<glm::vec3, 4>;

glm::vec3 on_curve(const Curve& c, float t) {
  const float s = 1 - t;
  return s * s * s * c[0] + 3 * s * s * t * c[1] + 3 * s * t * t * c[2] + t * t * t * c[3];
}

// Radius and height, from the tip of the lid outwards and down, and under the bottom to its centre.
struct Profile {
  std::array<glm::vec2, 4> points;
  bool pole_at_start, pole_at_end;
};
constexpr Profile kProfiles[] = {
    {{{{0, 3.15f}, {0.8f, 3.15f}, {0, 2.85f}, {0.2f, 2.7f}}}, true, false},        // knob
    {{{{0.2f, 2.7f}, {0.4f, 2.55f}, {1.3f, 2.55f}, {1.3f, 2.4f}}}, false, false},  // lid
    {{{{1.4f, 2.4f}, {1.3375f, 2.53125f}, {1.4375f, 2.53125f}, {1.5f, 2.4f}}},
     false,
     false},                                                                   // rim
    {{{{1.5f, 2.4f}, {1.75f, 1.875f}, {2, 1.35f}, {2, 0.9f}}}, false, false},  // body
    {{{{2, 0.9f}, {2, 0.45f}, {1.5f, 0.225f}, {1.5f, 0.15f}}}, false, false},
    {{{{1.5f, 0.15f}, {1.5f, 0.075f}, {1.425f, 0}, {0, 0}}}, false, true},  // bottom
};

// Handle and spout: rows along the tube, each half around it, x, height, and depth towards -z.
using Row = std::array<glm::vec3, 4>;
constexpr Row row(glm::vec2 inner, glm::vec2 outer, float depth) {
  return {{{inner.x, inner.y, 0},
           {inner.x, inner.y, -depth},
           {outer.x, outer.y, -depth},
           {outer.x, outer.y, 0}}};
}
constexpr std::array<Row, 7> kHandle = {
    row({-1.6f, 2.025f}, {-1.5f, 2.25f}, 0.3f), row({-2.3f, 2.025f}, {-2.5f, 2.25f}, 0.3f),
    row({-2.7f, 2.025f}, {-3.0f, 2.25f}, 0.3f), row({-2.7f, 1.8f}, {-3.0f, 1.8f}, 0.3f),
    row({-2.7f, 1.575f}, {-3.0f, 1.35f}, 0.3f), row({-2.5f, 1.125f}, {-2.65f, 0.9375f}, 0.3f),
    row({-2.0f, 0.9f}, {-1.9f, 0.6f}, 0.3f)};
constexpr std::array<Row, 7> kSpout = {
    row({1.7f, 1.425f}, {1.7f, 0.6f}, 0.66f),       row({2.6f, 1.425f}, {3.1f, 0.825f}, 0.66f),
    row({2.3f, 2.1f}, {2.4f, 2.025f}, 0.25f),       row({2.7f, 2.4f}, {3.3f, 2.4f}, 0.25f),
    row({2.8f, 2.475f}, {3.525f, 2.49375f}, 0.25f), row({2.9f, 2.475f}, {3.45f, 2.5125f}, 0.15f),
    row({2.8f, 2.4f}, {3.2f, 2.4f}, 0.15f)};

// The unit circle as four Bezier quarters, not as a circle: the teapot is what was published.
glm::vec2 around(float u) {
  constexpr float k = 0.56f;
  const float quarters = 4 * u;
  const int q = std::min(3, int(quarters));
  const glm::vec3 p = on_curve({{{1, 0, 0}, {1, k, 0}, {k, 1, 0}, {0, 1, 0}}}, quarters - float(q));
  switch (q) {
    case 0:
      return {p.x, p.y};
    case 1:
      return {-p.y, p.x};
    case 2:
      return {-p.x, -p.y};
    default:
      return {p.y, -p.x};
  }
}

void add_profile(Mesh& mesh, const Profile& profile, int nu, int nv) {
  Curve curve;
  for (int i = 0; i < 4; ++i) curve[i] = glm::vec3(profile.points[i], 0);
  GridShape shape;
  shape.nu = nu, shape.nv = nv, shape.closed_u = true;
  shape.pole_at_start = profile.pole_at_start, shape.pole_at_end = profile.pole_at_end;
  add_grid(mesh, shape, [&](float u, float v) {
    const glm::vec2 c = around(u);
    const glm::vec3 p = on_curve(curve, v);
    return BuiltVertex{{p.x * c.x, p.y, p.x * c.y}};
  });
}

// Two patches along the tube, two halves around it. Both tubes' rows run the way that makes outside
// lie along u x v when u runs from outer to inner on the side of -z.
void add_pipe(Mesh& mesh, const std::array<Row, 7>& rows, int nu, int nv) {
  GridShape shape;
  shape.nu = nu, shape.nv = nv, shape.closed_u = true;
  add_grid(mesh, shape, [&](float u, float v) {
    const int patch = v < 0.5f ? 0 : 3;
    const float along = v < 0.5f ? 2 * v : 2 * v - 1;
    const bool mirrored = u < 0.5f;
    const float across = mirrored ? 2 * u : 2 - 2 * u;
    Curve curve;
    for (int i = 0; i < 4; ++i) curve[i] = on_curve(rows[std::size_t(patch + i)], across);
    glm::vec3 p = on_curve(curve, along);
    if (mirrored) p.z = -p.z;
    return BuiltVertex{p};
  });
}

}  // namespace

Mesh make_teapot(int triangles) {
  // With nu cells around and nv along each Bezier segment: 6 profiles of 2 nu nv triangles less
  // nu at each of 2 poles, and 2 pipes of two segments with nu / 2 cells around: 4 * nu nv.
  //   triangles = 16 nu nv - 2 nu
  // Cells are about square when there are four times as many around as along a segment.
  const int nv = std::max(2, int(std::lround(std::sqrt(triangles / 64.0))));
  const int nu = std::max(8, 2 * int(std::lround(triangles / (16.0 * nv - 2) / 2)));
  Mesh mesh;
  mesh.name = "teapot";
  for (const Profile& profile : kProfiles) add_profile(mesh, profile, nu, nv);
  add_pipe(mesh, kHandle, nu / 2, 2 * nv);
  add_pipe(mesh, kSpout, nu / 2, 2 * nv);
  return mesh;
}

}  // namespace rilievo
