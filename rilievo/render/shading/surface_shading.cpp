#include "rilievo/render/shading/surface_shading.h"

#include <cmath>
#include <numbers>

#include "rilievo/core/expects.h"

// This file is compiled once for each instruction set.
#undef HWY_TARGET_INCLUDE
#define HWY_TARGET_INCLUDE "rilievo/render/shading/surface_shading.cpp"
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

void shade(const SurfaceLights& lights, const Surfaces& in, ColorScale scale, SurfaceColors& out) {
  const F f;
  for (std::size_t i = 0; i < in.count; i += hn::Lanes(f)) {
    const auto load = [&](Surfaces::Field field) {
      return vfloat(hn::Load(f, in.field[field] + i));
    };
    const auto load3 = [&](Surfaces::Field first) {
      return Vec3<vfloat>(load(first), load(Surfaces::Field(first + 1)),
                          load(Surfaces::Field(first + 2)));
    };
    SurfacePoint<vfloat> point;
    point.base = load3(Surfaces::base_r);
    point.normal = load3(Surfaces::normal_x);
    point.relative = load3(Surfaces::relative_x);
    point.view = load3(Surfaces::view_x);
    point.emissive = load3(Surfaces::emissive_r);
    point.roughness = load(Surfaces::roughness);
    point.metallic = load(Surfaces::metallic);
    point.occlusion = load(Surfaces::occlusion);
    point.lit = load(Surfaces::lit);
    const Vec3<vfloat> light = shade_point(lights, point);
    const auto store = [&](vfloat c, float* to) {
      hn::Store(scale == ColorScale::srgb ? srgb_from_linear(c).v : c.v, f, to + i);
    };
    store(light.x, out.rgb[0]);
    store(light.y, out.rgb[1]);
    store(light.z, out.rgb[2]);
  }
}

void pack(const Surfaces& in, const SurfaceColors& colors, std::uint32_t* out) {
  const F f;
  const I i;
  const hn::RebindToUnsigned<F> u;
  static_assert(Surfaces::kMaxCount % 16 == 0, "vectors are stored whole");
  for (std::size_t k = 0; k < in.count; k += hn::Lanes(f)) {
    const vfloat alpha = clamp(vfloat(hn::Load(f, in.field[Surfaces::alpha] + k)), 0.0f, 1.0f);
    const auto byte_of = [&](vfloat c) { return hn::ConvertTo(i, (c * 255.0f + 0.5f).v); };
    const auto part = [&](int c) {
      return byte_of(vfloat(hn::Load(f, colors.rgb[c] + k)) * alpha);
    };
    const auto low = hn::Or(part(0), hn::ShiftLeft<8>(part(1)));
    const auto high = hn::Or(hn::ShiftLeft<16>(part(2)), hn::ShiftLeft<24>(byte_of(alpha)));
    hn::StoreU(hn::BitCast(u, hn::Or(low, high)), u, out + k);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(shade);
HWY_EXPORT(pack);

void shade_surfaces(const SurfaceLights& lights, const Surfaces& surfaces, ColorScale scale,
                    SurfaceColors& colors) {
  RILIEVO_EXPECTS(!lights.lights.empty() && surfaces.count <= Surfaces::kMaxCount);
  HWY_DYNAMIC_DISPATCH(shade)(lights, surfaces, scale, colors);
}

void premultiplied_bytes(const Surfaces& surfaces, const SurfaceColors& colors,
                         std::uint32_t* bytes) {
  HWY_DYNAMIC_DISPATCH(pack)(surfaces, colors, bytes);
}

}  // namespace rilievo
#endif
