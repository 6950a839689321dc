// What does an atlas store of a picture that was rasterised without OpenGL? Delta codes and blocks.
//
// The result equals what the shaders of nailboard_atlas.cpp make of an OpenGL capture. Rows from
// the bottom. Fills the caller's buffers; uses all cores. No OpenGL.
#pragma once

#include <cstdint>
#include <vector>

#include "rilievo/nailboard/occlusion_tiles.h"
#include "rilievo/render/raster/raster_picture.h"

namespace rilievo {

// The encoded depth of a picture.
struct AtlasPicture {
  // A code for each texel; delta_bits decides which of the two is filled. An empty texel with
  // covered neighbours has the depth of the nearest one, because colours are interpolated into it;
  // other empty texels have delta_steps() + 1.
  std::vector<std::uint8_t> codes8;
  std::vector<std::uint16_t> codes16;
  std::vector<OcclusionTile> blocks;  // rows of blocks_across(width), bottom row first
};

// Encodes a picture with 2 to 16 bits of Delta.
void encode_picture(const RasterPicture& picture, int delta_bits, AtlasPicture& encoded);

}  // namespace rilievo
