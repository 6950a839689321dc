// In radii of the bounds, from their centre: a point P is drawn, the source of its colour is M, and
// an eye at x sees D = P - M under the angle alpha,
//
//                    |D x (x - M)|
//   sin alpha  =  -------------------
//                  |x - P|  |x - M|
//
// All eyes in a cell of directions with the middle c are x = g / n, with g on the plane g.c = 1
// within the cell's four corners, and n = 1 / x.c the nearness. Let S be the texel's sample, r the
// distance from it to the farthest of its P and M, m to the farthest M, and |D| <= l. Then
//
//   sin alpha  <=  n T,    T = N I
//   N = max |D x (g - n S)| + n l m     as M differs from S
//   I = 1 / (1 - n (S.c + r))^2         as |x - P| >= (x - P).c
//
// N is convex in (g, n) together, and I does not depend on g: so at one n, T is largest at a corner
// of the cell. At a share t of the way from n_a to n_b, as both N and I are convex in n,
//
//   T <= ((1 - t) N_a + t N_b) ((1 - t) I_a + t I_b)
//      = (1 - t) T_a + t T_b + t (1 - t) (N_a - N_b) (I_b - I_a)
//
// and t (1 - t) <= 1 / 4. The table has T at some n, and what the last term adds on either side of
// it, largest over texels; between them it is interpolated.
//
// The displacements D of a texel:
//
//   slices    P = apex + z (e + o), e the texel's ray, o within the texel at depth 1; z from the
//             first to the last slice that shows the patch; M = S. So P and D are bilinear in z and
//             o: |D x (x - S)| is largest at ends of z and corners of the texel.
//   surfaces  a quarter of the patch is a plane in (u, v, q), so P runs straight along u and along
//             v, from corner to corner of the quarter, but not evenly: beside even steps it is off
//             by at most a quarter of |dq| / q of the edge. But for that (`slack`), D is bilinear
//             like M. Where linked patches do not quite meet, a ray can meet the step between them,
//             which grows from the middle of the border to its ends; if it is small (patch_gap).

#include "rilievo/layered_impostor/angular_error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "rilievo/core/parallel_for.h"
#include "rilievo/layered_impostor/eye_cells.h"
#include "rilievo/layered_impostor/slice_quads.h"

namespace rilievo {
namespace {

using Table = AngularErrorTable;

constexpr double kInfinite = std::numeric_limits<double>::infinity();

// The displacements of one texel.
struct Displaced {
  glm::dvec3 sample{0.0};
  std::array<glm::dvec3, 24> by;
  int count = 0;
  double length = 0, radius = 0, source_radius = 0, slack = 0;  // l, r, m

  void add(const glm::dvec3& drawn, const glm::dvec3& source) {
    by[std::size_t(count++)] = drawn - source;
    length = std::max(length, glm::length(drawn - source));
    radius = std::max({radius, glm::length(drawn - sample), glm::length(source - sample)});
    source_radius = std::max(source_radius, glm::length(source - sample));
  }
};

// One view's points, in radii of the bounds from their centre.
class Placed {
 public:
  Placed(const LayeredImpostor& impostor, std::size_t view) : surface_(impostor.surfaces[view]) {
    const Camera& camera = surface_.camera;
    const double radius = impostor.bounds.radius();
    const auto at_one = [&](double u, double v) { return world_from_raster(camera, {u, v}, 1.0); };
    apex_ = (camera.position() - glm::dvec3(impostor.bounds.center())) / radius;
    base_ = (at_one(0, 0) - camera.position()) / radius;
    along_u_ = (at_one(1, 0) - at_one(0, 0)) / radius;
    along_v_ = (at_one(0, 1) - at_one(0, 0)) / radius;
  }

