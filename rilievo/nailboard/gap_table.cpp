// In the capture's eye space with the ray (x, y, -1) and w = 1/eye_z, a surface point is (x, w): a
// camera at e = (a, -c), parallel to the capture, sees it at
//
//   s = (x - a w) / (1 - c w),   so that   x = s + w (a - c s)                               (1)
//
// and each of its lines of sight is straight in (x, w), along t(x) = a - c x. With n = t / |t| and
// m(w) = 1 / (1 - c w), two points A = (x_A, w_A) and H = (x_A - v n, w_H) of one such line's
// epipolar plane are seen apart by
//
//   (s_H - s_A).n = m(w_H) (|t(x_A)| m(w_A) (w_A - w_H) - v)                                 (2)
//
// A point H that the capture lacks lies behind the nearest surface on its own ray. Followed from H
// to e its line of sight must come out from behind it, at a ray x_e = x_H + v n where the nearest
// surface jumps from `front` to `beyond`, with the line between them. That edge is A: by (2) for H,
// whose w is not below that of the farthest surface of its ray, and by (2) for the line's own point
// there, the strip beside an edge is at most
//
//   min(P (front - beyond), P (front - far(x_e - v n)) - kappa v),  P >= m m |t|, kappa <= m  (3)
//
// maximised over v >= 0 and all edges. Between texels' centres lies a cell: front and beyond are
// the largest and the least of its four texels, far the least of those around. Steps of (0, 1) and
// (1, 1) cells stand for v; they are never taken for longer than they are:
//
//   N(c) = min(far(c), N(c - (0, 1)) + cos(pi/8) / T, N(c - (1, 1)) + (cos + sin)(pi/8) / T)
//   g(T) = max over cells of min(front - beyond, front - N),   gap <= P g(P / kappa)          (4)
//
// g grows with T: the next higher level of the table is safe. Lengths are in texels; the map to
// the frame's pixels stretches them by at most L, the largest derivative of its perspective.
#include "rilievo/nailboard/gap_table.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "rilievo/core/depth.h"
#include "rilievo/core/expects.h"
#include "rilievo/nailboard/gap_passes.h"
#include "rilievo/nailboard/picture_rays.h"

