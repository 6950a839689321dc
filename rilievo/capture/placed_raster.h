// The rasteriser of a scene as it is placed now: pictures as nailboards keep them.
//
// capture/raster_source.h is the capture source of the same rasteriser; this draws what it captures
// (render/raster/raster_picture.h) into buffers that are kept, as bytes, again and again.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/render/placed_scene.h"
#include "rilievo/render/raster/raster_picture.h"

namespace rilievo {

// Draws objects of a scene.
class PlacedRaster {
 public:
  // The memory for drawing pictures of up to `size` texels a side.
  [[nodiscard]] static std::size_t bytes(int size, int samples) {
    return PictureRasterizer::bytes(size, samples);
  }
  // Can it draw so many samples per texel?
  [[nodiscard]] static bool can_sample(int samples) { return samples == 1 || samples == 4; }

  // `placed` must outlive the object.
  explicit PlacedRaster(const PlacedScene& placed) : placed_(placed), rasterizer_(placed.scene()) {}

  // Bytes of sRGB and window_z, of `objects` that lie in front of the eye (not empty). Valid until
  // the next call; does not allocate once its buffers are large enough.
  [[nodiscard]] const RasterPicture& draw(const Camera& camera,
                                          std::span<const std::uint32_t> objects, int samples) {
    rasterizer_.draw(camera, objects, placed_.poses(), samples, picture_);
    return picture_;
  }
  // The last picture that draw() returned.
  [[nodiscard]] const RasterPicture& picture() const { return picture_; }
  [[nodiscard]] const std::vector<float>& draw_farthest(const Camera& camera,
                                                        std::span<const std::uint32_t> objects) {
    rasterizer_.draw_farthest(camera, objects, placed_.poses(), farthest_);
    return farthest_;
  }
  // The same in two steps, for captures on another thread: place() finds where the objects are now,
  // and the others draw what was placed. Any thread may call place() while one thread draws.
  void place(const Camera& camera, std::span<const std::uint32_t> objects,
             std::vector<PlacedMesh>& placed) const {
    rasterizer_.place(camera, objects, placed_.poses(), placed);
  }
  void draw(const Camera& camera, std::span<const PlacedMesh> placed, int samples,
            RasterPicture& picture) {
    rasterizer_.draw(camera, placed, samples, picture);
  }
  [[nodiscard]] const std::vector<float>& draw_farthest(const Camera& camera,
                                                        std::span<const PlacedMesh> placed) {
    rasterizer_.draw_farthest(camera, placed, farthest_);
    return farthest_;
  }
  [[nodiscard]] const ObjectPicture& draw_objects(const Camera& camera,
                                                  std::span<const std::uint32_t> objects) {
    rasterizer_.draw_objects(camera, objects, placed_.poses(), objects_);
    return objects_;
  }

 private:
  const PlacedScene& placed_;
  PictureRasterizer rasterizer_;
  RasterPicture picture_;
  std::vector<float> farthest_;
  ObjectPicture objects_;
};

}  // namespace rilievo
