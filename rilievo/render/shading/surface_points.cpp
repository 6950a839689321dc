#include "rilievo/render/shading/surface_points.h"

#include <cmath>
#include <numbers>

#include "rilievo/core/expects.h"

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/render/shading/surface_points.cpp"
#include <hwy/foreach_target.h>
#include <hwy/highway.h>

HWY_BEFORE_NAMESPACE();
namespace rilievo {
namespace HWY_NAMESPACE {
namespace hn = hwy::HWY_NAMESPACE;
namespace {

#include "rilievo/render/shading/simd_numbers.inl"
// A template over these numbers.
#include "rilievo/render/shading/shading_model.inl"

void append(const TriangleRays& in, const PictureRays& rays, const SurfacePlacement& placement,
            Surfaces& out) {
  const F f;
  const SurfaceMaterial& material = *placement.material;
  for (std::size_t i = 0; i < in.count; i += hn::Lanes(f)) {
    const auto load = [&](const float(&v)[3][TriangleRays::kCapacity]) {
      return Vec3<vfloat>(hn::Load(f, v[0] + i), hn::Load(f, v[1] + i), hn::Load(f, v[2] + i));
    };
    Corners<vfloat> corners;
    for (int k = 0; k < 3; ++k) {
      corners.position[k] = load(in.position[k]);
      if (placement.has_normals) corners.normal[k] = load(in.normal[k]);
      if (placement.has_colors) corners.color[k] = load(in.color[k]);
      if (placement.has_colors && material.blended) corners.alpha[k] = hn::Load(f, in.alpha[k] + i);
      for (int set = 0; set < 2; ++set)
        if (material.uses_uv[set])
          corners.uv[set][k] = {hn::Load(f, in.uv[set][k][0] + i),
                                hn::Load(f, in.uv[set][k][1] + i)};
    }
    const SurfacePoint<vfloat> point = surface_at(rays, placement, load(in.ray), corners);
    const auto store = [&](Surfaces::Field field, vfloat value) {
      hn::StoreU(value.v, f, out.field[field] + out.count + i);
    };
    const auto store3 = [&](Surfaces::Field first, const Vec3<vfloat>& value) {
      store(first, value.x);
      store(Surfaces::Field(first + 1), value.y);
      store(Surfaces::Field(first + 2), value.z);
    };
    store3(Surfaces::base_r, point.base);
    store3(Surfaces::normal_x, point.normal);
    store3(Surfaces::relative_x, point.relative);
    store3(Surfaces::view_x, point.view);
    store3(Surfaces::emissive_r, point.emissive);
    store(Surfaces::roughness, point.roughness);
    store(Surfaces::metallic, point.metallic);
    store(Surfaces::occlusion, point.occlusion);
    store(Surfaces::lit, point.lit);
    store(Surfaces::alpha, point.alpha);
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

void append_surfaces(const TriangleRays& triangles, const PictureRays& rays,
                     const SurfacePlacement& placement, Surfaces& surfaces) {
  RILIEVO_EXPECTS(triangles.count <= TriangleRays::kMaxCount);
  RILIEVO_EXPECTS(surfaces.count + triangles.count <= Surfaces::kMaxCount);
  RILIEVO_EXPECTS(placement.material != nullptr);
  HWY_DYNAMIC_DISPATCH(append)(triangles, rays, placement, surfaces);
}

}  // namespace rilievo
#endif
