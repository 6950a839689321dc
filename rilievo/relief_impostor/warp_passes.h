// What are the inner loops of the two one-dimensional passes? (S5.2)
//
// Internal to the folder. SIMD, chosen at run time; every instruction set gives the same bytes.
//
// A sample at index i of its row (column) with the code q lands at
//
//   p = (a0 + a1 i) + q (b0 + b1 i)
//
// texels of the result along that row (column). Neighbours that both show something are the ends of
// a piece of surface, which covers the texels whose centres lie in (p_i, p_i+1]; colours and codes
// are interpolated along it. Pieces that are turned over cover nothing.
//
// Silhouettes keep their antialiasing. Where the neighbour shows nothing, a sample fades into
// nothing over its own size, a1 + q b1, as a texture with a transparent border does. Such fades,
// and pieces with an end that is not opaque, are blended with the opaque pieces of their texel
// after these: before or behind them by their codes.
#pragma once

#include <cstddef>
#include <cstdint>

#include "rilievo/relief_impostor/impostor_picture.h"

namespace rilievo {

// Between the passes and in the result, a code is Delta in 16 bits, which is affine in one over the
// distance from the new eye, and so linear along straight lines of the picture.
constexpr std::uint32_t kEmptyWarped = 0xffff;
// Beside it, between the passes: no sample of the row landed within `reach` of the texel's centre.
constexpr std::uint32_t kInterpolatedBit = 0x10000;

// A piece that is longer may lie between two surfaces; texels of the result.
constexpr float kTear = 3;
// Beside the code, too: the piece is longer than kTear.
constexpr std::uint32_t kTornBit = 0x20000;
// What is so transparent is not there.
constexpr std::uint32_t kFaintAlpha = 4;

// Texels from row to row of `width` texels: room for whole vectors, and rows that do not share
// their places in the processor's cache.
[[nodiscard]] constexpr int warp_pitch(int width) { return (((width + 15) / 16 + 2) | 1) * 16; }
// Columns that the second pass does at once.
constexpr int kWarpStrip = 64;

// The coefficients above, and the order in which pieces are drawn.
struct AxisWarp {
  float a0 = 0, a1 = 1, b0 = 0, b1 = 0;
  float reach = 0.5f;
  // Two ranges of indices, [from, to) upwards or downwards; nearer surfaces are drawn later.
  struct Range {
    int from = 0, to = 0;
    bool up = true;
  } ranges[2];
};

// What the second pass counts.
struct WarpedTexels {
  std::size_t covered = 0, interpolated = 0;
  [[nodiscard]] double share() const {
    return covered > 0 ? double(interpolated) / double(covered) : 0.0;
  }
};

// Between the passes, texels lie in blocks of 16 columns, which the second pass reads from row to
// row: each row of a block is 16 colours, and then 16 codes. Words from block to block, with room
// for a row after the last, and of a size that does not share its places in the cache:
[[nodiscard]] constexpr std::size_t warp_block(int rows) {
  return std::size_t((rows + 1) | 1) * 32;
}

// The codes of levels 0 ... farthest: B = (r0 + r1 level) / (c0 + c1 level), code = m0 + m1 B. The
// table has 4096 entries; kEmptyLevel's is kEmptyWarped.
struct LevelCodes {
  float r0 = 0, r1 = 0, c0 = 1, c1 = 0, m0 = 0, m1 = 0;
};
void level_table(const LevelCodes& codes, std::uint32_t* table);

// One row of `width` texels to one of `out_width`, in the first block at `out`. `table` is that of
// `codes`. `in` has the pitch of its width. `scratch` holds row_pass_scratch(width, out_width)
// bytes.
void row_pass(const AxisWarp& axis, const LevelCodes& codes, const std::uint32_t* table,
              const WarpTexel* in, int width, std::uint32_t* out, std::size_t block, int out_width,
              std::byte* scratch);
[[nodiscard]] std::size_t row_pass_scratch(int width, int out_width);

// What the second pass writes: colours, Deltas, and what is true of a texel: 1 interpolated, 2
// torn.
struct WarpPlanes {
  std::uint32_t* color = nullptr;
  std::uint16_t* delta = nullptr;
  std::uint16_t* flags = nullptr;
  std::size_t pitch = 0;  // texels from row to row
};

// Columns [x, x + columns), at most kWarpStrip, of `height` rows of the first pass to `out_height`
// rows of planes. `in` is the first block; a row that shows nothing is after its last. x is a
// multiple of 16.
WarpedTexels column_pass(const AxisWarp& axis, const std::uint32_t* in, std::size_t block,
                         int height, int x, int columns, const WarpPlanes& to, int out_height,
                         std::byte* scratch);
[[nodiscard]] std::size_t column_pass_scratch(int height, int out_height);

}  // namespace rilievo