  [[nodiscard]] glm::dvec3 at(const glm::dvec2& raster, double q) const {
    return apex_ + (base_ + raster.x * along_u_ + raster.y * along_v_) / q;
  }
  [[nodiscard]] const SurfaceTexel& texel(const glm::ivec2& at) const {
    return surface_.texels(at.x, at.y);
  }
  [[nodiscard]] glm::dvec3 sample(const glm::ivec2& where) const {
    return at(glm::dvec2(where) + 0.5, double(texel(where).q));
  }
  // Of the patch over `where`; `raster` may be on its edge.
  [[nodiscard]] double q_on_patch(const glm::ivec2& where, const glm::dvec2& raster) const {
    return surface_q(texel(where), glm::dvec2(where) + 0.5, raster);
  }
  // The step up to which it and a neighbour's patch pass for one surface, from either side.
  [[nodiscard]] double gap(const glm::ivec2& where) const {
    double most = patch_gap(surface_, where);
    for (int k = 0; k < 8; k += 2)
      if (texel(where).links >> k & 1)
        most = std::max(most, patch_gap(surface_, where + kLinkSteps[std::size_t(k)]));
    return most;
  }
  // Of the march's colour there.
  [[nodiscard]] glm::dvec3 source(const glm::ivec2& where, const glm::dvec2& offset) const {
    return interpolate(sample_weights(texel(where), offset), where,
                       [&](const glm::ivec2& at) { return sample(at); });
  }

