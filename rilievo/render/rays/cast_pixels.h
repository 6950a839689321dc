// What do some of a frame's pixels show, by rays?
//
// As PictureCaster, but only where asked: for frames that come from elsewhere but for some pixels.
// The same samples and surfaces. All cores; the result does not depend on the number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/render/shading/seen_triangles.h"

namespace rilievo {

// A pixel of a frame, y from the top.
struct FramePixel {
  std::uint16_t x, y;
};

// What the ray through the middle of a pixel meets within the frame's range of depths, of the
// objects for which `objects` is true (empty: of all). Its eye_z is z_near and the hit's distance.
[[nodiscard]] std::optional<RayHit> hit_at_pixel(const RayScene& rays, const Camera& frame,
                                                 const FramePixel& pixel,
                                                 std::span<const bool> objects = {});

// Casts rays of single pixels. Keeps its buffers.
class PixelCaster {
 public:
  // `scene` must outlive the object, and be of RayParts::opaque.
  explicit PixelCaster(const RayScene& scene);
  ~PixelCaster();

  // Allocates what cast() needs for so many samples, so that it does not wait for new pages.
  void take_memory(std::size_t samples);

  // Finds 1 or 4 samples of each pixel, of `objects` (indices; in any order). Requires a
  // perspective camera.
  void cast(const Camera& camera, int samples, std::span<const FramePixel> pixels,
            std::span<const std::uint32_t> objects);

  // The samples, those of one pixel one after the other: 1 / eye_z, or 0 where nothing is; and the
  // triangle there. Valid until the next cast.
  [[nodiscard]] std::span<const float> inverse_z() const { return inverse_z_; }
  [[nodiscard]] std::span<const std::uint32_t> triangles() const { return triangles_; }
  // The meshes, in the order of their triangles; and what is needed to shade them as bytes.
  [[nodiscard]] std::span<const PlacedMesh> meshes() const { return placed_; }
  [[nodiscard]] ShadedScene view(const Camera& camera, int samples);
  // The object of a triangle: index into Scene::objects.
  [[nodiscard]] std::uint32_t object_of(std::uint32_t triangle) const {
    return placed_[mesh_of_triangle(placed_, triangle)].object;
  }

 private:
  const RayScene& rays_;
  std::vector<std::vector<std::uint32_t>> place_of_part_;  // by model: opaque parts before it
  std::vector<std::uint32_t> first_of_object_;
  std::unique_ptr<bool[]> included_;
  std::vector<PlacedMesh> placed_;
  std::vector<Light> lights_;
  std::vector<float> inverse_z_;
  std::vector<std::uint32_t> triangles_;
};

}  // namespace rilievo
