// Let a and b bound the corners of a tile of n x n pixels, in texels. A fragment's texel is the one
// at its pixel's centre, half a pixel inside the tile: were the map from pixels to texels affine,
//
//   (b - a) / 2n (1)
//
// inside of a and b. The map of a polygon seen at an angle is not, but nearly: while 1 / eye_z
// changes over a tile by less than a part e of itself, the texel moves by less than e (b - a). So
// the part of b - a that is counted on is 1 / 2n - e, and none at a greater e than kLevel.
#include "rilievo/nailboard/visible_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

// eye_z in doubles against fragments in floats: a few parts in 2^24, and room to spare.
constexpr double kRounding = 1e-4;
// Texels in floats, here and where they are drawn: a few parts in 2^24 of 1024, and room to spare.
constexpr float kTexelRounding = 0.01f;
// Colour is interpolated between centres of texels: from half a texel around.
constexpr float kFilterTexels = 0.5f;
constexpr double kLevel = 0.005;
constexpr double kNowhere = std::numeric_limits<double>::infinity();

int floor_int(double v) { return int(std::floor(v)); }

// Of drawing a rectangle, in pixels shaded. Blocks of 4 x 4 pixels on the diagonal, where its two
// triangles meet, are shaded twice; and a rectangle has costs of its own.
int cost(const DrawnCells& cells) {
  const int w = cells.x1 - cells.x0, h = cells.y1 - cells.y0;
  return w * h + 4 * (w + h) + 100;
}

// Of the four corners of a tile, texels.
struct Bounds {
  glm::vec2 a, b;

  Bounds(const glm::vec2& c0, const glm::vec2& c1, const glm::vec2& c2, const glm::vec2& c3)
      : a(glm::min(glm::min(c0, c1), glm::min(c2, c3))),
        b(glm::max(glm::max(c0, c1), glm::max(c2, c3))) {}
  // To the fragments inside: see (1).
  void shrink(float inside) {
    const glm::vec2 by = inside * (b - a) - kTexelRounding;
    a += by, b -= by;
  }
};

}  // namespace

struct VisibleCells::Placement {
  // (x w, y w, w) of the frame for a point of the polygon, given in texels; w is its eye_z.
  glm::dvec3 origin, u, v;
  glm::dmat3 texel_from_raster;
  // The surface at Delta stands at E + (P - E) / q, q affine in Delta: so does its eye_z.
  double eye_w = 0, near_ratio = 1, far_ratio = 1;
  double least_stretch = 1, most_stretch = 1;  // at Delta 0 and 1
  int x0 = 0, y0 = 0, x1 = -1, y1 = -1;  // the first and the last cells that the polygon touches
  // Of b - a: how far at least fragments lie inside of a tile, of a cell.
  float inside = 0, inside_cell = 0;
  float nearest = 0;  // eye_z of all that the picture shows
  bool relief = true, hides = true, share = false, whole = false;
  const Placement* partner = nullptr;  // one that has been looked at before
  OcclusionTilesView blocks;

