#include "rilievo/render/shading/surface.h"

#include <algorithm>

#include "rilievo/core/linear_maps.h"

namespace rilievo {

PictureRays picture_rays(const Camera& camera) {
  const glm::dmat3 axes(camera.world_from_eye);
  const ImageWindow& w = camera.window;
  const glm::dvec3 per_x = (w.right - w.left) / camera.width * axes[0];
  const glm::dvec3 per_y = (w.top - w.bottom) / camera.height * axes[1];
  PictureRays rays;
  rays.parallel = camera.projection == Projection::parallel;
  rays.towards_apex = camera.keeps_farthest();
  const glm::dvec3 corner = axes * glm::dvec3(w.left, w.bottom, rays.parallel ? 0 : -1);
  rays.first = glm::vec3(corner + 0.5 * (per_x + per_y));
  rays.per_x = glm::vec3(per_x), rays.per_y = glm::vec3(per_y);
  rays.axis = glm::vec3(camera.forward());
  return rays;
}

SurfacePlacement place_surface(const Mesh& mesh, const SurfaceMaterial& material,
                               const glm::mat4& m) {
  SurfacePlacement surface;
  surface.relative_from_mesh = m;
  // To which side normals point is found out with the triangle (shading_model.inl). Their lengths
  // are near 1 however small the mesh is placed, so that their squares are numbers.
  const glm::dmat3 normals = normal_map(glm::dmat3(m));
  const double longest =
      std::max({glm::length(normals[0]), glm::length(normals[1]), glm::length(normals[2])});
  surface.normal_from_mesh = glm::mat3(longest > 0 ? normals / longest : normals);
  surface.has_normals = !mesh.normals.empty();
  surface.has_colors = !mesh.colors.empty();
  surface.material = &material;
  surface.unlit =
      material.unlit || (mesh.primitive != Primitive::triangles && mesh.normals.empty());
  surface.code_from_position = material.code_from_mesh;
  return surface;
}

}  // namespace rilievo
