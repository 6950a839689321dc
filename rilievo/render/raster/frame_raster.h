// Which triangle is nearest at each sample of a whole frame? Internal to render/raster.
//
// Places some of a scene's objects, front to back, cuts at the near plane what reaches behind the
// eye, and rasterises. Keeps its buffers.
#pragma once

#include <cstdint>
#include <span>
#include <utility>
#include <vector>

#include "rilievo/core/result.h"
#include "rilievo/render/cross_fade.h"
#include "rilievo/render/placed_scene.h"
#include "rilievo/render/raster/near_clip.h"
#include "rilievo/render/raster/sample_raster.h"
#include "rilievo/render/shading/picture_shader.h"

namespace rilievo {

// Rasterises frames of one scene.
class FrameRaster {
 public:
  // `scene` must be valid and outlive the object. Makes the mip levels of its textures.
  explicit FrameRaster(const Scene& scene) : materials_(scene) {}

  // Rasterises the opaque and masked parts of `objects`, and of those that fade within their
  // ranges, with 1 or 4 samples. Fails if the frame has more than SampleRaster::kMaxSize pixels a
  // side. Requires a perspective camera.
  Result<> rasterize(const Camera& camera, int samples, const PlacedScene& placed,
                     std::span<const std::uint32_t> objects, std::span<const CrossFade> fading);

  // The last frame, ready to be shaded.
  [[nodiscard]] PictureView view(const Camera& camera, const Scene& scene);
  [[nodiscard]] const SampleBuffer& seen() const { return raster_.seen(); }
  [[nodiscard]] std::span<const PlacedMesh> meshes() const { return placed_; }

 private:
  SurfaceMaterials materials_;
  std::vector<std::pair<double, std::uint32_t>> nearest_first_;
  std::vector<std::uint32_t> objects_;
  std::vector<PlacedMesh> placed_;
  std::vector<RasterInstance> instances_;
  std::vector<RasterMask> masks_;
  std::vector<Light> lights_;
  NearClip near_clip_;
  SampleRaster raster_;
};

}  // namespace rilievo
