#include "rilievo/measure/popping.h"

#include <algorithm>
#include <vector>

#include "rilievo/core/expects.h"

namespace rilievo {

Pop largest_pop(const Image<float>& true_change, const Image<float>& change) {
  RILIEVO_EXPECTS_EQ(true_change.width(), change.width());
  RILIEVO_EXPECTS_EQ(true_change.height(), change.height());
  RILIEVO_EXPECTS(change.width() > 0 && change.height() > 0);
  // Sums over all rows above and columns to the left: a tile takes four of them.
  const int w = change.width(), h = change.height();
  const auto stride = std::size_t(w) + 1;
  std::vector<double> sums(stride * (std::size_t(h) + 1), 0.0);
  for (int y = 0; y < h; ++y) {
    double row = 0;
    for (int x = 0; x < w; ++x) {
      row += double(change(x, y)) - double(true_change(x, y));
      const std::size_t here = (std::size_t(y) + 1) * stride + std::size_t(x) + 1;
      sums[here] = sums[here - stride] + row;
    }
  }
  const auto sum = [&](int x, int y) { return sums[std::size_t(y) * stride + std::size_t(x)]; };
  Pop pop;
  pop.frame = std::max(0.0, sum(w, h) / (double(w) * h));
  const int tile_w = std::min(kPopTile, w), tile_h = std::min(kPopTile, h);
  // The last tile of a row or column lies at the frame's edge.
  for (int j = 0, y = 0; j == 0 || y < h - tile_h; ++j) {
    y = std::min(j * kPopTile / 2, h - tile_h);
    for (int i = 0, x = 0; i == 0 || x < w - tile_w; ++i) {
      x = std::min(i * kPopTile / 2, w - tile_w);
      const double excess =
          sum(x + tile_w, y + tile_h) - sum(x, y + tile_h) - sum(x + tile_w, y) + sum(x, y);
      pop.tile = std::max(pop.tile, excess / (double(tile_w) * tile_h));
    }
  }
  return pop;
}

}  // namespace rilievo
