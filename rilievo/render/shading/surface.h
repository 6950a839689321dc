// What does the shading model (shading_model.inl) need to know besides the triangles?
//
// Plain numbers, uniform over a picture or over one of its meshes. Positions are relative to the
// camera's position, in world axes, metres.
#pragma once

#include <glm/glm.hpp>
#include <span>

#include "rilievo/core/camera.h"
#include "rilievo/render/shading/surface_materials.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// The rays of a picture. Those that meet in the camera's position are ways from there; parallel
// ones are where they start. Texels count from the lower left one.
struct PictureRays {
  glm::vec3 first{0.0f}, per_x{0.0f}, per_y{0.0f};  // first: of the lower left texel's middle
  glm::vec3 axis{0, 0, -1};                         // the camera's forward direction, unit
  bool parallel = false;
  // Seen from afar, towards where the rays meet (a back-perspective picture).
  bool towards_apex = false;

  // Of a place in texels from the lower left corner.
  [[nodiscard]] glm::vec3 through(float x, float y) const {
    return first + (x - 0.5f) * per_x + (y - 0.5f) * per_y;
  }
};

[[nodiscard]] PictureRays picture_rays(const Camera& camera);

// How a mesh is placed, and what all of it is made of.
struct SurfacePlacement {
  glm::mat4 relative_from_mesh{1.0f};
  glm::mat3 normal_from_mesh{1.0f};  // to any length, to either side
  bool has_normals = false, has_colors = false;
  const SurfaceMaterial* material = nullptr;
};

[[nodiscard]] SurfacePlacement place_surface(const Mesh& mesh, const SurfaceMaterial& material,
                                             const glm::mat4& relative_from_mesh);

// The lights of a Scene as an eye at `eye` (world) needs them.
struct SurfaceLights {
  std::span<const Light> lights;  // not empty
  glm::dvec3 eye{0.0};
  Sky sky;
};

// Linear light of a byte of sRGB: 256 numbers.
[[nodiscard]] const float* linear_of_srgb_bytes();

}  // namespace rilievo
