#include "rilievo/render/rays/stroke_hits.h"

#include <algorithm>
#include <cmath>
#include <string>

#include "rilievo/core/depth.h"
#include "rilievo/render/raster/raster_instances.h"
#include "rilievo/render/shading/shading_model.h"
#include "rilievo/render/shading/stroke_points.h"

namespace rilievo {

namespace shading_model {
// A template over these numbers.
#include "rilievo/render/raster/stroke_shapes.inl"
}  // namespace shading_model

namespace {

using StrokeVec = shading_model::Vec3<float>;

bool has_strokes(const Scene& scene) {
  return std::any_of(scene.meshes.begin(), scene.meshes.end(),
                     [](const Mesh& mesh) { return mesh.primitive != Primitive::triangles; });
}

// Calls with(shape, reach) for the disc or the line.
template <class With>
auto with_shape(const RasterInstance& instance, const Camera& camera, std::uint32_t index,
                const With& with) {
  const std::uint32_t* corner =
      instance.indices + std::size_t(corners_of(instance.primitive)) * index;
  const StrokeVec p(instance.positions[corner[0]]);
  if (instance.primitive == Primitive::points) {
    shading_model::Disc<float> disc;
    const auto reach = shading_model::make_disc(instance, p, disc);
    return with(disc, reach);
  }
  shading_model::Line<float> line;
  const auto reach = shading_model::make_line(instance, float(camera.width), float(camera.height),
                                              p, StrokeVec(instance.positions[corner[1]]), line);
  return with(line, reach);
}

}  // namespace

Result<> strokes_fit(const Scene& scene, const Camera& camera) {
  if (std::max(camera.width, camera.height) <= SampleRaster::kMaxSize || !has_strokes(scene))
    return Done{};
  return Error{scene.name, "points and lines are drawn in pictures of at most " +
                               std::to_string(SampleRaster::kMaxSize) + " pixels a side"};
}

StrokeHits::StrokeHits(const RayScene& rays, const Camera& camera, std::span<const bool> objects)
    : camera_(camera), rays_(picture_rays(camera)), objects_(objects) {
  const Scene& scene = rays.scene();
  if (!has_strokes(scene)) return;
  for (std::uint32_t o = 0; o < scene.objects.size(); ++o) {
    if (!objects.empty() && !objects[o]) continue;
    const Model& model = scene.models[std::size_t(scene.objects[o].model)];
    const glm::mat4 relative_from_model = relative_to(camera.position(), rays.poses()[o]);
    for (int p = 0; p < int(model.parts.size()); ++p) {
      const Part& part = model.parts[std::size_t(p)];
      const Mesh& mesh = scene.meshes[std::size_t(part.mesh)];
      if (mesh.primitive == Primitive::triangles) continue;
      placed_.push_back({&mesh,
                         place_surface(mesh, rays.materials().of_mesh(part.mesh),
                                       relative_from_model * part.model_from_mesh),
                         0, std::uint32_t(mesh.primitives()), o});
      parts_.push_back(p);
    }
  }
  std::vector<RasterMask> no_masks;
  make_instances(camera, placed_, instances_, no_masks);
  for (RasterInstance& instance : instances_)
    instance.min_w = camera.projection == Projection::parallel ? 0 : float(camera.z_near);

  columns_ = (camera.width + kCell - 1) / kCell, rows_ = (camera.height + kCell - 1) / kCell;
  first_.assign(std::size_t(columns_) * std::size_t(rows_) + 1, 0);
  const auto for_each_cell = [&](const auto& visit) {
    for (std::uint32_t m = 0; m < instances_.size(); ++m)
      for (std::uint32_t i = 0; i < instances_[m].triangles; ++i)
        with_shape(instances_[m], camera_, i, [&](const auto&, const auto& reach) {
          if (!(reach.w > instances_[m].min_w)) return;
          const auto cell = [](float texel, int count) {
            return int(std::clamp(std::floor(texel / kCell), -1.0f, float(count)));
          };
          const int x0 = std::max(cell(reach.x0, columns_), 0), x1 = cell(reach.x1, columns_);
          const int y0 = std::max(cell(reach.y0, rows_), 0), y1 = cell(reach.y1, rows_);
          for (int y = y0; y <= std::min(y1, rows_ - 1); ++y)
            for (int x = x0; x <= std::min(x1, columns_ - 1); ++x)
              visit(std::size_t(y) * std::size_t(columns_) + std::size_t(x), Stroke{m, i});
        });
  };
  for_each_cell([&](std::size_t cell, const Stroke&) { ++first_[cell + 1]; });
  for (std::size_t i = 1; i < first_.size(); ++i) first_[i] += first_[i - 1];
  strokes_.resize(first_.back());
  std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
  for_each_cell([&](std::size_t cell, const Stroke& stroke) { strokes_[next[cell]++] = stroke; });
}

// Raster positions of cameras count from the top, those of the rasteriser from the bottom.
bool StrokeHits::covers(const Stroke& stroke, float x, float y) const {
  return with_shape(instances_[stroke.mesh], camera_, stroke.index,
                    [&](const auto& shape, const auto&) { return bool(shape.covers(x, y)); });
}

double StrokeHits::eye_z(const Stroke& stroke, const glm::dvec2& raster) const {
  const glm::vec3 ray = rays_.through(float(raster.x), float(double(camera_.height) - raster.y));
  const PlacedMesh& placed = placed_[stroke.mesh];
  const StrokePoint met = stroke_at(rays_, ray, *placed.mesh, placed.surface, stroke.index);
  return glm::dot(glm::dvec3(met.relative), glm::dvec3(rays_.axis));
}

template <class Visit>
void StrokeHits::visit_at(const glm::dvec2& raster, const Visit& visit) const {
  if (strokes_.empty()) return;
  const double up = double(camera_.height) - raster.y;
  const int column = int(std::floor(raster.x / kCell)), row = int(std::floor(up / kCell));
  if (column < 0 || row < 0 || column >= columns_ || row >= rows_) return;
  const std::size_t cell = std::size_t(row) * std::size_t(columns_) + std::size_t(column);
  for (std::uint32_t i = first_[cell]; i < first_[cell + 1]; ++i)
    if (covers(strokes_[i], float(raster.x), float(up)))
      if (const double z = eye_z(strokes_[i], raster); z >= camera_.z_near && z <= camera_.z_far)
        visit(strokes_[i], z);
}

std::optional<RayHit> StrokeHits::nearer(const glm::dvec2& raster, std::optional<RayHit> hit,
                                         float from) const {
  const bool back = camera_.keeps_farthest();
  const double start = back ? camera_.z_far : camera_.z_near;
  const double step = (back ? camera_.z_near : camera_.z_far) - start;
  visit_at(raster, [&](const Stroke& stroke, double z) {
    const float distance = float((z - start) / step);
    if (!(distance > from) || (hit && !(distance < hit->distance))) return;
    hit.emplace();
    hit->distance = distance;
    hit->object = placed_[stroke.mesh].object + 1;
    hit->part = parts_[stroke.mesh];
    hit->triangle = stroke.index;
    const glm::vec3 ray = rays_.through(float(raster.x), float(double(camera_.height) - raster.y));
    hit->normal = (back ? 1.0f : -1.0f) * (rays_.parallel ? rays_.axis : glm::normalize(ray));
  });
  return hit;
}

float StrokeHits::farthest_eye_z(const glm::dvec2& raster) const {
  double farthest = -1;
  visit_at(raster, [&](const Stroke&, double z) { farthest = std::max(farthest, z); });
  return farthest < 0 ? kNoDepth : float(farthest);
}

}  // namespace rilievo
