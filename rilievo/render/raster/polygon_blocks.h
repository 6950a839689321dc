// What do the samples of rasterised polygons mean for a block of a frame's tile? SIMD over pixels.
//
// Depth is window_z in the SampleBuffer and 1 / eye_z in tiles, and one is affine in the other:
//
//   1 / eye_z = 1 / z_far + (1 - window_z) (1 / z_near - 1 / z_far)
//
// 1 - window_z is exact where it is small, so that what is far keeps its precision. A pixel is
// whole if all its samples show one triangle. The result does not depend on the instruction set.
// Internal to render/raster.
#pragma once

#include <cstdint>

#include "rilievo/render/shading/sample_buffer.h"
#include "rilievo/render/software/frame_tile.h"

namespace rilievo {

// Depths of tiles from those of the rasteriser.
struct TileDepth {
  float inverse_far = 0, inverse_range = 1;

  [[nodiscard]] float operator()(float window_z) const {
    return inverse_far + (1.0f - window_z) * inverse_range;
  }
};

// The samples of a block, rows from the top; the pixels of a row one after the other.
struct BlockSamples {
  static constexpr int kRowSamples = FrameTile::kBlock * 4;
  int samples = 1;  // of a pixel
  const float* depths[FrameTile::kBlock];
  const std::uint32_t* triangles[FrameTile::kBlock];

  // The block whose upper left pixel is (x, y), counted from the top.
  BlockSamples(const SampleBuffer& in, int x, int y);

 private:
  // Where the block reaches beyond the frame.
  float beyond_depths_[FrameTile::kBlock][kRowSamples];
  std::uint32_t beyond_triangles_[FrameTile::kBlock][kRowSamples];
};

// Is any sample covered, and any pixel covered in part?
struct BlockCoverage {
  bool any = false, partial = false;
};
[[nodiscard]] BlockCoverage find_coverage(const BlockSamples& in);

// Takes over the depths of samples that are nearer than the block's; they show `content`.
void draw_depths(const BlockSamples& in, const TileDepth& tile_depth, std::uint32_t content,
                 FrameTile& tile, int block);

// For each pixel of a row, a bit: the lowest is the leftmost.
using PixelBits = std::uint8_t;
static_assert(FrameTile::kBlock <= 8);

// Which pixels are whole, and which samples still show polygons? Whatever was drawn between is
// nearer, and has another depth.
struct VisibleRow {
  PixelBits whole = 0, visible[4] = {};
};
// Row `row` from the top. A block that was expanded after draw_depths() has the depth of the first
// sample in all samples of a whole pixel.
[[nodiscard]] VisibleRow find_visible(const BlockSamples& in, const TileDepth& tile_depth,
                                      FrameTile& tile, int block, int row);

}  // namespace rilievo