  [[nodiscard]] glm::dvec3 at(double x, double y) const { return origin + x * u + y * v; }
  // 1 / q.
  [[nodiscard]] double stretch(double delta) const {
    return 1 / (near_ratio + delta * (far_ratio - near_ratio));
  }
  [[nodiscard]] double eye_z(double polygon_w, double stretch) const {
    return eye_w + (polygon_w - eye_w) * stretch;
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
    const double least = stretch(relief ? nearest / 254.0 : 0.0);
    const double low = nearest_w(a, b), high = farthest_w(a, b);
    return std::min({eye_z(low, least), eye_z(low, most_stretch), eye_z(high, least),
                     eye_z(high, most_stretch)}) *
           (1 - kRounding);
  }
  // Of a pixel, in texels.
  [[nodiscard]] glm::vec2 texel(int x, int y) const {
    const glm::dvec3 h = texel_from_raster * glm::dvec3(x, y, 1);
    return {float(h.x / h.z), float(h.y / h.z)};
  }
  [[nodiscard]] glm::ivec2 clamped(const glm::vec2& texel) const {
    return glm::clamp(glm::ivec2(texel), glm::ivec2(0),
                      glm::ivec2(blocks.width - 1, blocks.height - 1));
  }
  // Of what the picture shows of a tile with these bounds, in steps of OcclusionTile; 255: nothing.
  [[nodiscard]] std::uint8_t nearest_delta(const Bounds& fragments) const {
    const glm::ivec2 from = clamped(fragments.a), to = clamped(fragments.b);
    std::uint8_t nearest = 255;
    for (int y = from.y / kBlockTexels; y <= to.y / kBlockTexels; ++y)
      for (int x = from.x / kBlockTexels; x <= to.x / kBlockTexels; ++x) {
        const OcclusionTile& block = blocks.block(x, y);
        if (texels_of_block({x, y}, from, to) & block.covered)
          nearest = std::min(nearest, block.nearest);
      }
    return nearest;
  }
  // Beyond which eye_z does the picture hide everything in a tile with these bounds, inside of
  // which fragments lie so far? Infinite: nowhere.
  [[nodiscard]] double hides_beyond(Bounds tile, float inside_tile) const {
    auto& [a, b] = tile;
    if (a.x < 0 || a.y < 0 || b.x > float(blocks.width) || b.y > float(blocks.height))
      return kNowhere;
    tile.shrink(inside_tile);
    const glm::ivec2 from = clamped(a - kFilterTexels), to = clamped(b + kFilterTexels);
    OcclusionTile all;
    for (int y = from.y / kBlockTexels; y <= to.y / kBlockTexels; ++y)
      for (int x = from.x / kBlockTexels; x <= to.x / kBlockTexels; ++x) {
        const OcclusionTile& block = blocks.block(x, y);
        if (texels_of_block({x, y}, from, to) & ~block.opaque) return kNowhere;
        all.farthest = std::max(all.farthest, block.farthest);
      }
    const double w = farthest_w(a, b);
    return std::max({eye_z(w, stretch(all.farthest_delta())), eye_z(w, least_stretch), w}) *
           (1 + kRounding);
  }
  // The same of a tile, by its lower left pixel.
  [[nodiscard]] double hides_beyond(int x, int y) const;
};

double VisibleCells::Placement::hides_beyond(int x, int y) const {
  // Beyond the polygon's own cells the map may be of what lies behind the eye.
  if (x < x0 * kCell || y < y0 * kCell || x >= (x1 + 1) * kCell || y >= (y1 + 1) * kCell)
    return kNowhere;
  return hides_beyond(
      Bounds(texel(x, y), texel(x + kTile, y), texel(x, y + kTile), texel(x + kTile, y + kTile)),
      inside);
}

// Rows of cells, and what was found there: of pictures as a whole, of shares.
struct VisibleCells::Band {
  int first = 0, end = 0;
  std::vector<DrawnCells> drawn[2];
  std::vector<std::uint8_t> seen;              // by cell of a row: bits of look_at_cell
  std::vector<std::uint32_t> open, next_open;  // rectangles that end in the last row

  void append_runs(std::uint32_t picture, int x0, int x1, int row, const glm::ivec2& size,
                   std::vector<DrawnCells>& to);
};

VisibleCells::VisibleCells() = default;
VisibleCells::VisibleCells(VisibleCells&&) noexcept = default;
VisibleCells& VisibleCells::operator=(VisibleCells&&) noexcept = default;
VisibleCells::~VisibleCells() = default;

const glm::dmat3& VisibleCells::texel_from_raster(std::size_t picture) const {
  return placed_[picture].texel_from_raster;
}

