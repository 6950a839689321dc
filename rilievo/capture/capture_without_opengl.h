// How are pictures captured where OpenGL is slow, or absent?
//
// By the library's own rasteriser (render/raster/raster_picture.h), which on processors is several
// times faster than OpenGL there.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "rilievo/render/raster/raster_picture.h"

namespace rilievo {

// The renderer that captures pictures.
enum class CaptureBy {
  automatic,  // the rasteriser if there is no OpenGL or it runs on the CPU, else OpenGL
  opengl,
  rasterizer,
};

// Captures pictures by the rasteriser.
class CaptureWithoutOpenGL {
 public:
  // The memory for capturing pictures of up to `size` texels a side.
  [[nodiscard]] static std::size_t bytes(int size, int samples) {
    return PictureRasterizer::bytes(size, samples);
  }

  // Captures with 1 or 4 samples per texel. `scene` must be valid and outlive the object.
  CaptureWithoutOpenGL(const Scene& scene, int samples) : samples_(samples), rasterizer_(scene) {}

  // Captures `objects`, placed by `poses` (of all objects), as PictureRasterizer::draw. Valid until
  // the next call.
  [[nodiscard]] const RasterPicture& capture(const Camera& camera,
                                             std::span<const std::uint32_t> objects,
                                             std::span<const glm::mat4> poses) {
    rasterizer_.draw(camera, objects, poses, samples_, picture_);
    return picture_;
  }
  // The last picture.
  [[nodiscard]] const RasterPicture& picture() const { return picture_; }
  // The farthest depths of the same picture, as PictureRasterizer::draw_farthest.
  [[nodiscard]] const std::vector<float>& capture_farthest(const Camera& camera,
                                                           std::span<const std::uint32_t> objects,
                                                           std::span<const glm::mat4> poses) {
    rasterizer_.draw_farthest(camera, objects, poses, farthest_);
    return farthest_;
  }

  // The object identifiers at the texels' centres, rows from the bottom. Valid until the next call.
  [[nodiscard]] const ObjectPicture& capture_objects(const Camera& camera,
                                                     std::span<const std::uint32_t> objects,
                                                     std::span<const glm::mat4> poses) {
    rasterizer_.draw_objects(camera, objects, poses, objects_);
    return objects_;
  }

 private:
  int samples_;
  PictureRasterizer rasterizer_;
  RasterPicture picture_;
  std::vector<float> farthest_;
  ObjectPicture objects_;
};

}  // namespace rilievo
