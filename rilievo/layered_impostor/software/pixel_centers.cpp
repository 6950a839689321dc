#include "rilievo/layered_impostor/software/pixel_centers.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>

namespace rilievo {

float PixelCenters::inverse_z(int x, int y) const {
  if (y < 0 || y > 63) return beside_[y < 0 ? 0 : 1][x];
  if (x < 0 || x > 63) return beside_[x < 0 ? 2 : 3][y];
  return seen_[y / kRow * FrameTile::kBlocks + x / kRow][y % kRow * kRow + x % kRow].inverse_z;
}

std::pair<double, double> PixelCenters::stretch(const PlacedLayered& placed, int x, int y) const {
  float farthest = 1e30f, nearest = 0;
  for (int v = y - 1; v <= y + 1; ++v)
    for (int u = x - 1; u <= x + 1; ++u)
      if (shown_.has(u, v)) {
        const float z = inverse_z(u, v);
        farthest = std::min(farthest, z), nearest = std::max(nearest, z);
      }
  return {1 / (double(nearest) * placed.scale) - placed.margin,
          1 / (double(farthest) * placed.scale) + placed.margin};
}

void PixelCenters::look_at_block(const LayeredRays& rays, const PlacedLayered& placed,
                                 const FrameTile& tile, int block) {
  const int x0 = block % FrameTile::kBlocks * kRow, y0 = block / FrameTile::kBlocks * kRow;
  if (tile.x + x0 >= placed.x1 || tile.y + y0 >= placed.y1 || tile.x + x0 + kRow <= placed.x0 ||
      tile.y + y0 + kRow <= placed.y0)
    return;
  for (int row = 0; row < kRow; ++row) {
    const int y = tile.y + y0 + row;
    if (y < placed.y0 || y >= placed.y1) continue;
    std::uint32_t wanted = 0;
    std::array<Gaze, kRow> gazes;
    for (int k = 0; k < kRow; ++k) {
      const int x = tile.x + x0 + k, i = row * kRow + k;
      float farthest = tile.first[block].inverse_z[i];
      if (tile.expanded[block])
        for (const FrameTile::Plane& plane : tile.more[block])
          farthest = std::min(farthest, plane.inverse_z[i]);
      gazes[std::size_t(k)].at = {x + 0.5, y + 0.5};
      if (x >= placed.x0 && x < placed.x1 && placed.nearest > farthest) wanted |= 1u << k;
    }
    if (!wanted) continue;
    SeenLayered shown[kRow];
    rays.look(placed, gazes, wanted, shown);
    for (int k = 0; k < kRow; ++k) {
      if (!(wanted >> k & 1)) continue;
      seen_[block][row * kRow + k] = shown[k];
      asked_.set(x0 + k, y0 + row);
      if (shown[k].inverse_z != kSeesNothing) shown_.set(x0 + k, y0 + row);
    }
  }
}

void PixelCenters::look(const LayeredRays& rays, const PlacedLayered& placed,
                        const FrameTile& tile) {
  asked_ = shown_ = {};
  for (int block = 0; block < FrameTile::kBlockCount; ++block)
    look_at_block(rays, placed, tile, block);
}

void PixelCenters::look_beside(const LayeredRays& rays, const PlacedLayered& placed,
                               const FrameTile& tile) {
  constexpr int kLast = FrameTile::kSize - 1;
  for (int side = 0; side < 4; ++side)
    for (int begin = 0; begin < FrameTile::kSize; begin += kRow) {
      // Of the k-th: itself if `out` is 1, and its neighbour in the tile if that is 0.
      const auto place = [&](int k, int out) {
        const int across = side % 2 == 0 ? -out : kLast + out;
        return side < 2 ? glm::ivec2(begin + k, across) : glm::ivec2(across, begin + k);
      };
      std::uint32_t wanted = 0;
      std::array<Gaze, kRow> gazes;
      for (int k = 0; k < kRow; ++k) {
        const glm::ivec2 within = place(k, 0);
        const int x = tile.x + place(k, 1).x, y = tile.y + place(k, 1).y;
        gazes[std::size_t(k)].at = {x + 0.5, y + 0.5};
        if (asked_.has(within.x, within.y) && x >= placed.x0 && x < placed.x1 && y >= placed.y0 &&
            y < placed.y1)
          wanted |= 1u << k;
      }
      if (!wanted) continue;
      SeenLayered shown[kRow];
      rays.look(placed, gazes, wanted, shown);
      for (int k = 0; k < kRow; ++k) {
        if (!(wanted >> k & 1)) continue;
        const glm::ivec2 at = place(k, 1);
        beside_[side][begin + k] = shown[k].inverse_z;
        asked_.set(at.x, at.y);
        if (shown[k].inverse_z != kSeesNothing) shown_.set(at.x, at.y);
      }
    }
}

}  // namespace rilievo