void VisibleCells::find(const glm::dmat4& clip_from_relative, int width, int height, double z_near,
                        double z_far, std::span<const PlacedPolygon> pictures) {
  clip_from_relative_ = clip_from_relative;
  width_ = width, height_ = height;
  z_near_ = z_near, z_far_ = z_far;
  const int rows = (height + kCell - 1) / kCell;
  stride_ = std::size_t((width + kCell - 1) / kCell) * kTiles;
  closed_.assign(stride_ * std::size_t(rows) * kTiles, std::numeric_limits<float>::infinity());

  placed_.assign(pictures.size(), {});
  for (std::size_t i = 0; i < pictures.size(); ++i) {
    place(pictures[i], placed_[i]);
    if (pictures[i].partner && *pictures[i].partner < i && pictures[*pictures[i].partner].hides)
      placed_[i].partner = &placed_[*pictures[i].partner];
  }
  bands_.resize(kBands);
  const int band_rows = (rows + kBands - 1) / kBands;
  parallel_for(0, kBands, [&](int i) {
    Band& band = bands_[std::size_t(i)];
    band.first = std::min(rows, i * band_rows), band.end = std::min(rows, (i + 1) * band_rows);
    look_at_band(band);
  });

  drawn_.clear();
  for (const bool share : {false, true}) {
    for (std::uint32_t i = 0; i < placed_.size(); ++i)
      if (placed_[i].whole && placed_[i].share == share) drawn_.push_back({i, 0, 0, 0, 0});
    for (const Band& band : bands_)
      drawn_.insert(drawn_.end(), band.drawn[share].begin(), band.drawn[share].end());
    if (!share) before_shares_ = drawn_.size();
  }
}

void VisibleCells::place(const PlacedPolygon& standing, Placement& p) const {
  const OcclusionTilesView& blocks = p.blocks = standing.blocks;
  const auto raster = [&](const glm::dvec4& clip) {
    return glm::dvec3(0.5 * width_ * (clip.x + clip.w), 0.5 * height_ * (clip.y + clip.w), clip.w);
  };
  p.origin = raster(clip_from_relative_ * glm::dvec4(standing.origin, 1));
  p.u = raster(clip_from_relative_ * glm::dvec4(standing.u_axis, 0)) / double(blocks.width);
  p.v = raster(clip_from_relative_ * glm::dvec4(standing.v_axis, 0)) / double(blocks.height);
  p.texel_from_raster = glm::inverse(glm::dmat3(p.u, p.v, p.origin));
  p.eye_w = (clip_from_relative_ * glm::dvec4(standing.eye, 1)).w;
  p.relief = standing.relief, p.hides = standing.hides, p.share = standing.share;
  if (p.relief)
    p.near_ratio = standing.plane_z / standing.z_near,
    p.far_ratio = standing.plane_z / standing.z_far;
  p.least_stretch = p.stretch(0), p.most_stretch = p.stretch(1);

  glm::dvec3 low{std::numeric_limits<double>::infinity()}, high = -low;
  for (const double x : {0, blocks.width})
    for (const double y : {0, blocks.height}) {
      const glm::dvec3 h = p.at(x, y);
      const glm::dvec3 corner{h.x / h.z, h.y / h.z, h.z};
      low = glm::min(low, corner), high = glm::max(high, corner);
    }
  // A polygon that reaches behind the eye has no outline on the screen.
  p.whole = low.z <= z_near_;
  if (p.whole) return;
  const int x0 = floor_int(std::max(low.x, 0.0) / kCell);
  const int x1 = floor_int(std::min(high.x, width_ - 0.5) / kCell);
  const int y0 = floor_int(std::max(low.y, 0.0) / kCell);
  const int y1 = floor_int(std::min(high.y, height_ - 0.5) / kCell);
  if (x0 > x1 || y0 > y1) return;
  // Beyond the polygon's horizon its plane is behind the eye. 1 / eye_z, affine in x and y.
  double least = std::numeric_limits<double>::infinity();
  for (const int x : {x0, x1 + 1})
    for (const int y : {y0, y1 + 1})
      least = std::min(least, (p.texel_from_raster * glm::dvec3(x * kCell, y * kCell, 1)).z);
  p.whole = least <= 0;
  if (p.whole) return;
  const double change = std::abs(p.texel_from_raster[0].z) + std::abs(p.texel_from_raster[1].z);
  const auto inside = [&](int n) {
    return n * change < kLevel * least ? float(0.5 / n - kLevel) : 0.0f;
  };
  p.inside = inside(kTile), p.inside_cell = inside(kCell);
  std::uint8_t nearest = 255;
  for (int y = 0; y < cells_across(blocks.height); ++y)
    for (int x = 0; x < cells_across(blocks.width); ++x)
      nearest = std::min(nearest, blocks.cell(x, y));
  if (nearest == 255) return;
  p.nearest = float(p.nearest_eye_z({0, 0}, {blocks.width, blocks.height}, nearest));
  p.x0 = x0, p.x1 = x1, p.y0 = y0, p.y1 = y1;
}

