// Whole frames by the rasteriser and by rays, without tiles: what is drawn into them is held
// against.
//
// Opaque and masked parts, with the shading, textures and samples of all frames; no sky.
#pragma once

#include <memory>
#include <utility>
#include <vector>

#include "rilievo/render/raster/frame_raster.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/render/shading/picture_shader.h"

namespace rilievo {

// Rasterises the objects in view; those that reach behind the eye are cut at the near plane.
class RasterFrames {
 public:
  explicit RasterFrames(const Scene& scene) : placed_(scene), raster_(scene) {}

  void set_time(double time) { placed_.set_time(time); }
  Result<> draw(const Camera& camera, int samples, RasterPicture& picture) {
    if (Result<> done = rasterize(camera, samples); !done) return done;
    shader_.shade(raster_.view(camera), picture);
    return Done{};
  }
  Result<> draw_objects(const Camera& camera, ObjectPicture& picture) {
    if (Result<> done = rasterize(camera, 1); !done) return done;
    identify(raster_.seen(), raster_.meshes(), picture);
    return Done{};
  }

 private:
  Result<> rasterize(const Camera& camera, int samples) {
    visible_.clear();
    placed_.cull(camera, visible_);
    return raster_.find_visible(camera, samples, placed_, visible_, {});
  }

  PlacedScene placed_;
  FrameRaster raster_;
  std::vector<std::uint32_t> visible_;
  PictureShader shader_;
};

// Casts one ray for each sample.
class RayFrames {
 public:
  explicit RayFrames(const Scene& scene)
      : rays_(std::move(*RayScene::create(scene))), caster_(rays_) {}

  [[nodiscard]] bool set_time(double time) { return rays_.set_time(time).ok(); }
  void draw(const Camera& camera, int samples, RasterPicture& picture) {
    caster_.draw(camera, {}, samples, picture);
  }
  void draw_objects(const Camera& camera, ObjectPicture& picture) {
    caster_.draw_objects(camera, picture);
  }

 private:
  RayScene rays_;
  PictureCaster caster_;
};

}  // namespace rilievo
