// The data of the shading model (shading_model.inl) besides the triangles.
//
// Plain numbers, constant over a picture or over one of its meshes. Positions are relative to the
// camera's position, in world axes, metres.
#pragma once

#include <glm/glm.hpp>
#include <optional>
#include <span>

#include "rilievo/core/camera.h"
#include "rilievo/render/shading/surface_materials.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// The rays of a picture, for positions in texels from the lower left corner. If the rays meet in
// the camera's position, a ray is its direction from there; if they are parallel, it is its
// starting point.
struct PictureRays {
  glm::vec3 first{0.0f}, per_x{0.0f}, per_y{0.0f};  // first: at the centre of the lower left texel
  glm::vec3 axis{0, 0, -1};                         // the camera's viewing direction, unit
  float footprint = 1;  // the width over which textures are averaged, in texels
  bool parallel = false;
  // The viewer is far away, in the direction in which the rays meet (a back-perspective picture).
  bool towards_apex = false;

  // The ray at a position.
  [[nodiscard]] glm::vec3 through(float x, float y) const {
    return first + (x - 0.5f) * per_x + (y - 0.5f) * per_y;
  }
};

// The rays of a camera.
[[nodiscard]] PictureRays picture_rays(const Camera& camera);

// The placement of a mesh, and its material.
struct SurfacePlacement {
  glm::mat4 relative_from_mesh{1.0f};
  glm::mat3 normal_from_mesh{1.0f};  // normals can get any length and either side
  bool has_normals = false, has_colors = false;
  bool unlit = false;  // the material is, or points or lines have no normals
  const SurfaceMaterial* material = nullptr;
  // Material::code_from_mesh, from the space that relative_from_mesh maps from.
  std::optional<glm::mat4x3> code_from_position;
};

// The placement of a mesh.
[[nodiscard]] SurfacePlacement place_surface(const Mesh& mesh, const SurfaceMaterial& material,
                                             const glm::mat4& relative_from_mesh);

// The lights of a Scene for an eye at `eye` (world space).
struct SurfaceLights {
  std::span<const Light> lights;  // not empty
  glm::dvec3 eye{0.0};
  Sky sky;
};

}  // namespace rilievo
