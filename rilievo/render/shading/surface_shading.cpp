// GGX distribution, Smith visibility, Schlick's Fresnel; ambient light from a two-colour sky, its
// mirror part by the approximation of [Karis 2014, Physically Based Shading on Mobile].
#include "rilievo/render/shading/surface_shading.h"

#include <array>
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

using I = hn::RebindToSigned<F>;

N smoothstep(N from, N to, N x) {
  const N t = clamp((x - from) / (to - from), 0.0f, 1.0f);
  return t * t * (N(3.0f) - N(2.0f) * t);
}

// 2^x for x in [-126, 0]: 2 to a whole number times a Taylor series for what is left, which is at
// most a half: to 3e-6.
N exp2(N x) {
  const F f;
  const I i;
  const N whole = hn::Round(x.v), r = x - whole;
  const N series =
      1.0f + r * (0.69314718f +
                  r * (0.24022651f + r * (0.05550411f + r * (0.00961813f + r * N(0.00133336f)))));
  const auto exponent = hn::ShiftLeft<23>(hn::Add(hn::ConvertTo(i, whole.v), hn::Set(i, 127)));
  return series * N(hn::BitCast(f, exponent));
}

// As shader::kSrgbFromLinear.
N srgb(N c) {
  c = clamp(c, 0.0f, 1.0f);
  const N s = sqrt(c);
  const N curve =
      (((N(-0.30957186f) * s + 0.84279114f) * s - 0.94486092f) * s + 1.44789933f) * s - 0.03700467f;
  return less_then(c, 0.0031308f, N(12.92f) * c, curve);
}

N3 sky_radiance(const Sky& sky, N elevation) {
  const N3 above = mix(N3(sky.horizon), N3(sky.zenith), sqrt(clamp(elevation, 0.0f, 1.0f)));
  return mix(above, N3(sky.ground), smoothstep(0.0f, -0.08f, elevation));
}

// How much of the light's intensity arrives at a position relative to the eye, and the way to it.
N arrives(const Light& light, const glm::dvec3& eye, const N3& relative, N3& l) {
  l = N3(-light.direction);
  if (light.kind == Light::Kind::directional) return 1.0f;
  const N3 to = N3(glm::vec3(glm::dvec3(light.position) - eye)) - relative;
  const N distance2 = max(dot(to, to), 1e-6f);
  l = N(1.0f) / sqrt(distance2) * to;
  N strength = 1.0f;
  if (light.kind == Light::Kind::spot)
    strength = smoothstep(std::cos(light.outer_cone), std::cos(light.inner_cone),
                          N(-1.0f) * dot(l, N3(light.direction)));
  strength = strength / distance2;
  if (light.range > 0.0f) {
    const N r = distance2 / (light.range * light.range);
    strength = strength * clamp(N(1.0f) - r * r, 0.0f, 1.0f);
  }
  return strength;
}

// Light that leaves the surface towards `v`, per unit of light that arrives from `l`, times n.l.
N3 reflected(const N3& n, const N3& v, const N3& l, const N3& diffuse, const N3& f0, N alpha2) {
  const N towards_l = dot(n, l), towards_v = dot(n, v);
  const N n_l = clamp(towards_l, 0.0f, 1.0f), n_v = clamp(towards_v, 1e-4f, 1.0f);
  // With h halfway between l and v, |l + v|^2 = 2 (1 + l.v) = 4 (v.h)^2, and n.h follows.
  const N v_h2 = clamp(N(0.5f) + N(0.5f) * dot(l, v), 1e-6f, 1.0f);
  const N up = max(towards_l + towards_v, 0.0f);
  const N n_h2 = min(N(0.25f) * up * up / v_h2, 1.0f);
  const N d = n_h2 * (alpha2 - 1.0f) + 1.0f;
  const N masked = n_l * sqrt(n_v * n_v * (N(1.0f) - alpha2) + alpha2) +
                   n_v * sqrt(n_l * n_l * (N(1.0f) - alpha2) + alpha2) + 1e-5f;
  constexpr float kPerPi = std::numbers::inv_pi_v<float>;
  const N distribution_visibility = N(0.5f * kPerPi) * alpha2 / (d * d * masked);
  const N m = N(1.0f) - sqrt(v_h2), m2 = m * m;
  const N3 one(glm::vec3(1.0f));
  const N3 fresnel = f0 + (m2 * m2 * m) * (one - f0);
  return n_l * (N(kPerPi) * (diffuse * (one - fresnel)) + distribution_visibility * fresnel);
}

