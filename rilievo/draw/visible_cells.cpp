// Let a and b bound the corners of a tile of n x n pixels, in texels. A fragment's texel is the one
// at its pixel's centre, half a pixel inside the tile: were the map from pixels to texels affine,
//
//   (b - a) / 2n (1)
//
// inside of a and b. The map of a polygon seen at an angle is not, but nearly: while 1 / eye_z
// changes over a tile by less than a part e of itself, the texel moves by less than e (b - a). So
// the part of b - a that is counted on is 1 / 2n - e, and none at a greater e than kLevel.
#include "rilievo/draw/visible_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rilievo {
namespace {

// eye_z in doubles against fragments in floats: a few parts in 2^24, and room to spare.
constexpr double kRounding = 1e-4;
// Texels in floats, here and where they are drawn: a few parts in 2^24 of 1024, and room to spare.
constexpr float kTexelRounding = 0.01f;
// Colour is interpolated between centres of texels: from half a texel around.
constexpr float kFilterTexels = 0.5f;
constexpr double kLevel = 0.005;

int floor_int(double v) { return int(std::floor(v)); }

}  // namespace

struct VisibleCells::Placement {
  // (x w, y w, w) of the frame for a point of the polygon, given in texels; w is its eye_z.
  glm::dvec3 origin, u, v;
  glm::dmat3 texel_from_raster;
  // The surface at Delta stands at E + (P - E) / q, q affine in Delta: so does its eye_z.
  double eye_w = 0, near_ratio = 1, far_ratio = 1;
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // the first and the last cells that the polygon touches
  float inside = 0;                    // of b - a: how far at least fragments lie inside of a tile
  bool relief = true, hides = true;

  [[nodiscard]] glm::dvec3 at(double x, double y) const { return origin + x * u + y * v; }
  [[nodiscard]] double eye_z(double polygon_w, double delta) const {
    return eye_w + (polygon_w - eye_w) / (near_ratio + delta * (far_ratio - near_ratio));
  }
  // Of the polygon between two texels.
  [[nodiscard]] double nearest_w(const glm::vec2& a, const glm::vec2& b) const {
    return origin.z + std::min(a.x * u.z, b.x * u.z) + std::min(a.y * v.z, b.y * v.z);
  }
  [[nodiscard]] double farthest_w(const glm::vec2& a, const glm::vec2& b) const {
    return origin.z + std::max(a.x * u.z, b.x * u.z) + std::max(a.y * v.z, b.y * v.z);
  }
  // Of what the picture shows between two texels, if that is no nearer than `nearest`.
  [[nodiscard]] double nearest_eye_z(const glm::vec2& a, const glm::vec2& b,
                                     std::uint8_t nearest) const {
    const double delta = relief ? nearest / 254.0 : 0.0;
    const double low = nearest_w(a, b), high = farthest_w(a, b);
    if (low == high && eye_w <= low) return eye_z(low, delta) * (1 - kRounding);
    return std::min({eye_z(low, delta), eye_z(low, 1), eye_z(high, delta), eye_z(high, 1)}) *
           (1 - kRounding);
  }
};

void VisibleCells::begin(const glm::dmat4& clip_from_relative, int width, int height, double z_near,
                         double z_far) {
  clip_from_relative_ = clip_from_relative;
  width_ = width, height_ = height;
  z_near_ = z_near, z_far_ = z_far;
  stride_ = std::size_t((width + kCell - 1) / kCell) * kTiles;
  closed_.assign(stride_ * std::size_t((height + kCell - 1) / kCell) * kTiles,
                 std::numeric_limits<float>::infinity());
}

