#include "rilievo/render/rays/hit_surface.h"

#include "rilievo/render/shading/stroke_points.h"

namespace rilievo {
namespace {

const Part& part_at_hit(const RayScene& rays, const RayHit& hit) {
  const Scene& scene = rays.scene();
  return scene.models[std::size_t(scene.objects[hit.object - 1].model)]
      .parts[std::size_t(hit.part)];
}

}  // namespace

int mesh_of_hit(const RayScene& rays, const RayHit& hit) { return part_at_hit(rays, hit).mesh; }

const SurfaceMaterial& surface_material(const RayScene& rays, const RayHit& hit) {
  return rays.materials().of_mesh(part_at_hit(rays, hit).mesh);
}

shading_model::SurfacePoint<float> surface_of_hit(const RayScene& rays, const RayHit& hit,
                                                  const PictureRays& picture, const glm::vec3& ray,
                                                  const glm::dvec3& eye) {
  const Part& part = part_at_hit(rays, hit);
  const Mesh& mesh = rays.scene().meshes[std::size_t(part.mesh)];
  const SurfacePlacement placement =
      place_surface(mesh, rays.materials().of_mesh(part.mesh),
                    relative_to(eye, rays.poses()[hit.object - 1]) * part.model_from_mesh);
  if (mesh.primitive != Primitive::triangles) {
    const StrokePoint met = stroke_at(picture, ray, mesh, placement, hit.triangle);
    const FacingCorners facing = facing_corners(picture, met.relative);
    const auto mixed = [&](const auto& values) {
      return glm::mix(values[met.vertex[0]], values[met.vertex[1]], met.share);
    };
    shading_model::Corners<float> corners;
    for (int k = 0; k < 3; ++k) {
      corners.position[k] = facing.at[k];
      corners.normal[k] = placement.has_normals ? mixed(mesh.normals) : glm::vec3(0);
      corners.color[k] = placement.has_colors ? glm::vec3(mixed(mesh.colors)) : glm::vec3(0);
      for (int set = 0; set < 2; ++set) {
        const glm::vec2 uv = mesh.uv[set].empty() ? glm::vec2(0) : mixed(mesh.uv[set]);
        corners.uv[set][k] = {uv.x, uv.y};
      }
    }
    return shading_model::surface_at<float>(picture, unplaced(placement), ray, corners);
  }
  const std::uint32_t* corner = &mesh.indices[3 * std::size_t(hit.triangle)];
  shading_model::Corners<float> corners;
  for (int k = 0; k < 3; ++k) {
    const std::uint32_t at = corner[k];
    corners.position[k] = mesh.positions[at];
    corners.normal[k] = placement.has_normals ? mesh.normals[at] : glm::vec3(0);
    corners.color[k] = placement.has_colors ? glm::vec3(mesh.colors[at]) : glm::vec3(0);
    for (int set = 0; set < 2; ++set) {
      const glm::vec2 uv = mesh.uv[set].empty() ? glm::vec2(0) : mesh.uv[set][at];
      corners.uv[set][k] = {uv.x, uv.y};
    }
  }
  return shading_model::surface_at<float>(picture, placement, ray, corners);
}

}  // namespace rilievo
