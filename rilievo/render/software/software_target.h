// A target for frames without OpenGL: memory of the caller's process.
//
// The twin of render/opengl/frame_target.h: sRGB-encoded bytes, 1 or 4 samples a pixel at
// OpenGL's usual share each, averaged as bytes. A frame is drawn tile by tile on all cores, and a
// tile is finished by one thread: cleared, drawn into by each drawer in order, averaged and copied
// out. The result does not depend on the number of threads or on the instruction set. A frame
// allocates nothing, except that a thread's first tile makes the thread's memory.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>

#include "rilievo/core/camera.h"
#include "rilievo/core/color.h"
#include "rilievo/core/image.h"
#include "rilievo/render/software/frame_tile.h"

namespace rilievo {

// A frame in memory.
class SoftwareTarget {
 public:
  // Requires sizes from 1 to 16384 and 1 or 4 samples.
  SoftwareTarget(int width, int height, int samples);

  // Draws a frame of colours. Nothing at or beyond `z_far` is drawn.
  void draw(double z_far, std::span<const TileDrawer* const> drawers,
            glm::u8vec4 background = glm::u8vec4(0));
  // Draws object identifiers, at the pixels' centres; kNoObject where nothing is drawn.
  void draw_objects(double z_far, std::span<const TileDrawer* const> drawers);

  // The last frame of colours: the average of the samples; row 0 on top.
  [[nodiscard]] const Rgba8Image& color() const { return color_; }
  // The identifiers of the last draw_objects(); empty before the first one.
  [[nodiscard]] const Image<std::uint32_t>& objects() const { return objects_; }
  // 1 / eye_z of the first sample of each pixel of the last frame; 1 / z_far where nothing is.
  [[nodiscard]] const Image<float>& inverse_z() const { return inverse_z_; }
  // The distances from the eye's plane, metres; kNoDepth where nothing is drawn.
  [[nodiscard]] Image<float> eye_z() const;

  [[nodiscard]] int width() const { return color_.width(); }
  [[nodiscard]] int height() const { return color_.height(); }
  [[nodiscard]] int samples() const { return samples_; }
  // The number of tiles across and down.
  [[nodiscard]] static int tiles_across(int pixels) {
    return (pixels + FrameTile::kSize - 1) / FrameTile::kSize;
  }

 private:
  void draw_tiles(TileContent of, double z_far, std::span<const TileDrawer* const> drawers,
                  std::uint32_t background);

  int samples_ = 1;
  float nothing_ = 0;
  Rgba8Image color_;
  Image<std::uint32_t> objects_;
  Image<float> inverse_z_;
};

}  // namespace rilievo