glm::dmat3 VisibleCells::append(std::uint32_t picture, const StandingPicture& standing,
                                const PictureBlocksView& blocks, std::vector<DrawnCells>& drawn) {
  Placement p;
  const auto raster = [&](const glm::dvec4& clip) {
    return glm::dvec3(0.5 * width_ * (clip.x + clip.w), 0.5 * height_ * (clip.y + clip.w), clip.w);
  };
  p.origin = raster(clip_from_relative_ * glm::dvec4(standing.origin, 1));
  p.u = raster(clip_from_relative_ * glm::dvec4(standing.u_axis, 0)) / double(blocks.width);
  p.v = raster(clip_from_relative_ * glm::dvec4(standing.v_axis, 0)) / double(blocks.height);
  p.texel_from_raster = glm::inverse(glm::dmat3(p.u, p.v, p.origin));
  p.eye_w = (clip_from_relative_ * glm::dvec4(standing.eye, 1)).w;
  p.relief = standing.relief, p.hides = standing.hides;
  if (p.relief)
    p.near_ratio = standing.plane_z / standing.z_near,
    p.far_ratio = standing.plane_z / standing.z_far;

  glm::dvec3 low{std::numeric_limits<double>::infinity()}, high = -low;
  for (const double x : {0, blocks.width})
    for (const double y : {0, blocks.height}) {
      const glm::dvec3 h = p.at(x, y);
      const glm::dvec3 corner{h.x / h.z, h.y / h.z, h.z};
      low = glm::min(low, corner), high = glm::max(high, corner);
    }
  bool on_screen = low.z > z_near_;
  if (on_screen) {
    p.x0 = floor_int(std::max(low.x, 0.0) / kCell);
    p.x1 = floor_int(std::min(high.x, width_ - 0.5) / kCell);
    p.y0 = floor_int(std::max(low.y, 0.0) / kCell);
    p.y1 = floor_int(std::min(high.y, height_ - 0.5) / kCell);
    if (p.x0 > p.x1 || p.y0 > p.y1) return p.texel_from_raster;
    // Beyond the polygon's horizon its plane is behind the eye. 1 / eye_z, affine in x and y.
    double least = std::numeric_limits<double>::infinity();
    for (const int x : {p.x0, p.x1 + 1})
      for (const int y : {p.y0, p.y1 + 1})
        least = std::min(least, (p.texel_from_raster * glm::dvec3(x * kCell, y * kCell, 1)).z);
    on_screen = least > 0;
    const double change =
        kTile * (std::abs(p.texel_from_raster[0].z) + std::abs(p.texel_from_raster[1].z));
    if (change < kLevel * least) p.inside = float(0.5 / kTile - kLevel);
  }
  if (!on_screen) {
    // A polygon that reaches behind the eye has no outline on the screen.
    drawn.push_back({picture, 0, 0, 0, 0});
    return p.texel_from_raster;
  }

  open_runs_.clear();
  seen_.resize(std::size_t(p.x1) + 1);
  for (int row = p.y0; row <= p.y1; ++row) {
    for (int column = p.x0; column <= p.x1; ++column)
      seen_[std::size_t(column)] = look_at_cell(p, blocks, column, row);
    append_runs(picture, p, row, drawn);
  }
  return p.texel_from_raster;
}

