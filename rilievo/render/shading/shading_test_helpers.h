// Shading as appendix B of the glTF 2.0 specification writes it, in doubles.
#pragma once

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <span>

#include "rilievo/scene/scene.h"

namespace rilievo {

inline glm::dvec3 sky_radiance_by_definition(const Sky& sky, double elevation) {
  const glm::dvec3 above = glm::mix(glm::dvec3(sky.horizon), glm::dvec3(sky.zenith),
                                    std::sqrt(std::max(0.0, elevation)));
  const double t = std::clamp(-elevation / 0.08, 0.0, 1.0);
  return glm::mix(above, glm::dvec3(sky.ground), t * t * (3 - 2 * t));
}

// What arrives of a light at a point, and the unit vector to where it comes from.
struct Incident {
  glm::dvec3 towards, intensity;
};

// Point and spot lights as KHR_lights_punctual has them.
inline Incident incident_by_definition(const Light& light, const glm::dvec3& at) {
  if (light.kind == Light::Kind::directional)
    return {-glm::normalize(glm::dvec3(light.direction)), glm::dvec3(light.intensity)};
  const glm::dvec3 to = glm::dvec3(light.position) - at;
  const double d2 = glm::dot(to, to);
  double strength = 1 / d2;
  if (light.range > 0) {
    const double r4 = std::pow(d2 / (double(light.range) * light.range), 2);
    strength *= std::clamp(1 - r4, 0.0, 1.0);
  }
  if (light.kind == Light::Kind::spot)
    strength *=
        glm::smoothstep(std::cos(double(light.outer_cone)), std::cos(double(light.inner_cone)),
                        -glm::dot(glm::normalize(to), glm::dvec3(light.direction)));
  return {glm::normalize(to), strength * glm::dvec3(light.intensity)};
}

// Light towards v of a surface with normal n.
inline glm::dvec3 shade_by_definition(const Material& m, std::span<const Incident> lights,
                                      const Sky& sky, const glm::dvec3& n, const glm::dvec3& v) {
  const glm::dvec3 base(m.base_color);
  const glm::dvec3 f0 = glm::mix(glm::dvec3(0.04), base, double(m.metallic));
  const glm::dvec3 diffuse = base * (1.0 - m.metallic);
  const double alpha = double(m.roughness) * m.roughness, a2 = alpha * alpha;
  const double n_v = std::max(1e-4, glm::dot(n, v));
  glm::dvec3 light(0);
  for (const Incident& incident : lights) {
    const glm::dvec3& l = incident.towards;
    const double n_l = glm::dot(n, l);
    if (n_l <= 0) continue;
    const glm::dvec3 h = glm::normalize(l + v);
    const double n_h = glm::dot(n, h), v_h = glm::dot(v, h);
    const double d = a2 / (glm::pi<double>() * std::pow(n_h * n_h * (a2 - 1) + 1, 2));
    const double g = 0.5 / (n_l * std::sqrt(n_v * n_v * (1 - a2) + a2) +
                            n_v * std::sqrt(n_l * n_l * (1 - a2) + a2));
    const glm::dvec3 f = f0 + (1.0 - f0) * std::pow(1 - v_h, 5);
    light += incident.intensity * n_l * ((1.0 - f) * diffuse / glm::pi<double>() + f * d * g);
  }
  // [Karis 2014] for the part of the sky that is mirrored.
  const double r = m.roughness;
  const glm::dvec3 hemisphere =
      glm::mix(glm::dvec3(sky.ground), 0.5 * glm::dvec3(sky.zenith + sky.horizon), 0.5 + 0.5 * n.y);
  const glm::dvec3 mirrored =
      glm::mix(sky_radiance_by_definition(sky, (2 * glm::dot(n, v) * n - v).y), hemisphere, r);
  const glm::dvec4 k =
      r * glm::dvec4(-1, -0.0275, -0.572, 0.022) + glm::dvec4(1, 0.0425, 1.04, -0.04);
  const double a004 = std::min(k.x * k.x, std::exp2(-9.28 * n_v)) * k.x + k.y;
  // His polynomial falls below 0 where f0 does not reach 0.006: no surface takes light away.
  const glm::dvec3 reflected = glm::max(f0 * (-1.04 * a004 + k.z) + (1.04 * a004 + k.w), 0.0);
  return light + 0.6 * diffuse * hemisphere + reflected * mirrored + glm::dvec3(m.emissive);
}

}  // namespace rilievo
