// A part of a frame while it is drawn on processors.
//
// A tile of 64 x 64 pixels in blocks of 8 x 8, small enough for the cache of one core. Frame
// coordinates are in pixels; y points down. A sample has a colour (or an object identifier) and
// 1 / eye_z: that is affine over the screen for every plane, larger is nearer, and it needs no
// near plane.
//
// With 4 samples a pixel, a block holds only one, which stands for all four, until a pixel is first
// covered in part. Most blocks show the inside of something and never expand.
#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>

namespace rilievo {

// The content of a frame's samples.
enum class TileContent {
  color,      // sRGB bytes R, G, B, A, the first one in the lowest bits; premultiplied
  object_id,  // object identifiers; one sample a pixel
};

// A tile. Blocks row by row; the pixels of a block row by row.
struct alignas(64) FrameTile {
  static constexpr int kSize = 64, kBlock = 8, kBlocks = kSize / kBlock;  // a side
  static constexpr int kBlockPixels = kBlock * kBlock, kBlockCount = kBlocks * kBlocks;

  // The places of four samples in their pixel, as OpenGL has them.
  static constexpr float kSampleX[4] = {0.375f, 0.875f, 0.125f, 0.625f};
  static constexpr float kSampleY[4] = {0.875f, 0.625f, 0.375f, 0.125f};

  // One sample of each pixel of a block.
  struct alignas(64) Plane {
    std::uint32_t content[kBlockPixels];
    float inverse_z[kBlockPixels];
  };

  Plane first[kBlockCount];    // sample 0 of all blocks together: most tiles need no more
  Plane more[kBlockCount][3];  // samples 1 to 3; valid if the block is expanded
  bool expanded[kBlockCount];
  bool changed[kBlockCount];    // since farthest was found
  float farthest[kBlockCount];  // the least inverse_z of its samples, or less
  int x = 0, y = 0;             // of its upper left pixel
  int width = 0, height = 0;    // of the frame: the tile may reach beyond
  int samples = 1;              // 1 or 4
  TileContent of = TileContent::color;
  float nothing = 0;  // the inverse_z where nothing is drawn: 1 / z_far

  [[nodiscard]] Plane& plane(int block, int sample) {
    return sample == 0 ? first[block] : more[block][sample - 1];
  }
  // Nothing is drawn, before this background. `nothing` must be set.
  void clear(std::uint32_t background) {
    for (Plane& plane : first) {
      std::fill_n(plane.content, kBlockPixels, background);
      std::fill_n(plane.inverse_z, kBlockPixels, nothing);
    }
    std::fill_n(expanded, kBlockCount, false);
    std::fill_n(changed, kBlockCount, false);
    std::fill_n(farthest, kBlockCount, nothing);
  }
  // Gives a block samples of its own at each pixel.
  void expand(int block) {
    if (expanded[block]) return;
    for (Plane& plane : more[block]) std::memcpy(&plane, &first[block], sizeof(Plane));
    expanded[block] = true;
  }
  // The number of samples that a block holds.
  [[nodiscard]] int planes(int block) const { return expanded[block] ? 4 : 1; }
};

// A pixel of a tile: its block, and its place in that.
struct TilePixel {
  int block, pixel;

  // The pixel (x, y) of the frame, which must be the tile's.
  TilePixel(const FrameTile& tile, int x, int y)
      : block((y - tile.y) / FrameTile::kBlock * FrameTile::kBlocks +
              (x - tile.x) / FrameTile::kBlock),
        pixel((y - tile.y) % FrameTile::kBlock * FrameTile::kBlock +
              (x - tile.x) % FrameTile::kBlock) {}

  // Calls visit(plane) for those of its samples whose bit is set; where one stands for all, for
  // that one if the first bit is set.
  template <class Visit>
  void for_samples(FrameTile& tile, unsigned bits, const Visit& visit) const {
    const int planes = tile.planes(block);
    for (int s = 0; s < planes; ++s)
      if (bits >> s & 1) visit(tile.plane(block, s));
  }
};

// Draws something into tiles. Several threads draw tiles at the same time; draw_tile() may not hand
// out work of its own, because a thread has memory for one tile.
class TileDrawer {
 public:
  virtual ~TileDrawer() = default;
  virtual void draw_tile(FrameTile& tile) const = 0;
};

}  // namespace rilievo
