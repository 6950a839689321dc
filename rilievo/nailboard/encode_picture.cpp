#include "rilievo/nailboard/encode_picture.h"

#include <algorithm>

#include "rilievo/core/depth.h"
#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

// Entry x: the nearest depth of texel x of row y and of the eight around it; 1: they show nothing.
void nearest_around(const RasterPicture& picture, int y, std::vector<float>& nearest) {
  const std::size_t width = std::size_t(picture.width);
  // Of columns first: entry x + 1 for column x, empty ones at both ends.
  nearest.assign(width + 2, 1.0f);
  for (int row = std::max(0, y - 1); row <= std::min(picture.height - 1, y + 1); ++row) {
    const float* depth = &picture.depth[std::size_t(row) * width];
    for (std::size_t x = 0; x < width; ++x) nearest[x + 1] = std::min(nearest[x + 1], depth[x]);
  }
  for (std::size_t x = 0; x < width; ++x)
    nearest[x] = std::min(std::min(nearest[x], nearest[x + 1]), nearest[x + 2]);
}

// One row of blocks, and the codes of its texels.
template <class Code>
void encode_rows(const RasterPicture& picture, std::uint32_t steps, int row, Code* codes,
                 OcclusionTile* blocks) {
  const std::size_t width = std::size_t(picture.width);
  const int end = std::min(picture.height, (row + 1) * kBlockTexels);
  static thread_local std::vector<float> nearest_depth;  // kept: a steady frame allocates nothing
  for (int y = row * kBlockTexels; y < end; ++y) {
    nearest_around(picture, y, nearest_depth);
    for (std::size_t x = 0; x < width; ++x) {
      const std::size_t i = std::size_t(y) * width + x;
      const float depth = picture.color[i].a > 0 ? picture.depth[i] : nearest_depth[x];
      codes[i] = Code(depth < 1.0f ? std::uint32_t(depth * float(steps) + 0.5f) : steps + 1);
    }
  }
  for (int column = 0; column < blocks_across(picture.width); ++column)
    blocks[column] =
        tile_of(codes, picture.color.data(), picture.width, column, row * kBlockTexels, end, steps);
}

}  // namespace

void encode_picture(const RasterPicture& picture, int delta_bits, AtlasPicture& encoded) {
  RILIEVO_EXPECTS(2 <= delta_bits && delta_bits <= 16);
  const auto steps = std::uint32_t(delta_steps(delta_bits));
  const int columns = blocks_across(picture.width), rows = blocks_across(picture.height);
  encoded.blocks.resize(std::size_t(columns) * std::size_t(rows));
  const std::size_t texels = std::size_t(picture.width) * std::size_t(picture.height);
  if (delta_bits > 8)
    encoded.codes16.resize(texels);
  else
    encoded.codes8.resize(texels);
  parallel_for(0, rows, [&](int row) {
    OcclusionTile* blocks = &encoded.blocks[std::size_t(row) * std::size_t(columns)];
    if (delta_bits > 8)
      encode_rows(picture, steps, row, encoded.codes16.data(), blocks);
    else
      encode_rows(picture, steps, row, encoded.codes8.data(), blocks);
  });
}

}  // namespace rilievo
