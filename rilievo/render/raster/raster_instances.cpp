#include "rilievo/render/raster/raster_instances.h"

#include "rilievo/core/linear_maps.h"

namespace rilievo {

RasterStrokes make_strokes(const Camera& camera, const Mesh& mesh,
                           const glm::mat4& relative_from_mesh) {
  const auto& [left, right, bottom, top] = camera.window;
  RasterStrokes strokes;
  strokes.radius = float(0.5 * double(mesh.width) * smallest_stretch(relative_from_mesh));
  strokes.radius_px = 0.5f * mesh.width_px * camera.texels_per_pixel;
  strokes.per_unit = {camera.width / (right - left), camera.height / (top - bottom)};
  strokes.corner = {left, bottom};
  strokes.parallel = camera.projection == Projection::parallel;
  if (!strokes.parallel)
    strokes.z_per_inverse_w = float(-camera.z_near * camera.z_far / (camera.z_far - camera.z_near));
  return strokes;
}

void keep_farthest(RasterInstance& instance) {
  instance.front = instance.back = true;
  instance.row_z = instance.row_w - instance.row_z;
  instance.strokes.z_per_inverse_w *= -1, instance.strokes.clamps = true;
}

void make_instances(const Camera& camera, std::span<const PlacedMesh> placed,
                    std::vector<RasterInstance>& instances, std::vector<RasterMask>& masks) {
  const glm::dmat4 clip = glm::transpose(clip_from_relative(camera));
  // The rows of raster_from_relative, before the division.
  const glm::dvec4 x = 0.5 * camera.width * (clip[0] + clip[3]),
                   y = 0.5 * camera.height * (clip[1] + clip[3]), z = 0.5 * (clip[2] + clip[3]);
  instances.clear();
  masks.resize(placed.size());
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const PlacedMesh& p = placed[i];
    const SurfaceMaterial& material = *p.surface.material;
    const glm::dmat4 by(p.surface.relative_from_mesh);
    RasterInstance instance;
    instance.primitive = p.mesh->primitive;
    if (instance.primitive != Primitive::triangles)
      instance.strokes = make_strokes(camera, *p.mesh, p.surface.relative_from_mesh);
    instance.positions = p.mesh->positions.data();
    instance.indices = p.mesh->indices.data();
    instance.triangles = p.triangles;
    instance.first_triangle = p.first_triangle;
    instance.row_x = glm::vec4(x * by), instance.row_y = glm::vec4(y * by);
    instance.row_z = glm::vec4(z * by), instance.row_w = glm::vec4(clip[3] * by);
    const bool mirrored = is_mirroring(glm::dmat3(p.surface.relative_from_mesh));
    instance.front = material.double_sided || !mirrored;
    instance.back = material.double_sided || mirrored;
    static_assert(SampleRaster::kPiece == Mesh::kRun);
    instance.boxes = p.mesh->run_bounds;
    if (material.masked) {
      masks[i] = mask_of(*p.mesh, material);
      instance.mask = &masks[i];
    }
    instances.push_back(instance);
  }
}

}  // namespace rilievo
