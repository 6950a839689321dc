// Who captures the pictures of a scene for an atlas of nailboards?
//
// Either OpenGL, into the atlas's own textures, so that pictures never leave the GPU; or, where
// OpenGL runs on the CPU, the library's own rasteriser, which is several times faster
// (render/raster/raster_picture.h) and hands its pictures to the atlas. Numbers of samples that the
// rasteriser does not support are left to OpenGL. Needs a current OpenGL context.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "rilievo/render/raster/raster_picture.h"

namespace rilievo {

// The renderer that captures pictures.
enum class CaptureBy {
  automatic,  // the rasteriser if OpenGL runs on the CPU, else OpenGL
  opengl,
  rasterizer,
};

// Captures pictures by the rasteriser.
class CaptureWithoutOpenGL {
 public:
  // The memory for capturing pictures of up to `size` texels a side.
  [[nodiscard]] static std::size_t bytes(int size, int samples);

  // Null if OpenGL is to capture. `scene` must be valid and outlive the object.
  [[nodiscard]] static std::unique_ptr<CaptureWithoutOpenGL> create(CaptureBy by,
                                                                    const Scene& scene,
                                                                    int samples);

  // Captures `objects`, placed by `poses` (of all objects), as PictureRasterizer::draw. Valid until
  // the next call.
  [[nodiscard]] const RasterPicture& capture(const Camera& camera,
                                             std::span<const std::uint32_t> objects,
                                             std::span<const glm::mat4> poses);
  // The last picture.
  [[nodiscard]] const RasterPicture& picture() const { return picture_; }
  // The farthest depths of the same picture, as PictureRasterizer::draw_farthest.
  [[nodiscard]] const std::vector<float>& capture_farthest(const Camera& camera,
                                                           std::span<const std::uint32_t> objects,
                                                           std::span<const glm::mat4> poses);

 private:
  CaptureWithoutOpenGL(const Scene& scene, int samples) : samples_(samples), rasterizer_(scene) {}

  int samples_;
  PictureRasterizer rasterizer_;
  RasterPicture picture_;
  std::vector<float> farthest_;
};

}  // namespace rilievo
