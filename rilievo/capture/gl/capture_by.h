// Who captures the pictures of a scene that an atlas of nailboards keeps?
//
// OpenGL into the atlas's own textures, so that pictures never leave the GPU; or, where OpenGL is
// done by the processor, a rasteriser made for pictures, several times as fast
// (render/raster/raster_picture.h), whose pictures the atlas is given. What the rasteriser cannot
// draw, a number of samples that is not its own, is left to OpenGL. Needs a current OpenGL context.
#pragma once

#include <cstddef>
#include <memory>
#include <span>
#include <vector>

#include "rilievo/render/raster/raster_picture.h"

namespace rilievo {

enum class CaptureBy {
  automatic,  // the rasteriser where OpenGL is software, else OpenGL
  opengl,
  rasterizer,
};

class CaptureWithoutOpenGL {
 public:
  // Memory that pictures of up to `size` texels a side take while they are captured.
  [[nodiscard]] static std::size_t bytes(int size, int samples);

  // Null where OpenGL is to capture. `scene` must be valid and outlive it.
  [[nodiscard]] static std::unique_ptr<CaptureWithoutOpenGL> create(CaptureBy by,
                                                                    const Scene& scene,
                                                                    int samples);

  // What the camera sees of `objects`, placed by `poses` (of all objects), as PictureRasterizer
  // has it; it is there until the next call.
  [[nodiscard]] const RasterPicture& capture(const Camera& camera,
                                             std::span<const std::uint32_t> objects,
                                             std::span<const glm::mat4> poses);
  // The last one.
  [[nodiscard]] const RasterPicture& picture() const { return picture_; }
  // Of the same picture, as PictureRasterizer::draw_farthest has it.
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
