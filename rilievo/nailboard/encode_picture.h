// A rasterised picture as an atlas stores it: Delta codes and blocks.
//
// The result equals what the shaders of nailboard_atlas.cpp make of an OpenGL capture. Rows from
// the bottom. Fills the caller's buffers; uses all cores. No OpenGL.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "rilievo/nailboard/occlusion_tiles.h"
#include "rilievo/render/raster/raster_picture.h"

namespace rilievo {

// The tile of a column of tiles in the rows [begin, end) of a picture of `width` texels. `codes`
// and `colors` are the whole picture's; codes above `steps` are empty.
template <class Code>
[[nodiscard]] OcclusionTile tile_of(const Code* codes, const glm::u8vec4* colors, int width,
                                    int column, int begin, int end, std::uint32_t steps) {
  std::uint32_t nearest = steps + 1, farthest = 0;
  unsigned covered = 0, opaque = 0;
  const int right = std::min(width, (column + 1) * kBlockTexels);
  for (int y = begin; y < end; ++y)
    for (int x = column * kBlockTexels; x < right; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(width) + std::size_t(x);
      if (codes[i] > steps) continue;
      const unsigned bit = 1u << (x % kBlockTexels + kBlockTexels * (y % kBlockTexels));
      nearest = std::min(nearest, std::uint32_t(codes[i]));
      farthest = std::max(farthest, std::uint32_t(codes[i]));
      covered |= bit;
      if (colors[i].a == 255) opaque |= bit;
    }
  OcclusionTile tile;
  if (covered) {
    tile.nearest = std::uint8_t(nearest * 254 / steps);
    tile.farthest = std::uint8_t((farthest * 254 + steps - 1) / steps);
    tile.covered = std::uint16_t(covered), tile.opaque = std::uint16_t(opaque);
  }
  return tile;
}

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