void VisibleCells::look_at_band(Band& band) {
  for (std::vector<DrawnCells>& drawn : band.drawn) drawn.clear();
  band.seen.resize(stride_ / kTiles);
  for (std::uint32_t i = 0; i < placed_.size(); ++i) {
    const Placement& p = placed_[i];
    band.open.clear();
    for (int row = std::max(p.y0, band.first); row <= std::min(p.y1, band.end - 1); ++row) {
      for (int column = p.x0; column <= p.x1; ++column)
        band.seen[std::size_t(column)] = look_at_cell(p, column, row);
      band.append_runs(i, p.x0, p.x1, row, {width_, height_}, band.drawn[p.share]);
    }
  }
}

// In which tiles of the cell is anything of the picture seen? Bit x + 2 y. Closes those that it
// closes.
std::uint8_t VisibleCells::look_at_cell(const Placement& p, int column, int row) {
  float* closed = &closed_[std::size_t(row * kTiles) * stride_ + std::size_t(column * kTiles)];
  float open = 0, least_open = std::numeric_limits<float>::infinity();
  for (int y = 0; y < kTiles; ++y)
    for (int x = 0; x < kTiles; ++x) {
      const float beyond = closed[std::size_t(y) * stride_ + std::size_t(x)];
      open = std::max(open, beyond), least_open = std::min(least_open, beyond);
    }
  if (open <= p.nearest) return 0;

  glm::vec2 t[kTiles + 1][kTiles + 1];  // corners of the cell's tiles, in texels
  for (int y = 0; y <= kTiles; ++y) {
    glm::dvec3 h = p.texel_from_raster * glm::dvec3(column * kCell, row * kCell + y * kTile, 1);
    for (int x = 0; x <= kTiles; ++x, h += double(kTile) * p.texel_from_raster[0]) {
      const double z = 1 / h.z;
      t[y][x] = glm::vec2(float(h.x * z), float(h.y * z));
    }
  }

  // All of it at once: nothing is before it, and it hides what is behind ...
  const Bounds cell(t[0][0], t[0][kTiles], t[kTiles][0], t[kTiles][kTiles]);
  if (p.hides && !p.share && least_open == std::numeric_limits<float>::infinity())
    // What lies beyond the far plane is clipped, and hides nothing.
    if (const double eye_z = p.hides_beyond(cell, p.inside_cell); eye_z < z_far_) {
      for (int y = 0; y < kTiles; ++y)
        std::fill_n(closed + std::size_t(y) * stride_, kTiles, float(eye_z));
      return (1u << (kTiles * kTiles)) - 1;
    }
  // ... or it is empty or hidden, by larger blocks.
  const glm::ivec2 from = p.clamped(cell.a - kTexelRounding) / kCellTexels,
                   to = p.clamped(cell.b + kTexelRounding) / kCellTexels;
  std::uint8_t nearest = 255;
  for (int y = from.y; y <= to.y; ++y)
    for (int x = from.x; x <= to.x; ++x) nearest = std::min(nearest, p.blocks.cell(x, y));
  if (nearest == 255 || open <= p.nearest_eye_z(cell.a, cell.b, nearest)) return 0;

  const bool may_hide = p.hides && (!p.share || p.partner);
  std::uint8_t seen = 0;
  for (int y = 0; y < kTiles; ++y)
    for (int x = 0; x < kTiles; ++x) {
      const Bounds tile(t[y][x], t[y][x + 1], t[y + 1][x], t[y + 1][x + 1]);
      if (tile.b.x < 0 || tile.b.y < 0 || tile.a.x > float(p.blocks.width) ||
          tile.a.y > float(p.blocks.height))
        continue;
      float& beyond = closed[std::size_t(y) * stride_ + std::size_t(x)];
      if (beyond <= p.nearest) continue;
      Bounds fragments = tile;
      fragments.shrink(p.inside);
      nearest = p.nearest_delta(fragments);
      if (nearest == 255 || beyond <= p.nearest_eye_z(fragments.a, fragments.b, nearest)) continue;
      seen = std::uint8_t(seen | 1u << (x + kTiles * y));
      if (!may_hide) continue;
      double eye_z = p.hides_beyond(tile, p.inside);
      if (p.share && eye_z < z_far_)
        eye_z = std::max(
            eye_z, p.partner->hides_beyond(column * kCell + x * kTile, row * kCell + y * kTile));
      if (eye_z < z_far_) beyond = std::min(beyond, float(eye_z));
    }
  return seen;
}

