#include "rilievo/draw/visible_cells.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rilievo {
namespace {

// eye_z in doubles against fragments in floats: a few parts in 2^24, and room to spare.
constexpr double kRounding = 1e-4;
// Colour is interpolated from half a texel around; one more for rounding.
constexpr double kFilterTexels = 1.5;

int floor_int(double v) { return int(std::floor(v)); }

}  // namespace

// (x w, y w, w) of the frame for a point of the polygon, given in texels; w is its eye_z.
struct VisibleCells::Homography {
  glm::dvec3 origin, u, v;

  Homography(const glm::dmat4& clip_from_relative, const StandingPicture& p,
             const PictureBlocksView& blocks, int width, int height) {
    const auto raster = [&](const glm::dvec4& clip) {
      return glm::dvec3(0.5 * width * (clip.x + clip.w), 0.5 * height * (clip.y + clip.w), clip.w);
    };
    origin = raster(clip_from_relative * glm::dvec4(p.origin, 1));
    u = raster(clip_from_relative * glm::dvec4(p.u_axis, 0)) / double(blocks.width);
    v = raster(clip_from_relative * glm::dvec4(p.v_axis, 0)) / double(blocks.height);
    eye_w = (clip_from_relative * glm::dvec4(p.eye, 1)).w;
    near_ratio = p.relief ? p.plane_z / p.z_near : 1.0;
    far_ratio = p.relief ? p.plane_z / p.z_far : 1.0;
  }

  [[nodiscard]] glm::dvec3 at(double x, double y) const { return origin + x * u + y * v; }

  // The surface at Delta stands at E + (P - E) / q, q affine in Delta: so does its eye_z.
  double eye_w = 0, near_ratio = 1, far_ratio = 1;
  [[nodiscard]] double eye_z(double polygon_w, double delta) const {
    return eye_w + (polygon_w - eye_w) / (near_ratio + delta * (far_ratio - near_ratio));
  }
};

void VisibleCells::begin(const glm::dmat4& clip_from_relative, int width, int height, double z_near,
                         double z_far) {
  clip_from_relative_ = clip_from_relative;
  width_ = width, height_ = height;
  z_near_ = z_near, z_far_ = z_far;
  tiles_ = (width + kTile - 1) / kTile;
  tile_rows_ = (height + kTile - 1) / kTile;
  closed_.assign(std::size_t(tiles_) * std::size_t(tile_rows_),
                 std::numeric_limits<float>::infinity());
}

void VisibleCells::append(std::uint32_t picture, const StandingPicture& standing,
                          const PictureBlocksView& blocks, std::vector<DrawnCells>& drawn) {
  const Homography raster(clip_from_relative_, standing, blocks, width_, height_);
  double nearest = std::numeric_limits<double>::infinity();
  for (const double x : {0, blocks.width})
    for (const double y : {0, blocks.height}) nearest = std::min(nearest, raster.at(x, y).z);
  if (!(nearest > z_near_)) {
    // A polygon that reaches behind the eye has no outline on the screen.
    drawn.push_back({picture, 0, 0, std::uint16_t(blocks.width), std::uint16_t(blocks.height)});
    return;
  }
  append_cells(picture, raster, standing, blocks, drawn);
  if (standing.hides) close_tiles(raster, blocks);
}