 private:
  const TexelSurface& surface_;
  glm::dvec3 apex_, base_, along_u_, along_v_;  // along_...: of a texel, where eye_z = 1
};

Displaced displaced_by_slices(const LayeredImpostor& impostor, std::size_t view,
                              const Placed& placed, const glm::ivec2& texel) {
  Displaced displaced;
  displaced.sample = placed.sample(texel);
  const std::vector<Slice>& slices = impostor.slices[view];
  const float step = float(kIntervalStep) * (slices.back().back - slices.front().front);
  DepthInterval interval = piece_interval(placed.texel(texel), impostor.slicing);
  interval.front -= step, interval.back += step;
  const auto first = std::partition_point(slices.begin(), slices.end(),
                                          [&](const Slice& s) { return s.back <= interval.front; });
  const auto end = std::partition_point(first, slices.end(),
                                        [&](const Slice& s) { return s.front <= interval.back; });
  if (first == end) return displaced;
  for (const Slice& slice : {*first, *(end - 1)})
    for (int corner = 0; corner < 4; ++corner)
      displaced.add(placed.at(glm::dvec2(texel + glm::ivec2(corner & 1, corner >> 1)),
                              1 / double(slice.eye_z)),
                    displaced.sample);
  return displaced;
}

Displaced displaced_by_march(const Placed& placed, const glm::ivec2& texel) {
  Displaced displaced;
  displaced.sample = placed.sample(texel);
  const SurfaceTexel& patch = placed.texel(texel);
  const glm::dvec2 center = glm::dvec2(texel) + 0.5;
  const auto point = [&](double x, double y) {
    const glm::dvec2 raster = center + glm::dvec2(x, y);
    return placed.at(raster, placed.q_on_patch(texel, raster));
  };
  for (const double x : {-0.5, 0.5}) {
    displaced.add(point(x, 0), placed.source(texel, {x, 0}));
    displaced.add(point(0, x), placed.source(texel, {0, x}));
    for (const double y : {-0.5, 0.5}) {
      const glm::dvec3 corner = point(x, y), source = placed.source(texel, {x, y});
      displaced.add(corner, source);
      // The quarter's edges, and how much q changes along them.
      const glm::dvec3 along_u = point(x, 0), along_v = point(0, y);
      const double u = 0.5 * std::abs(double(patch.slope[x > 0 ? 0 : 2])),
                   v = 0.5 * std::abs(double(patch.slope[y > 0 ? 1 : 3]));
      const double least = std::max(double(patch.q) - u - v, 1e-3 * double(patch.q));
      const double edge_u = std::max(glm::distance(along_u, displaced.sample),
                                     glm::distance(corner, along_v)),
                   edge_v = std::max(glm::distance(along_v, displaced.sample),
                                     glm::distance(corner, along_u));
      displaced.slack = std::max(displaced.slack, 0.25 * (u * edge_u + v * edge_v) / least);
      // Where a linked neighbour's patch does not quite meet this one on the border, a ray can meet
      // what is between them: towards a corner up to their step there, and never more than the gap.
      const double gap = placed.gap(texel);
      for (const bool across_u : {true, false}) {
        if (!(patch.links >> (across_u ? (x > 0 ? 0 : 4) : (y > 0 ? 2 : 6)) & 1)) continue;
        const glm::ivec2 side =
            across_u ? glm::ivec2(x > 0 ? 1 : -1, 0) : glm::ivec2(0, y > 0 ? 1 : -1);
        const glm::dvec2 at_corner(x, y), at_middle = 0.5 * glm::dvec2(side);
        const double q = placed.q_on_patch(texel, center + at_corner),
                     beyond = placed.q_on_patch(texel + side, center + at_corner),
                     step = std::clamp(beyond - q, -gap, gap);
        displaced.add(placed.at(center + at_corner, q + step), source);
        displaced.add(
            placed.at(center + at_middle, placed.q_on_patch(texel, center + at_middle) + step),
            placed.source(texel, at_middle));
      }
    }
  }
  return displaced;
}

using Values = std::array<double, Table::kNodes>;

// What may become larger by a texel's displacements.
void add_texel(const Displaced& displaced, const EyeCell& cell, Values& values) {
  const double ahead = glm::dot(displaced.sample, cell.middle) + displaced.radius,
               far = glm::length(displaced.sample) + displaced.source_radius;
  Values most, i, n{};  // at least T with all that is added; I; N, once it is known
  bool larger = false;
  for (std::size_t k = 0; k < Table::kNodes; ++k) {
    const double nearness = Table::kNearness[k], left = 1 - nearness * ahead;
    i[k] = left > 0 ? 1 / (left * left) : kInfinite;
    most[k] = (displaced.length + displaced.slack) * (cell.farthest + nearness * far);
  }
  // N differs between nodes by less than its largest value.
  for (std::size_t k = 0; k < Table::kNodes; ++k) {
    double step = 0;
    if (k > 0) step = std::max(step, std::max(most[k], most[k - 1]) * std::abs(i[k] - i[k - 1]));
    if (k + 1 < Table::kNodes)
      step = std::max(step, std::max(most[k], most[k + 1]) * std::abs(i[k + 1] - i[k]));
    larger |= !(most[k] * i[k] + 0.25 * step <= values[k]);
  }
  if (!larger) return;

  for (std::size_t k = 0; k < Table::kNodes; ++k) {
    const double nearness = Table::kNearness[k];
    for (const glm::dvec3& corner : cell.corners) {
      const glm::dvec3 ray = corner - nearness * displaced.sample;
      double across = 0;
      for (int d = 0; d < displaced.count; ++d) {
        const glm::dvec3 c = glm::cross(displaced.by[std::size_t(d)], ray);
        across = std::max(across, glm::dot(c, c));
      }
      n[k] = std::max(
          n[k], std::sqrt(across) + nearness * displaced.length * displaced.source_radius +
                    displaced.slack * (glm::length(ray) + nearness * displaced.source_radius));
    }
  }
  for (std::size_t k = 0; k < Table::kNodes; ++k) {
    if (i[k] == kInfinite) {
      values[k] = kInfinite;
      continue;
    }
    double bend = 0;
    if (k > 0) bend = std::max(bend, (n[k - 1] - n[k]) * (i[k] - i[k - 1]));
    if (k + 1 < Table::kNodes && i[k + 1] < kInfinite)
      bend = std::max(bend, (n[k] - n[k + 1]) * (i[k + 1] - i[k]));
    values[k] = std::max(values[k], n[k] * i[k] + 0.25 * bend);
  }
}

// For eyes in a cell.
double sine_at(const Table& table, int cell, double nearness) {
  const auto value = [&](std::size_t k) {
    const std::uint8_t units = table.units[std::size_t(cell)][k];
    return units == Table::kNever ? kInfinite : units * double(table.unit[k]);
  };
  if (nearness == 0) return 0;
  for (std::size_t k = 1; k < Table::kNodes; ++k) {
    if (nearness > Table::kNearness[k]) continue;
    const double t =
        (nearness - Table::kNearness[k - 1]) / (Table::kNearness[k] - Table::kNearness[k - 1]);
    return nearness * ((1 - t) * value(k - 1) + t * value(k));
  }
  return kInfinite;
}

}  // namespace

AngularErrorTable make_angular_error_table(const LayeredImpostor& impostor,
                                           const LayeredOptions& options) {
  const bool sliced = options.method == LayeredMethod::slices;
  const std::size_t views = impostor.surfaces.size();
  std::vector<std::vector<bool>> drawn;
  for (int cell = 0; cell < kEyeCells; ++cell)
    drawn.push_back(views_drawn_from(impostor, options, cell));
  std::vector<std::array<Values, kEyeCells>> of_views(views);
  parallel_for(std::size_t(0), views, [&](std::size_t view) {
    const Placed placed(impostor, view);
    const Image<SurfaceTexel>& texels = impostor.surfaces[view].texels;
    std::array<Values, kEyeCells>& values = of_views[view];
    for (Values& of_cell : values) of_cell.fill(0);
    for (int y = 0; y < texels.height(); ++y)
      for (int x = 0; x < texels.width(); ++x) {
        if (texels(x, y).q == 0) continue;
        const Displaced displaced = sliced ? displaced_by_slices(impostor, view, placed, {x, y})
                                           : displaced_by_march(placed, {x, y});
        for (std::size_t cell = 0; cell < kEyeCells; ++cell)
          if (drawn[cell][view]) add_texel(displaced, eye_cell(int(cell)), values[cell]);
      }
  });

  AngularErrorTable table;
  for (std::size_t k = 0; k < Table::kNodes; ++k) {
    std::array<double, kEyeCells> all{};
    double largest = 0;
    for (const auto& of_view : of_views)
      for (std::size_t cell = 0; cell < kEyeCells; ++cell)
        all[cell] = std::max(all[cell], of_view[cell][k]);
    for (const double value : all)
      if (value < kInfinite) largest = std::max(largest, value);
    // 254 of them are a little more than the largest value: rounding must not make them less.
    table.unit[k] = float(1.000001 * largest / 254);
    for (std::size_t cell = 0; cell < kEyeCells; ++cell)
      table.units[cell][k] = all[cell] == kInfinite ? Table::kNever
                             : largest == 0
                                 ? std::uint8_t(0)
                                 : std::uint8_t(std::ceil(all[cell] / double(table.unit[k])));
  }
  return table;
}

double angular_error_sine(const AngularErrorTable& table, const glm::dvec3& eye) {
  const int cell = eye_cell_of(eye);
  const double ahead = glm::dot(eye, eye_cell(cell).middle);
  return ahead > 0 ? sine_at(table, cell, 1 / ahead) : kInfinite;
}

double angular_error_sine_from(const AngularErrorTable& table, double distance) {
  double largest = 0;
  for (int cell = 0; cell < kEyeCells; ++cell) {
    // In the corners of a cell, eyes at this distance are nearest along its middle. Between nodes,
    // the bound times the nearness is convex.
    const double nearest = eye_cell(cell).farthest / distance;
    largest = std::max(largest, sine_at(table, cell, nearest));
    for (const double node : Table::kNearness)
      if (node < nearest) largest = std::max(largest, sine_at(table, cell, node));
  }
  return largest;
}

}  // namespace rilievo
