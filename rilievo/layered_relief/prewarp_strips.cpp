#include "rilievo/layered_relief/prewarp_strips.h"

#include <algorithm>
#include <cmath>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

// A texel is emptied and written, which takes about so long as this share of a sample.
constexpr double kTexelWork = 1.0 / 6;

// The most rows in the mean.
int mean_rows(int width, int most) { return std::max(most * most / width, 16); }

// The node of a tile: those of the last level lie in Z-order.
std::size_t node_of_tile(const LayeredRelief& relief, int x, int y) {
  std::size_t node = 0;
  for (int bit = relief.levels - 2; bit >= 0; --bit)
    node = 4 * node + 1 + std::size_t((x >> bit & 1) | (y >> bit & 1) << 1);
  return node;
}

struct Stretch {
  double low, high;
};

// Where positions [from, from + size] at displacements d0 and d1 land along one axis.
Stretch moved(int from, int size, double k, double k3, double d0, double d1) {
  const double w0 = 1 / (1 + k3 * d0), w1 = 1 / (1 + k3 * d1);
  return {std::min((from + k * d0) * w0, (from + k * d1) * w1),
          std::max((from + size + k * d0) * w0, (from + size + k * d1) * w1)};
}

}  // namespace

int strip_count(const glm::ivec2& extent, int most, int threads) {
  const int rows = mean_rows(extent.x, most);
  const int count = (extent.y + rows - 1) / rows;
  if (count > threads) return std::min((count + threads - 1) / threads * threads, extent.y);
  return std::max({count, std::min({kStrips, threads, extent.y / kStripRows}), 1});
}

int most_strip_rows(int height, int count) { return 2 * ((height + count - 1) / count); }

std::size_t most_strip_texels(int max_size, int most, int padding) {
  // Of rows of any width w: mean_rows(w) w is at most most * most, or 16 w.
  const int mean = std::max(most * most, 16 * max_size);
  return std::size_t(std::min(2 * mean, max_size * max_size) + max_size * padding);
}

void estimate_work(const LayeredRelief& relief, const ReliefWarp& warp, double resolution,
                   std::uint32_t least_code, const Texels& shown, std::vector<double>& above) {
  RILIEVO_EXPECTS(above.size() >= 2);
  const std::size_t bands = above.size() - 1;
  const double rows = double(shown.size().y) / double(bands);
  std::fill(above.begin(), above.end(), kTexelWork * rows * double(shown.size().x));
  above[0] = 0;
  const int size = relief.tile_size;
  for (int y = 0; y < relief.tiles_y; ++y)
    for (int x = 0; x < relief.tiles_x; ++x) {
      const std::size_t tile = std::size_t(y) * std::size_t(relief.tiles_x) + std::size_t(x);
      const double samples = double(relief.first[tile + 1] - relief.first[tile]);
      const ReliefNode& node = relief.tree[node_of_tile(relief, x, y)];
      if (samples == 0 || node.empty() || node.farthest < least_code) continue;
      const double d0 = relief.d(std::max<std::uint32_t>(node.nearest, least_code));
      const double d1 = relief.d(node.farthest);
      const Stretch u = moved(x * size, size, warp.k1, warp.k3, d0, d1);
      if (u.high * resolution <= shown.min.x || u.low * resolution >= shown.max.x) continue;
      const Stretch v = moved(y * size, size, warp.k2, warp.k3, d0, d1);
      const double low = (v.low * resolution - shown.min.y) / rows;
      const double high = (v.high * resolution - shown.min.y) / rows;
      if (high <= 0 || low >= double(bands)) continue;
      const double per_band = samples / (high - low);
      const auto last = std::min(std::size_t(std::ceil(high)), bands);
      for (auto band = std::size_t(std::max(low, 0.0)); band < last; ++band)
        above[band + 1] +=
            per_band * (std::min(high, double(band + 1)) - std::max(low, double(band)));
    }
  for (std::size_t band = 1; band <= bands; ++band) above[band] += above[band - 1];
}

void divide_work(const Texels& shown, const std::vector<double>& above, int count,
                 std::vector<Texels>& strips) {
  const int height = shown.size().y;
  RILIEVO_EXPECTS(count >= 1 && count <= height && above.size() >= 2);
  const double rows = double(height) / double(above.size() - 1);
  const int highest = most_strip_rows(height, count);
  int from = 0;
  std::size_t band = 0;
  for (int i = 1; i <= count; ++i) {
    int to = height;
    if (i < count) {
      const double work = above.back() * i / count;
      while (band + 2 < above.size() && above[band + 1] < work) ++band;
      const double share = (work - above[band]) / (above[band + 1] - above[band]);
      const int row = int(std::lround((double(band) + std::clamp(share, 0.0, 1.0)) * rows));
      const int rest = count - i;
      to = std::clamp(row, std::max(from + 1, height - rest * highest),
                      std::min(from + highest, height - rest));
    }
    strips.push_back({{shown.min.x, shown.min.y + from}, {shown.max.x, shown.min.y + to}});
    from = to;
  }
}

}  // namespace rilievo