// The row's runs of cells that are seen, without the rows and columns of tiles at their edges that
// are not; they join rectangles of the row below where that is cheaper, even if it draws cells that
// need not be.
void VisibleCells::Band::append_runs(std::uint32_t picture, int x0, int x1, int row,
                                     const glm::ivec2& size, std::vector<DrawnCells>& to) {
  next_open.clear();
  std::size_t below = 0;  // first rectangle of the row below that may still be joined
  for (int column = x0; column <= x1; ++column) {
    if (!seen[std::size_t(column)]) continue;
    const int first = column;
    std::uint8_t any = seen[std::size_t(column)];
    while (column + 1 <= x1 &&
           (seen[std::size_t(column) + 1] || (column + 2 <= x1 && seen[std::size_t(column) + 2])))
      any |= seen[std::size_t(++column)];
    static_assert(kTiles == 2, "two columns and two rows of tiles");
    constexpr int kLeft = 0b0101, kRight = 0b1010, kLower = 0b0011, kUpper = 0b1100;
    const auto pixel = [](int tile, int most) {
      return std::uint16_t(std::min(tile * kTile, most));
    };
    const DrawnCells run{picture, pixel(2 * first + !(seen[std::size_t(first)] & kLeft), size.x),
                         pixel(2 * row + !(any & kLower), size.y),
                         pixel(2 * column + 2 - !(seen[std::size_t(column)] & kRight), size.x),
                         pixel(2 * row + 2 - !(any & kUpper), size.y)};
    // Nothing of it but tiles beyond the frame's edges?
    if (run.x0 == run.x1 || run.y0 == run.y1) continue;
    while (below < open.size() && to[open[below]].x1 <= run.x0) ++below;
    if (below < open.size() && to[open[below]].x0 < run.x1) {
      DrawnCells& rectangle = to[open[below]];
      DrawnCells joined = rectangle;
      joined.x0 = std::min(joined.x0, run.x0), joined.x1 = std::max(joined.x1, run.x1);
      joined.y1 = run.y1;
      if (cost(joined) <= cost(rectangle) + cost(run)) {
        rectangle = joined;
        next_open.push_back(open[below++]);
        continue;
      }
    }
    next_open.push_back(std::uint32_t(to.size()));
    to.push_back(run);
  }
  std::swap(open, next_open);
}

}  // namespace rilievo
