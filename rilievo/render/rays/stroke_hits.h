// Where do single rays of one picture meet points and lines?
//
// Embree does not hold them: how large they are depends on the picture. Here they are sorted into
// the picture's cells, and tested one by one by the formulae that the rasteriser uses
// (render/raster/stroke_shapes.inl). For pictures whose rays are cast one at a time, or meet more
// than one surface; whole frames rasterise. They cast no shadows. Any thread after the constructor.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/core/result.h"
#include "rilievo/render/raster/sample_raster.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/render/shading/seen_triangles.h"

namespace rilievo {

// Can points and lines, if there are any, be rasterised in a picture of this size?
[[nodiscard]] Result<> strokes_fit(const Scene& scene, const Camera& camera);

// The points and lines in a picture.
class StrokeHits {
 public:
  // Of the objects for which `objects` is true (empty: of all). `rays` must outlive it.
  StrokeHits(const RayScene& rays, const Camera& camera, std::span<const bool> objects);

  [[nodiscard]] std::span<const bool> objects() const { return objects_; }
  // `hit`, or what the camera's ray through a raster position meets before it, but beyond `from`:
  // both as multiples of camera_ray().
  [[nodiscard]] std::optional<RayHit> nearer(const glm::dvec2& raster, std::optional<RayHit> hit,
                                             float from = -1) const;
  // eye_z of the last one along the ray; kNoDepth: none.
  [[nodiscard]] float farthest_eye_z(const glm::dvec2& raster) const;

 private:
  static constexpr int kCell = 4;  // texels a side

  struct Stroke {
    std::uint32_t mesh, index;  // of instances_, and its primitive
  };
  template <class Visit>
  void visit_at(const glm::dvec2& raster, const Visit& visit) const;
  [[nodiscard]] bool covers(const Stroke& stroke, float x, float y) const;
  [[nodiscard]] double eye_z(const Stroke& stroke, const glm::dvec2& raster) const;

  Camera camera_;
  PictureRays rays_;
  std::span<const bool> objects_;
  std::vector<PlacedMesh> placed_;
  std::vector<int> parts_;  // of the models, as placed_
  std::vector<RasterInstance> instances_;
  int columns_ = 0, rows_ = 0;
  std::vector<std::uint32_t> first_;  // of each cell, in strokes_
  std::vector<Stroke> strokes_;
};

}  // namespace rilievo