namespace rilievo {
namespace {

constexpr double kSteps = kGapSteps;

// Parallax of the level's entries: texels between the two ends of the depths.
constexpr double level_texels(int level) { return 0.5 * double(1 << level); }

// The most that a texel is stretched to, in pixels, over the frame's image of these rays between
// the depths `front` and `back`; infinite if any of it is behind the eye.
double largest_stretch(const RayPolygon& polygon, const ViewOfPicture& view,
                       const glm::dvec2& texel, double w_front, double w_back) {
  double norm = 0, least_weight = kInfinity;
  for (int i = 0; i < polygon.size; ++i) {
    const glm::dvec2 ray = polygon.corner[std::size_t(i)];
    for (double w : {w_front, w_back}) {
      const glm::dvec2 s = (ray - glm::dvec2(view.eye) * w) / (1 + view.eye.z * w);
      const glm::dvec3 q(s, -1);
      const double weight = glm::dot(view.f, q);
      if (!(weight > 0)) return kInfinity;
      least_weight = std::min(least_weight, weight);
      const double px = glm::dot(view.x, q) / weight, py = glm::dot(view.y, q) / weight;
      const glm::dvec2 a = (glm::dvec2(view.x) - px * glm::dvec2(view.f)) * texel;
      const glm::dvec2 b = (glm::dvec2(view.y) - py * glm::dvec2(view.f)) * texel;
      // The larger singular value of the matrix with rows a, b.
      const double sum = glm::dot(a, a) + glm::dot(b, b), det = a.x * b.y - a.y * b.x;
      norm = std::max(norm,
                      std::sqrt(0.5 * (sum + std::sqrt(std::max(0.0, sum * sum - 4 * det * det)))));
    }
  }
  return norm / least_weight;
}

// Octant bits of the direction at an angle, as GapTable has them.
int octant_of(double angle) {
  const double x = std::cos(angle), y = std::sin(angle);
  return (x < 0 ? 1 : 0) | (y < 0 ? 2 : 0) | (std::abs(x) > std::abs(y) ? 4 : 0);
}

}  // namespace

GapTable make_gap_table(const Image<float>& nearest, const Image<float>& farthest) {
  RILIEVO_EXPECTS(nearest.width() == farthest.width() && nearest.height() == farthest.height());
  const GapEnds ends = find_gap_ends(nearest, farthest);
  GapTable table;
  if (!(ends.least < kNoDepth) || !(ends.least > 0)) return table;
  table.w_front = 1.0 / ends.least, table.w_back = 1.0 / ends.most;
  const double range = table.w_front - table.w_back;
  if (!(range > 0)) return table;

  GapPlanes planes(nearest.width(), nearest.height());
  planes.encode(nearest, farthest, float(table.w_back), float(kSteps / range),
                float(kSteps * 1e-6 * table.w_front / range));

  GapStepCosts costs;
  for (int level = 0; level < kGapLevels; ++level) {
    const double straight = std::cos(std::numbers::pi / 8) * kSteps / level_texels(level);
    const double diagonal = straight * (1 + std::tan(std::numbers::pi / 8));
    costs.straight[std::size_t(level)] = std::uint8_t(std::min(255.0, straight));
    costs.diagonal[std::size_t(level)] = std::uint8_t(std::min(255.0, diagonal));
  }
  for (const bool transposed : {false, true}) {
    const GapPlanes& p = transposed ? planes.transposed() : planes;
    for (int mirror = 0; mirror < 4; ++mirror) {
      // In the transposed planes the octant's x is the picture's y.
      const bool minus_x = mirror & 1, minus_y = mirror & 2;
      const int octant = transposed ? (minus_y ? 1 : 0) | (minus_x ? 2 : 0) | 4 : mirror;
      table.code[std::size_t(octant)] = widest_strips(p, minus_x, minus_y, costs);
    }
    if (!transposed) planes.transpose();
  }
  return table;
}

GapTable unknown_gaps(const Camera& capture) {
  GapTable table;
  table.w_front = 1 / capture.z_near, table.w_back = 1 / capture.z_far;
  for (auto& octant : table.code) octant.fill(std::uint8_t(kGapSteps));
  return table;
}

double bound_gap_px(const PictureGeometry& picture, const GapTable& table, const Camera& frame,
                    const RigidMotion& motion) {
  if (!(table.w_front > table.w_back)) return 0;
  if (!is_rigid(motion.now_from_then)) return kInfinity;
  const ViewOfPicture view = view_of(frame, picture, motion);
  // Edges up to a frame's size outside the frame.
  Camera around = frame;
  const ImageWindow& f = frame.window;
  const double w = f.right - f.left, h = f.top - f.bottom;
  around.window = {f.left - w, f.right + w, f.bottom - h, f.top + h};
  around.width = 3 * frame.width, around.height = 3 * frame.height;
  const RayPolygon rays =
      rays_in_frame(picture, around, view, 1 / table.w_front, 1 / table.w_back, {0, 0});
  if (rays.size == 0) return 0;

  const double c = -view.eye.z;
  const double front = 1 - c * table.w_front, back = 1 - c * table.w_back;
  if (!(front > 0 && back > 0)) return kInfinity;
  const double most_m = 1 / std::min(front, back), least_m = 1 / std::max(front, back);

  const Camera& capture = picture.capture;
  const glm::dvec2 texel((capture.window.right - capture.window.left) / capture.width,
                         (capture.window.top - capture.window.bottom) / capture.height);
  double longest = 0, first = 0, lowest = 0, highest = 0;
  for (int i = 0; i < rays.size; ++i) {
    // In raster space, y down.
    const glm::dvec2 ray = rays.corner[std::size_t(i)];
    const glm::dvec2 t = (glm::dvec2(view.eye) - c * ray) / glm::dvec2(texel.x, -texel.y);
    longest = std::max(longest, glm::length(t));
    const double angle = std::atan2(t.y, t.x);
    if (i == 0) first = angle;
    const double turn = std::remainder(angle - first, 2 * std::numbers::pi);
    lowest = std::min(lowest, turn), highest = std::max(highest, turn);
  }
  if (longest == 0) return 0;
  const double stretch = largest_stretch(rays, view, texel, table.w_front, table.w_back);
  if (!(stretch < kInfinity)) return kInfinity;

  const double range = table.w_front - table.w_back;
  const double parallax = longest * most_m * most_m;       // texels per unit of w
  const double level_wanted = parallax / least_m * range;  // texels between the ends
  int level = 0;
  while (level < kGapLevels && level_texels(level) < level_wanted) ++level;
  if (level == kGapLevels) return stretch * parallax * range;

  // The directions of a convex polygon without the epipole span less than half a turn.
  int widest = 0;
  const double eighth = std::numbers::pi / 4;
  const bool all = highest - lowest >= std::numbers::pi * (1 - 1e-9);
  const int from = all ? 0 : int(std::floor((first + lowest) / eighth - 1e-9));
  const int to = all ? 7 : int(std::floor((first + highest) / eighth + 1e-9));
  for (int sector = from; sector <= to; ++sector) {
    const auto octant = std::size_t(octant_of((sector + 0.5) * eighth));
    widest = std::max(widest, int(table.code[octant][std::size_t(level)]));
  }
  return stretch * parallax * range * widest / kSteps;
}

}  // namespace rilievo
