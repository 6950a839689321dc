// What an atlas keeps of a picture that was rasterised without OpenGL: Delta codes and blocks.
//
// The same as picture_atlas.cpp's shaders make of a capture by OpenGL. Rows from the bottom. Fills
// the caller's buffers; all cores. No OpenGL here.
#pragma once

#include <cstdint>
#include <vector>

#include "rilievo/nailboard/picture_blocks.h"
#include "rilievo/render/raster/raster_picture.h"

namespace rilievo {

struct AtlasPicture {
  // A code a texel; the one that the bits ask for is filled. An empty texel beside others has the
  // nearest one's depth, because their colours reach into it; else delta_steps() + 1.
  std::vector<std::uint8_t> codes8;
  std::vector<std::uint16_t> codes16;
  std::vector<PictureBlock> blocks;  // rows of blocks_across(width), lowest first
};

// `delta_bits`: 2 to 16, as PictureGeometry has them.
void encode_picture(const RasterPicture& picture, int delta_bits, AtlasPicture& encoded);

}  // namespace rilievo