void shade(const SurfaceLights& lights, const Surfaces& in, SurfaceColors& out) {
  const F f;
  const Sky& sky = lights.sky;
  for (std::size_t i = 0; i < in.count; i += hn::Lanes(f)) {
    const auto load = [&](Surfaces::Field field) { return N(hn::Load(f, in.field[field] + i)); };
    const N3 base(load(Surfaces::base_r), load(Surfaces::base_g), load(Surfaces::base_b));
    const N3 n =
        normalize({load(Surfaces::normal_x), load(Surfaces::normal_y), load(Surfaces::normal_z)});
    const N3 relative(load(Surfaces::relative_x), load(Surfaces::relative_y),
                      load(Surfaces::relative_z));
    const N3 v = N(-1.0f) * normalize(relative);
    const N roughness = clamp(load(Surfaces::roughness), 0.045f, 1.0f);
    const N metallic = load(Surfaces::metallic);
    const N3 diffuse = (N(1.0f) - metallic) * base;
    const N3 f0 = mix(N3(glm::vec3(0.04f)), base, metallic);
    const N alpha = roughness * roughness, alpha2 = alpha * alpha;

    N3 light(load(Surfaces::emissive_r), load(Surfaces::emissive_g), load(Surfaces::emissive_b));
    for (const Light& each : lights.lights) {
      N3 l(glm::vec3(0.0f));
      const N strength = arrives(each, lights.eye, relative, l);
      light = light + strength * (N3(each.intensity) * reflected(n, v, l, diffuse, f0, alpha2));
    }

    // The sky as ambient light: diffuse from the hemisphere around n, mirrored part by roughness.
    const N3 hemisphere =
        mix(N3(sky.ground), N3(0.5f * (sky.zenith + sky.horizon)), N(0.5f) + N(0.5f) * n.y);
    const N towards_v = dot(n, v), n_v = clamp(towards_v, 0.0f, 1.0f);
    const N3 mirrored =
        mix(sky_radiance(sky, N(2.0f) * towards_v * n.y - v.y), hemisphere, roughness);
    const N rx = N(1.0f) - roughness, ry = N(0.0425f) - N(0.0275f) * roughness;
    const N rz = N(1.04f) - N(0.572f) * roughness, rw = N(0.022f) * roughness - 0.04f;
    const N a004 = min(rx * rx, exp2(N(-9.28f) * n_v)) * rx + ry;
    const N scale = N(-1.04f) * a004 + rz, bias = N(1.04f) * a004 + rw;
    const N3 ambient =
        N(0.6f) * (diffuse * hemisphere) + (scale * f0 + N3(bias, bias, bias)) * mirrored;
    light = light + ambient;

    const N lit = load(Surfaces::lit);
    hn::Store(srgb(less_then(0.0f, lit, light.x, base.x)).v, f, out.srgb[0] + i);
    hn::Store(srgb(less_then(0.0f, lit, light.y, base.y)).v, f, out.srgb[1] + i);
    hn::Store(srgb(less_then(0.0f, lit, light.z, base.z)).v, f, out.srgb[2] + i);
  }
}

}  // namespace
}  // namespace HWY_NAMESPACE
}  // namespace rilievo
HWY_AFTER_NAMESPACE();

#if HWY_ONCE
namespace rilievo {

HWY_EXPORT(shade);

void shade_surfaces(const SurfaceLights& lights, const Surfaces& surfaces, SurfaceColors& colors) {
  RILIEVO_EXPECTS(!lights.lights.empty() && surfaces.count <= Surfaces::kMost);
  HWY_DYNAMIC_DISPATCH(shade)(lights, surfaces, colors);
}

}  // namespace rilievo
#endif