void VisibleCells::append_cells(std::uint32_t picture, const Homography& raster,
                                const StandingPicture& standing, const PictureBlocksView& blocks,
                                std::vector<DrawnCells>& drawn) {
  const int columns = cells_across(blocks.width), rows = cells_across(blocks.height);
  const auto edge = [](int cell, int texels) { return std::min(cell * kCellTexels, texels); };
  // Corners of a row of cells: x, y in the frame, eye_z of the polygon.
  const auto corners = [&](int row, std::vector<glm::dvec3>& out) {
    out.resize(std::size_t(columns) + 1);
    for (int column = 0; column <= columns; ++column) {
      const glm::dvec3 h = raster.at(edge(column, blocks.width), edge(row, blocks.height));
      out[std::size_t(column)] = {h.x / h.z, h.y / h.z, h.z};
    }
  };
  const auto seen = [&](int column, std::uint8_t nearest) {
    if (nearest == 255) return false;
    const glm::dvec3 c[] = {lower_[std::size_t(column)], lower_[std::size_t(column) + 1],
                            upper_[std::size_t(column)], upper_[std::size_t(column) + 1]};
    glm::dvec3 low = c[0], high = c[0];
    for (const glm::dvec3& corner : c) low = glm::min(low, corner), high = glm::max(high, corner);
    // A pixel more: samples of pixels whose centres lie outside.
    const int x0 = floor_int((std::max(low.x - 1, 0.0)) / kTile),
              x1 = floor_int(std::min(high.x + 1, width_ - 0.5) / kTile),
              y0 = floor_int((std::max(low.y - 1, 0.0)) / kTile),
              y1 = floor_int(std::min(high.y + 1, height_ - 0.5) / kTile);
    const double delta = standing.relief ? nearest / 254.0 : 0.0;
    const double eye_z = std::min({raster.eye_z(low.z, delta), raster.eye_z(low.z, 1),
                                   raster.eye_z(high.z, delta), raster.eye_z(high.z, 1)}) *
                         (1 - kRounding);
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x)
        if (closed_[std::size_t(y) * std::size_t(tiles_) + std::size_t(x)] > eye_z) return true;
    return false;
  };
  open_runs_.clear();
  corners(0, upper_);
  for (int row = 0; row < rows; ++row) {
    std::swap(lower_, upper_);
    corners(row + 1, upper_);
    next_runs_.clear();
    std::size_t below = 0;  // first run of the row below that may still be the same
    for (int column = 0; column < columns; ++column) {
      if (!seen(column, blocks.cell(column, row))) continue;
      const int first = column;
      while (column + 1 < columns && seen(column + 1, blocks.cell(column + 1, row))) ++column;
      const DrawnCells run{picture, std::uint16_t(std::max(0, first * kCellTexels - 1)),
                           std::uint16_t(std::max(0, row * kCellTexels - 1)),
                           std::uint16_t(std::min(blocks.width, (column + 1) * kCellTexels + 1)),
                           std::uint16_t(std::min(blocks.height, (row + 1) * kCellTexels + 1))};
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
}

void VisibleCells::close_tiles(const Homography& raster, const PictureBlocksView& blocks) {
  const double w = blocks.width, h = blocks.height;
  glm::dvec3 low{std::numeric_limits<double>::infinity()}, high = -low;
  for (const double x : {0.0, w})
    for (const double y : {0.0, h}) {
      const glm::dvec3 c = raster.at(x, y);
      const glm::dvec3 at{c.x / c.z, c.y / c.z, c.z};
      low = glm::min(low, at), high = glm::max(high, at);
    }
  const double nearest = std::min(raster.eye_z(low.z, 0), raster.eye_z(high.z, 0));
  const int x0 = std::max(0, floor_int(low.x / kTile)),
            x1 = std::min(tiles_ - 1, floor_int(high.x / kTile)),
            y0 = std::max(0, floor_int(low.y / kTile)),
            y1 = std::min(tile_rows_ - 1, floor_int(high.y / kTile));
  if (x0 > x1 || y0 > y1) return;
  const glm::dmat3 texel_from_raster = glm::inverse(glm::dmat3(raster.u, raster.v, raster.origin));
  const auto corners = [&](int y, std::vector<glm::dvec3>& out) {
    out.resize(std::size_t(x1 - x0) + 2);
    for (int x = x0; x <= x1 + 1; ++x) {
      const glm::dvec3 t = texel_from_raster * glm::dvec3(x * kTile, y * kTile, 1);
      out[std::size_t(x - x0)] = {t.x / t.z, t.y / t.z, t.z};
    }
  };
  corners(y0, upper_);
  for (int y = y0; y <= y1; ++y) {
    std::swap(lower_, upper_);
    corners(y + 1, upper_);
    for (int x = x0; x <= x1; ++x) {
      float& closed = closed_[std::size_t(y) * std::size_t(tiles_) + std::size_t(x)];
      if (closed <= nearest) continue;
      const auto i = std::size_t(x - x0);
      glm::dvec3 a =
          glm::min(glm::min(lower_[i], lower_[i + 1]), glm::min(upper_[i], upper_[i + 1]));
      glm::dvec3 b =
          glm::max(glm::max(lower_[i], lower_[i + 1]), glm::max(upper_[i], upper_[i + 1]));
      a -= kFilterTexels, b += kFilterTexels;
      // Beyond the polygon's horizon t.z changes its sign; a + kFilterTexels undoes the margin.
      if (!(a.z + kFilterTexels > 0) || a.x < 0 || a.y < 0 || b.x >= w || b.y >= h) continue;
      double farthest = 0;
      bool opaque = true;
      for (int by = int(a.y) / kBlockTexels; opaque && by <= int(b.y) / kBlockTexels; ++by)
        for (int bx = int(a.x) / kBlockTexels; bx <= int(b.x) / kBlockTexels; ++bx) {
          const PictureBlock& block = blocks.block(bx, by);
          opaque &= block.opaque();
          farthest = std::max(farthest, block.farthest_delta());
        }
      if (!opaque) continue;
      const double polygon_w = raster.origin.z + std::max(a.x * raster.u.z, b.x * raster.u.z) +
                               std::max(a.y * raster.v.z, b.y * raster.v.z);
      const double eye_z =
          std::max({raster.eye_z(polygon_w, farthest), raster.eye_z(polygon_w, 0), polygon_w}) *
          (1 + kRounding);
      // What lies beyond the far plane is clipped, and hides nothing.
      if (eye_z < z_far_) closed = std::min(closed, float(eye_z));
    }
  }
}

}  // namespace rilievo
