#include "rilievo/render/raster/surface_points.h"

#include "rilievo/core/expects.h"

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/render/raster/surface_points.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

#include "rilievo/render/shading/simd_numbers.inl"

void append(const TriangleRays& in, const SurfacePlacement& placement, Surfaces& out) {
  const F f;
  const glm::mat4& m = placement.relative_from_mesh;
  const glm::mat3& normals = placement.normal_from_mesh;
  for (std::size_t i = 0; i < in.count; i += hn::Lanes(f)) {
    const auto load = [&](const float(&v)[3][TriangleRays::kMost]) {
      return N3(hn::Load(f, v[0] + i), hn::Load(f, v[1] + i), hn::Load(f, v[2] + i));
    };
    const auto place = [&](const N3& p) {
      return p.x * N3(glm::vec3(m[0])) + p.y * N3(glm::vec3(m[1])) +
             (p.z * N3(glm::vec3(m[2])) + N3(glm::vec3(m[3])));
    };
    const N3 ray = load(in.ray);
    const N3 a = place(load(in.position[0])), b = place(load(in.position[1])),
             c = place(load(in.position[2]));
    // A ray from the eye divides the triangle as the volumes that it spans with two corners each.
    const N3 facing = cross(b - a, c - a);
    const N sign = less_then(dot(ray, facing), 0.0f, -1.0f, 1.0f);
    N u = max(sign * dot(ray, cross(b, c)), 0.0f), v = max(sign * dot(ray, cross(c, a)), 0.0f),
      w = max(sign * dot(ray, cross(a, b)), 0.0f);
    const N sum = u + v + w;
    const N per_sum = less_then(0.0f, sum, N(1.0f) / sum, 0.0f);
    u = per_sum * u, v = per_sum * v, w = less_then(0.0f, sum, per_sum * w, 1.0f);

    const N3 relative = u * a + v * b + w * c;
    N3 n = facing;
    if (placement.has_normals) {
      const N3 of_mesh = u * load(in.normal[0]) + v * load(in.normal[1]) + w * load(in.normal[2]);
      n = of_mesh.x * N3(normals[0]) + of_mesh.y * N3(normals[1]) + of_mesh.z * N3(normals[2]);
    }
    // Both sides of a thin sheet are lit as seen. Which side that is, the triangle says: at a
    // silhouette the smooth normal of a visible face may already point away.
    n = less_then(0.0f, dot(facing, relative) * dot(facing, n), -1.0f, 1.0f) * n;
    N3 base(placement.base_color);
    if (placement.has_colors)
      base = base * (u * load(in.color[0]) + v * load(in.color[1]) + w * load(in.color[2]));

    const auto store = [&](Surfaces::Field first, const N3& value) {
      float(*field)[Surfaces::kRoom] = out.field + first;
      hn::StoreU(value.x.v, f, field[0] + out.count + i);
      hn::StoreU(value.y.v, f, field[1] + out.count + i);
      hn::StoreU(value.z.v, f, field[2] + out.count + i);
    };
    store(Surfaces::base_r, base);
    store(Surfaces::normal_x, n);
    store(Surfaces::relative_x, relative);
    store(Surfaces::emissive_r, placement.emissive);
    store(Surfaces::roughness,
          N3(placement.roughness, placement.metallic, placement.unlit ? 0.0f : 1.0f));
  }
  out.count += in.count;
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(append);

void append_surfaces(const TriangleRays& rays, const SurfacePlacement& placement,
                     Surfaces& surfaces) {
  RILIEVO_EXPECTS(rays.count <= TriangleRays::kMost);
  RILIEVO_EXPECTS(surfaces.count + rays.count <= Surfaces::kMost);
  HWY_DYNAMIC_DISPATCH(append)(rays, placement, surfaces);
}

}  // namespace rilievo
#endif