// Is anything of the picture seen in the cell? If so, closes the tiles that it closes.
bool VisibleCells::look_at_cell(const Placement& p, const PictureBlocksView& blocks, int column,
                                int row) {
  glm::vec2 t[kTiles + 1][kTiles + 1];  // corners of the cell's tiles, in texels
  for (int y = 0; y <= kTiles; ++y) {
    glm::dvec3 h = p.texel_from_raster * glm::dvec3(column * kCell, row * kCell + y * kTile, 1);
    for (int x = 0; x <= kTiles; ++x, h += double(kTile) * p.texel_from_raster[0]) {
      const double z = 1 / h.z;
      t[y][x] = glm::vec2(float(h.x * z), float(h.y * z));
    }
  }
  const auto bounds = [&](int x, int y, int tiles, glm::vec2& a, glm::vec2& b) {
    const glm::vec2 &c0 = t[y][x], &c1 = t[y][x + tiles], &c2 = t[y + tiles][x],
                    &c3 = t[y + tiles][x + tiles];
    a = glm::min(glm::min(c0, c1), glm::min(c2, c3));
    b = glm::max(glm::max(c0, c1), glm::max(c2, c3));
  };
  float* closed = &closed_[std::size_t(row * kTiles) * stride_ + std::size_t(column * kTiles)];
  const glm::vec2 last(float(blocks.width - 1), float(blocks.height - 1));
  const auto clamped = [&](const glm::vec2& texel) {
    return glm::ivec2(glm::clamp(texel, glm::vec2(0), last));
  };

  // All of it at once, by larger blocks.
  glm::vec2 a, b;
  bounds(0, 0, kTiles, a, b);
  glm::ivec2 from = clamped(a - kTexelRounding) / kCellTexels,
             to = clamped(b + kTexelRounding) / kCellTexels;
  std::uint8_t nearest = 255;
  for (int y = from.y; y <= to.y; ++y)
    for (int x = from.x; x <= to.x; ++x) nearest = std::min(nearest, blocks.cell(x, y));
  if (nearest == 255) return false;
  float open = 0;
  for (int y = 0; y < kTiles; ++y)
    for (int x = 0; x < kTiles; ++x)
      open = std::max(open, closed[std::size_t(y) * stride_ + std::size_t(x)]);
  if (open <= p.nearest_eye_z(a, b, nearest)) return false;

  bool seen = false;
  for (int y = 0; y < kTiles; ++y)
    for (int x = 0; x < kTiles; ++x) {
      if (seen && !p.hides) return true;
      bounds(x, y, 1, a, b);
      if (b.x < 0 || b.y < 0 || a.x > last.x + 1 || a.y > last.y + 1) continue;
      float& tile = closed[std::size_t(y) * stride_ + std::size_t(x)];
      const glm::vec2 inside = p.inside * (b - a) - kTexelRounding;
      a += inside, b -= inside;
      if (!seen) {
        from = clamped(a) / kBlockTexels, to = clamped(b) / kBlockTexels;
        nearest = 255;
        for (int by = from.y; by <= to.y; ++by)
          for (int bx = from.x; bx <= to.x; ++bx)
            nearest = std::min(nearest, blocks.block(bx, by).nearest);
        if (nearest == 255 || tile <= p.nearest_eye_z(a, b, nearest)) continue;
        seen = true;
      }
      if (!p.hides || a.x < inside.x || a.y < inside.y || b.x + inside.x > last.x + 1 ||
          b.y + inside.y > last.y + 1)
        continue;
      from = clamped(a - kFilterTexels) / kBlockTexels;
      to = clamped(b + kFilterTexels) / kBlockTexels;
      std::uint8_t opaque = 1, farthest = 0;
      for (int by = from.y; by <= to.y; ++by)
        for (int bx = from.x; bx <= to.x; ++bx) {
          const PictureBlock& block = blocks.block(bx, by);
          opaque &= block.farthest;
          farthest = std::max(farthest, block.farthest);
        }
      if (!opaque) continue;
      const double w = p.farthest_w(a, b), delta = PictureBlock{0, farthest}.farthest_delta();
      const double eye_z = std::max({p.eye_z(w, delta), p.eye_z(w, 0), w}) * (1 + kRounding);
      // What lies beyond the far plane is clipped, and hides nothing.
      if (eye_z < z_far_) tile = std::min(tile, float(eye_z));
    }
  return seen;
}

// The row's runs of cells that are seen; they lengthen those of the row below where they can.
void VisibleCells::append_runs(std::uint32_t picture, const Placement& p, int row,
                               std::vector<DrawnCells>& drawn) {
  next_runs_.clear();
  std::size_t below = 0;  // first run of the row below that may still be the same
  for (int column = p.x0; column <= p.x1; ++column) {
    if (!seen_[std::size_t(column)]) continue;
    const int first = column;
    while (column + 1 <= p.x1 && seen_[std::size_t(column) + 1]) ++column;
    const auto pixel = [](int cell, int most) {
      return std::uint16_t(std::min(cell * kCell, most));
    };
    const DrawnCells run{picture, pixel(first, width_), pixel(row, height_),
                         pixel(column + 1, width_), pixel(row + 1, height_)};
    while (below < open_runs_.size() && drawn[open_runs_[below]].x0 < run.x0) ++below;
    if (below < open_runs_.size() && drawn[open_runs_[below]].x0 == run.x0 &&
        drawn[open_runs_[below]].x1 == run.x1) {
      drawn[open_runs_[below]].y1 = run.y1;
      next_runs_.push_back(open_runs_[below]);
    } else {
      next_runs_.push_back(std::uint32_t(drawn.size()));
      drawn.push_back(run);
    }
  }
  std::swap(open_runs_, next_runs_);
}

}  // namespace rilievo
