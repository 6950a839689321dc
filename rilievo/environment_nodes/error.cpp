// Two points on a line of sight of the node, at distances s = 1 / r from it, seen from an eye at b.
// With h the eye's distance from the line and k = b . u the foot of its perpendicular (u: the
// line's unit direction), a point is seen at the angle atan((s - k) / h), so that
//
//   d angle / ds = h / (h^2 + (s - k)^2),   d angle / dr = h / (|b|^2 r^2 - 2 k r + 1)
//
// since h^2 + k^2 = |b|^2. The angle between two points is at most their difference in r times the
// largest value of that between them: h at most |b| sin over the block's cone, k at most |b| cos,
// and the denominator least at r = k / |b|^2.
#include "rilievo/environment_nodes/error.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "rilievo/core/parallel_for.h"
#include "rilievo/environment_nodes/cube_grid.h"

namespace rilievo {
namespace {

using Block = NodeErrorModel::Block;

// Raster position on a face, texels.
glm::dvec2 raster_of(const FaceAxes& axes, const glm::vec3& direction, int n) {
  const double depth = glm::dot(glm::dvec3(direction), glm::dvec3(axes.forward));
  return 0.5 * n *
         glm::dvec2(1 + glm::dot(glm::dvec3(direction), glm::dvec3(axes.right)) / depth,
                    1 - glm::dot(glm::dvec3(direction), glm::dvec3(axes.up)) / depth);
}

double steepest(double b, double least_angle, double most_angle, double least, double most) {
  const double h = b * std::sin(std::min(most_angle, std::numbers::pi / 2));
  const double k = b * std::cos(least_angle);
  const double at = b > 0 ? std::clamp(k / (b * b), least, most) : least;
  const double below = b * b * at * at - 2 * k * at + 1;
  return below > 1e-9 ? h / below : std::numeric_limits<double>::infinity();
}

// Adds the points and lines of a block. A place at distance 1 / r from the node and at the angle a
// from the eye's direction is sqrt(1 - 2 b r cos a + (b r)^2) / r from the eye, which is `nearer`
// times as far.
void add_strokes(const NodeErrorModel& model, const Block& block, double b, double least_angle,
                 NodeBound& widest) {
  constexpr double kPi = std::numbers::pi;
  const double c = std::cos(least_angle);
  const double at = std::clamp(c, b * double(block.least), b * double(block.most));
  const double nearer = std::sqrt(std::max(0.0, 1 - 2 * at * c + at * at));
  const double shift = disc_shift(model.strokes.disc_radius, b * double(block.most), 1) *
                       double(block.most) / nearer;
  if (model.strokes.disc_radius > 0)
    widest.disc = std::max(widest.disc, shift < 1 ? std::asin(shift) : kPi);
  if (model.strokes.texels > 0)
    widest.half_texel = std::max(widest.half_texel, std::min(kPi, model.half_texel / nearer));
}

// A straight line along which surfaces end: along it, all of them lie between disparities that are
// linear from end to end.
struct Seam {
  std::array<glm::dvec3, 2> end;  // directions
  std::array<double, 2> low, high;
};

// A skin's corners lie at the two ends of its line, and its two triangles, which follow each other,
// together span what opens. A sliver's third corner lies within a texel or so of its longest side,
// and counts as if it lay on it.
std::vector<Seam> seams_of(const NodeMesh& mesh, const TriangleRange& skins) {
  std::vector<Seam> seams;
  const auto add = [&](const Seam& seam) {
    if (!seams.empty()) {
      Seam& last = seams.back();
      for (const std::size_t first : {0u, 1u})
        if (last.end[0] == seam.end[first] && last.end[1] == seam.end[1 - first]) {
          for (const std::size_t k : {0u, 1u}) {
            const std::size_t other = first == 0 ? k : 1 - k;
            last.low[k] = std::min(last.low[k], seam.low[other]);
            last.high[k] = std::max(last.high[k], seam.high[other]);
          }
          return;
        }
    }
    seams.push_back(seam);
  };
  for (std::size_t t = skins.first; t < std::size_t(skins.first) + skins.count; ++t) {
    std::array<glm::dvec3, 3> c;
    std::array<double, 3> d;
    for (std::size_t k = 0; k < 3; ++k) {
      const NodeVertex& v = mesh.vertices[mesh.indices[3 * t + k]];
      c[k] = glm::dvec3(v.direction), d[k] = double(v.disparity);
    }
    if (c[0] == c[1] && c[1] == c[2]) {
      const auto [low, high] = std::minmax({d[0], d[1], d[2]});
      add({{c[0], c[0]}, {low, low}, {high, high}});
      continue;
    }
    std::size_t a = 0;  // the longest side begins here
    for (const std::size_t k : {1u, 2u})
      if (glm::distance(c[k], c[(k + 1) % 3]) > glm::distance(c[a], c[(a + 1) % 3])) a = k;
    const std::size_t b = (a + 1) % 3, m = (a + 2) % 3;
    const glm::dvec3 side = c[b] - c[a];
    const double there = glm::dot(c[m] - c[a], side) / glm::dot(side, side);
    const auto [low, high] = std::minmax({d[m], glm::mix(d[a], d[b], std::clamp(there, 0.0, 1.0))});
    for (const std::size_t e : {a, b})
      if (c[e] != c[m]) add({{c[e], c[m]}, {d[e], low}, {d[e], high}});
  }
  return seams;
}

int blocks_a_side(int n) { return (n + NodeErrorModel::kBlock - 1) / NodeErrorModel::kBlock; }

// A seam counts for all blocks that it passes through, cut where it leaves one for the next. Of a
// piece the ends tell all: low, high and their difference are linear, the length of the direction
// is convex, and 1 / distance is disparity through that length.
void add_seam(const Seam& seam, int n, std::array<std::vector<Block>, 6>& of_face) {
  constexpr int kBlock = NodeErrorModel::kBlock;
  std::size_t f = 0;  // a face on which it lies
  const auto outside = [&](const glm::dvec3& c) {
    return glm::dot(c, glm::dvec3(face_axes()[f].forward)) < 1 - 1e-6;
  };
  while (f < 5 && (outside(seam.end[0]) || outside(seam.end[1]))) ++f;
  const glm::dvec2 from = raster_of(face_axes()[f], glm::vec3(seam.end[0]), n),
                   step = raster_of(face_axes()[f], glm::vec3(seam.end[1]), n) - from;
  std::vector<double> cuts{0, 1};
  for (const int axis : {0, 1})
    for (int line = kBlock; line < n; line += kBlock)
      if (const double t = (line - from[axis]) / step[axis]; t > 0 && t < 1) cuts.push_back(t);
  std::sort(cuts.begin(), cuts.end());
  const glm::dvec3 along = seam.end[1] - seam.end[0];
  for (std::size_t i = 1; i < cuts.size(); ++i) {
    const double t[2] = {cuts[i - 1], cuts[i]};
    double low[2], high[2], length[2];
    for (const int k : {0, 1}) {
      low[k] = glm::mix(seam.low[0], seam.low[1], t[k]);
      high[k] = glm::mix(seam.high[0], seam.high[1], t[k]);
      length[k] = glm::length(seam.end[0] + t[k] * along);
    }
    const double foot = -glm::dot(seam.end[0], along) / std::max(glm::dot(along, along), 1e-30);
    const double nearest = glm::length(seam.end[0] + std::clamp(foot, t[0], t[1]) * along);
    const glm::dvec2 middle = from + 0.5 * (t[0] + t[1]) * step;
    const auto place = [&](double at) {
      return std::size_t(std::clamp(int(at) / kBlock, 0, blocks_a_side(n) - 1));
    };
    Block& block = of_face[f][place(middle.y) * std::size_t(blocks_a_side(n)) + place(middle.x)];
    const auto least = float(std::min(low[0], low[1]) / std::max(length[0], length[1]));
    block.skin_least = block.gap > 0 ? std::min(block.skin_least, least) : least;
    block.skin_most = std::max(block.skin_most, float(std::max(high[0], high[1]) / nearest));
    block.gap = std::max(block.gap, float(std::max(high[0] - low[0], high[1] - low[1]) / nearest));
  }
}

}  // namespace

Image<float> seen_disparity(const NodeMesh& mesh, int face) {
  const int n = mesh.face_size;
  const FaceAxes& axes = face_axes()[std::size_t(face)];
  Image<float> seen(n, n, kNothing);
  const TriangleRange range = mesh.surfaces[std::size_t(face)];
  for (std::size_t t = range.first; t < std::size_t(range.first) + range.count; ++t) {
    glm::dvec2 p[3];
    double d[3];
    for (std::size_t k = 0; k < 3; ++k) {
      const NodeVertex& v = mesh.vertices[mesh.indices[3 * t + k]];
      p[k] = raster_of(axes, v.direction, n);
      d[k] = v.disparity;
    }
    const glm::dvec2 u = p[1] - p[0], v = p[2] - p[0];
    const double area = u.x * v.y - u.y * v.x;
    if (area == 0) continue;
    const double gx = ((d[1] - d[0]) * v.y - (d[2] - d[0]) * u.y) / area;
    const double gy = ((d[2] - d[0]) * u.x - (d[1] - d[0]) * v.x) / area;
    const auto [low, high] = std::minmax({p[0].y, p[1].y, p[2].y});
    for (int y = std::max(0, int(std::ceil(low - 0.5 - 1e-9)));
         y <= std::min(n - 1, int(std::floor(high - 0.5 + 1e-9))); ++y) {
      double from = 0, to = n;
      for (int k = 0; k < 3; ++k) {
        const glm::dvec2 a = p[k], e = (p[(k + 1) % 3] - a) * (area < 0 ? -1.0 : 1.0);
        // e.x (Y - a.y) - e.y (X - a.x) >= 0; on the edge is inside.
        const double c = e.x * (y + 0.5 - a.y) + e.y * a.x;
        if (e.y < 0) from = std::max(from, c / e.y - 1e-7);
        if (e.y > 0) to = std::min(to, c / e.y + 1e-7);
      }
      for (int x = std::max(0, int(std::ceil(from - 0.5)));
           x <= std::min(n - 1, int(std::floor(to - 0.5))); ++x) {
        const float here = float(d[0] + gx * (x + 0.5 - p[0].x) + gy * (y + 0.5 - p[0].y));
        seen(x, y) = std::max(seen(x, y), here);
      }
    }
  }
  return seen;
}

NodeErrorModel make_error_model(const EnvironmentMap& map, const NodeMesh& mesh,
                                const StrokeSize& strokes) {
  const CubeGrid grid(map, {});
  const int n = grid.size(), across = blocks_a_side(n);
  std::array<std::vector<Block>, 6> of_face;
  parallel_for(0, 6, [&](int f) {
    const FaceAxes& axes = face_axes()[std::size_t(f)];
    const Image<float> seen = seen_disparity(mesh, f);
    std::vector<Block>& blocks = of_face[std::size_t(f)];
    blocks.resize(std::size_t(across) * std::size_t(across));
    const auto direction = [&](double x, double y) {
      return glm::dvec3(axes.forward) + (2 * x / n - 1) * glm::dvec3(axes.right) +
             (1 - 2 * y / n) * glm::dvec3(axes.up);
    };
    for (int j = 0; j < across; ++j)
      for (int i = 0; i < across; ++i) {
        Block& block = blocks[std::size_t(j) * std::size_t(across) + std::size_t(i)];
        const int x0 = i * NodeErrorModel::kBlock, x1 = std::min(n, x0 + NodeErrorModel::kBlock);
        const int y0 = j * NodeErrorModel::kBlock, y1 = std::min(n, y0 + NodeErrorModel::kBlock);
        const glm::dvec3 middle = glm::normalize(direction(0.5 * (x0 + x1), 0.5 * (y0 + y1)));
        block.toward = glm::vec3(middle);
        for (const int x : {x0, x1})
          for (const int y : {y0, y1})
            block.half_angle =
                std::max(block.half_angle,
                         float(std::acos(std::clamp(
                                   glm::dot(middle, glm::normalize(direction(x, y))), -1.0, 1.0)) +
                               1e-6));
        bool any = false;
        for (int y = y0; y < y1; ++y)
          for (int x = x0; x < x1; ++x) {
            const float sample = grid.at(f, {x, y}), drawn = seen(x, y);
            if (sample < 0 || drawn < 0) continue;
            const float per = float(1 / glm::length(direction(x + 0.5, y + 0.5)));
            const float low = per * std::min(sample, drawn), high = per * std::max(sample, drawn);
            block.least = any ? std::min(block.least, low) : low;
            block.most = std::max(block.most, high);
            block.error = std::max(block.error, high - low);
            any = true;
          }
      }
  });
  for (const TriangleRange& skins : mesh.skins)
    for (const Seam& seam : seams_of(mesh, skins)) add_seam(seam, n, of_face);
  NodeErrorModel model;
  model.world_from_node = mesh.world_from_node;
  model.strokes = strokes;
  model.half_texel = std::sqrt(2.0) / n;  // in the middle of a face, where texels look largest
  for (const std::vector<Block>& blocks : of_face)
    for (const Block& block : blocks)
      if (block.error > 0 || block.gap > 0 || (strokes.any() && block.most > 0))
        model.blocks.push_back(block);
  return model;
}

NodeBound bound(const NodeErrorModel& model, const glm::dvec3& eye) {
  const glm::dvec3 offset = glm::transpose(glm::dmat3(model.world_from_node)) *
                            (eye - glm::dvec3(model.world_from_node[3]));
  const double b = glm::length(offset);
  NodeBound widest;
  if (b == 0 && !model.strokes.any()) return widest;
  const glm::dvec3 away = b == 0 ? glm::dvec3(0, 0, 1) : offset / b;
  constexpr double kPi = std::numbers::pi;
  for (const Block& block : model.blocks) {
    const double angle = std::acos(std::clamp(glm::dot(away, glm::dvec3(block.toward)), -1.0, 1.0));
    const double low = std::max(0.0, angle - block.half_angle);
    const double high = std::min(kPi, angle + block.half_angle);
    // sin is largest at a right angle.
    const double widest_angle =
        low <= kPi / 2 && high >= kPi / 2 ? kPi / 2 : (high < kPi / 2 ? high : kPi - low);
    const auto angle_of = [&](double span, double least, double most) {
      if (span <= 0) return 0.0;
      return std::min(kPi, span * steepest(b, low, widest_angle, least, most));
    };
    widest.error = std::max(widest.error, angle_of(block.error, block.least, block.most));
    widest.gap = std::max(widest.gap, angle_of(block.gap, block.skin_least, block.skin_most));
    if (model.strokes.any()) add_strokes(model, block, b, low, widest);
  }
  return widest;
}

// An angle a at the direction with tangent t from the axis moves a point by at most (1 + t^2) tan a
// in the image plane of depth 1, as long as both its ends are in the frame.
NodeBound bound_px(const NodeErrorModel& model, const Camera& frame) {
  NodeBound angles = bound(model, frame.position());
  const ImageWindow& w = frame.window;
  const double x = std::max(std::abs(w.left), std::abs(w.right));
  const double y = std::max(std::abs(w.top), std::abs(w.bottom));
  const double scale =
      std::max(frame.width / (w.right - w.left), frame.height / (w.top - w.bottom)) *
      (1 + x * x + y * y);
  return {angles.error * scale, angles.gap * scale, angles.disc * scale, angles.half_texel * scale};
}

}  // namespace rilievo
