// Which triangle is nearest at each sample of a picture or of a whole frame? Internal to
// render/raster.
//
// Places some of a scene's objects, cuts at the near plane what reaches behind the eye, and
// rasterises. Keeps its buffers.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <utility>
#include <vector>

#include "rilievo/core/result.h"
#include "rilievo/render/cross_fade.h"
#include "rilievo/render/placed_scene.h"
#include "rilievo/render/raster/near_clip.h"
#include "rilievo/render/raster/sample_raster.h"
#include "rilievo/render/shading/frame_visibility.h"
#include "rilievo/render/shading/picture_shader.h"

namespace rilievo {

// What happens to parts in front of the near plane?
enum class NearPlane {
  cuts,    // they are invisible
  clamps,  // they are drawn on it; requires all of the objects in front of the eye
};

// Rasterises pictures and frames of one scene. Cameras must be perspective ones.
class FrameRaster final : public FrameVisibility {
 public:
  // `scene` must be valid and outlive the object. Makes the mip levels of its textures.
  explicit FrameRaster(const Scene& scene)
      : FrameRaster(scene, std::make_shared<SurfaceMaterials>(scene)) {}
  // Shares the scene's materials with another one.
  FrameRaster(const Scene& scene, std::shared_ptr<const SurfaceMaterials> materials)
      : scene_(scene), materials_(std::move(materials)) {}

  // Places the opaque and masked parts of `objects` by `poses` (of all objects), in this order.
  void place(const Camera& camera, std::span<const std::uint32_t> objects,
             std::span<const glm::mat4> poses);
  // The same as `scene` places them, near ones first, since what they hide is written less often;
  // then those that fade.
  void place_nearest_first(const Camera& camera, const PlacedScene& scene,
                           std::span<const std::uint32_t> objects,
                           std::span<const CrossFade> fading = {});
  // The same in two steps. Any thread may call find_places() while one thread rasterises.
  void find_places(const Camera& camera, std::span<const std::uint32_t> objects,
                   std::span<const glm::mat4> poses, std::vector<PlacedMesh>& placed) const {
    place_meshes(scene_, *materials_, camera.position(), objects, poses, placed);
  }
  void place(const Camera& camera, std::span<const PlacedMesh> placed);
  // Makes fill() find the farthest surfaces, back faces included, with a depth of 1 - window_z.
  // Until the next place(). What lies beyond the far plane is then drawn on it; what lies in front
  // of the near plane is nothing, whatever fill() is told.
  void keep_farthest();
  // Rasterises the parts that are placed, with 1 or 4 samples, or a staggered one. Requires frames
  // of at most SampleRaster::kMaxSize texels a side.
  void fill(const Camera& camera, int samples, NearPlane near_plane, bool staggered = false);
  // The same in parts: begin(), then fill_some() with about so many more triangles at a time, until
  // none is left, which it returns. The result is that of fill(), work() is not known.
  void begin(const Camera& camera, int samples, NearPlane near_plane, bool staggered = false);
  bool fill_some(std::uint64_t triangles);
  // How many triangles are placed.
  [[nodiscard]] std::uint64_t triangles() const;

  // Places the opaque and masked parts of `objects`, front to back, and of those that fade within
  // their ranges, and rasterises with 1 or 4 samples. Fails if the frame has more than
  // SampleRaster::kMaxSize pixels a side.
  Result<> find_visible(const Camera& camera, int samples, const PlacedScene& placed,
                        std::span<const std::uint32_t> objects,
                        std::span<const CrossFade> fading) override;

  // The last picture, ready to be shaded.
  [[nodiscard]] PictureView view(const Camera& camera) override;
  [[nodiscard]] const SampleBuffer& seen() const override { return raster_.seen(); }
  [[nodiscard]] std::span<const PlacedMesh> meshes() const override { return placed_; }
  [[nodiscard]] std::span<const MeshWork> work() const override { return work_; }
  [[nodiscard]] const std::shared_ptr<const SurfaceMaterials>& materials() const {
    return materials_;
  }

 private:
  const Scene& scene_;
  std::shared_ptr<const SurfaceMaterials> materials_;
  std::vector<std::pair<double, std::uint32_t>> nearest_first_;
  std::vector<std::uint32_t> objects_;
  std::vector<PlacedMesh> placed_;
  std::vector<RasterInstance> instances_;
  std::vector<RasterMask> masks_;
  std::vector<Light> lights_;
  NearClip near_clip_;
  std::vector<std::size_t> cut_;  // the meshes whose pieces these are
  std::vector<RasterInstance> some_;
  std::size_t next_instance_ = 0;    // of fill_some()
  std::uint32_t next_triangle_ = 0;  // of that instance
  std::vector<MeshWork> work_;
  SampleRaster raster_;
};

}  // namespace rilievo
