#include "rilievo/render/raster/farthest_blocks.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rilievo/render/raster/sample_raster.h"

namespace rilievo {
namespace {

constexpr float kUnknown = std::numeric_limits<float>::infinity();

// Blocks that are looked at for one box.
constexpr int kMostBlocks = 64;

}  // namespace

void FarthestBlocks::Level::begin(int block, int width, int height) {
  size = block;
  columns = (width + block - 1) / block, rows = (height + block - 1) / block;
  depth.assign(std::size_t(columns) * std::size_t(rows), kUnknown);
}

void FarthestBlocks::begin(int width, int height) {
  small.begin(kSmall, width, height);
  large.begin(kLarge, width, height);
  any = false;
}

void FarthestBlocks::update_large(int row) {
  constexpr int kShare = kLarge / kSmall;
  for (int column = 0; column < large.columns; ++column) {
    float farthest = 0;
    for (int y = row * kShare; y < std::min((row + 1) * kShare, small.rows); ++y)
      for (int x = column * kShare; x < std::min((column + 1) * kShare, small.columns); ++x)
        farthest = std::max(farthest, small.depth[std::size_t(y * small.columns + x)]);
    large.depth[std::size_t(row * large.columns + column)] = farthest;
  }
}

void FarthestBlocks::update_any() {
  any = any || std::any_of(small.depth.begin(), small.depth.end(), [](float z) { return z < 1; });
}

bool can_be_seen(const RasterInstance& instance, const Box& box, const FarthestBlocks& farthest) {
  // Single precision puts corners elsewhere than double, by a few parts in 2^24 of what is summed.
  constexpr double kRounding = 0x1p-20;
  const glm::dvec4 row_x(instance.row_x), row_y(instance.row_y), row_z(instance.row_z),
      row_w(instance.row_w);
  // Strokes reach so many texels beyond the box.
  const double beyond =
      instance.primitive == Primitive::triangles ? 0 : double(instance.strokes.radius_px) + 1;
  const double right = farthest.small.columns * double(FarthestBlocks::kSmall);
  const double top = farthest.small.rows * double(FarthestBlocks::kSmall);
  bool left_of = true, right_of = true, below = true, above = true, behind = true, before = true;
  glm::dvec3 low(std::numeric_limits<double>::infinity());
  glm::dvec2 high(-std::numeric_limits<double>::infinity());
  for (const glm::vec3& corner : box.corners()) {
    const glm::dvec4 p(corner, 1);
    const auto sizes = [&](const glm::dvec4& row) {
      return kRounding * glm::dot(glm::abs(row), glm::abs(p));
    };
    const double x = glm::dot(row_x, p), y = glm::dot(row_y, p), w = glm::dot(row_w, p);
    const double x_slack = sizes(row_x), y_slack = sizes(row_y), w_slack = sizes(row_w);
    // Linear in p: what holds at all corners holds in the box, where w > 0 for all that is drawn.
    left_of &= x + beyond * w < -x_slack - beyond * w_slack;
    below &= y + beyond * w < -y_slack - beyond * w_slack;
    right_of &= x - (right + beyond) * w > x_slack + (right + beyond) * w_slack;
    above &= y - (top + beyond) * w > y_slack + (top + beyond) * w_slack;
    behind &= w + w_slack <= double(instance.min_w);
    before &= w > 2 * w_slack;
    if (!before) continue;
    const double least_w = w - w_slack;
    // Off by the slack of the product, and by the quotient's: |x / w| times that of w.
    const auto at = [&](double product, double slack, double sign) {
      const double off = (slack + std::abs(product / w) * w_slack) / least_w;
      return product / w + sign * off;
    };
    const double z = glm::dot(row_z, p), z_slack = sizes(row_z);
    low = glm::min(low, glm::dvec3(at(x, x_slack, -1), at(y, y_slack, -1), at(z, z_slack, -1)));
    high = glm::max(high, glm::dvec2(at(x, x_slack, 1), at(y, y_slack, 1)));
  }
  if (left_of || right_of || below || above || behind) return false;
  if (!before || !farthest.any) return true;
  const FarthestBlocks::Level& level = farthest.large;
  const auto block = [&](double texel, int count) {
    return int(std::clamp(std::floor(texel / level.size), 0.0, count - 1.0));
  };
  low -= glm::dvec3(beyond, beyond, 0), high += beyond;
  const int x0 = block(low.x, level.columns), x1 = block(high.x, level.columns);
  const int y0 = block(low.y, level.rows), y1 = block(high.y, level.rows);
  if ((x1 - x0 + 1) * (y1 - y0 + 1) > kMostBlocks) return true;
  for (int y = y0; y <= y1; ++y)
    for (int x = x0; x <= x1; ++x)
      if (!(low.z >= double(level.depth[std::size_t(y * level.columns + x)]))) return true;
  return false;
}

}  // namespace rilievo
