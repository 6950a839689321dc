#include "rilievo/scene/position_colors.h"

#include <cmath>
#include <glm/gtc/quaternion.hpp>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

// What decides where the surface is drawn, and nothing else.
Material coded(const Material& from, const glm::mat4x3& code_from_mesh) {
  Material material;
  material.name = from.name;
  material.alpha_mode = from.alpha_mode;
  material.alpha_cutoff = from.alpha_cutoff;
  material.double_sided = from.double_sided;
  material.unlit = true;
  material.code_from_mesh = code_from_mesh;
  if (from.alpha_mode == AlphaMode::mask) {
    material.base_color.a = from.base_color.a;
    material.base_color_texture = from.base_color_texture;
  }
  if (from.alpha_mode == AlphaMode::blend) material.base_color.a = 0;
  return material;
}

}  // namespace

const glm::dmat3& code_directions() {
  // Any rotation that turns no axis into a plane of two axes.
  static const glm::dmat3 directions(
      glm::mat3_cast(glm::angleAxis(0.8, glm::normalize(glm::dvec3(1, 2, 3)))));
  return directions;
}

Scene with_position_colors(const Scene& scene, std::span<const double> half_periods) {
  RILIEVO_EXPECTS(half_periods.size() == scene.models.size());
  Scene out = scene;
  out.materials.clear();
  // A mesh in several parts has a code for each of them.
  std::vector<bool> taken(scene.meshes.size());
  const Material fallback;
  for (std::size_t m = 0; m < out.models.size(); ++m) {
    RILIEVO_EXPECTS(half_periods[m] > 0);
    const glm::dmat3 code_from_model = code_directions() / half_periods[m];
    for (Part& part : out.models[m].parts) {
      const Mesh& mesh = scene.meshes[std::size_t(part.mesh)];
      const glm::dmat4 place(part.model_from_mesh);
      const glm::dmat3 linear = code_from_model * glm::dmat3(place);
      const glm::dvec3 origin = code_from_model * glm::dvec3(place[3]);
      const glm::mat4x3 code{glm::vec3(linear[0]), glm::vec3(linear[1]), glm::vec3(linear[2]),
                             glm::vec3(origin)};
      if (taken[std::size_t(part.mesh)]) {
        out.meshes.push_back(mesh);
        part.mesh = int(out.meshes.size()) - 1;
      } else {
        taken[std::size_t(part.mesh)] = true;
      }
      out.meshes[std::size_t(part.mesh)].material = int(out.materials.size());
      out.materials.push_back(
          coded(mesh.material < 0 ? fallback : scene.materials[std::size_t(mesh.material)], code));
    }
  }
  // Meshes that no model shows.
  for (std::size_t i = 0; i < scene.meshes.size(); ++i)
    if (!taken[i]) out.meshes[i].material = -1;
  return out;
}

glm::dvec3 decode_position(const glm::u8vec4& color, const glm::dvec3& guess, double half_period,
                           int candidate) {
  const glm::dvec3 at = code_directions() * guess / half_period;
  glm::dvec3 found;
  for (int k = 0; k < 3; ++k) {
    const double byte = color[k] / 255.0;
    // On a rising slope 2 n + byte, on a falling one 2 n - byte.
    const double side = candidate >> k & 1 ? -byte : byte;
    found[k] = 2 * std::round(0.5 * (at[k] - side)) + side;
  }
  return half_period * (glm::transpose(code_directions()) * found);
}

}  // namespace rilievo
