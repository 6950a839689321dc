// The distance of a point from a triangle follows [Ericson 2005, Real-Time Collision Detection,
// 5.1.5].
//
// Let t be a triangle of the other surface and x a point of the piece with corners c1, c2, c3. The
// distance to t is a convex function, t being a convex set; so
//
//   d(x, other) <= d(x, t) <= max d(ci, t)          and   d(ci, other) <= the largest distance
//
// The first holds for each t, and is smallest for one near the piece. A piece is decided when its
// upper bound is hardly above the largest lower bound of all pieces, not of its own: few pieces are
// as far away as the farthest, and most are decided undivided. d(x, t) is at most d(c, other) + |x
// - c| if t is the nearest of c, so that bisecting ends.
#include "rilievo/scene/mesh_distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

constexpr std::size_t kLeafTriangles = 4;

glm::dvec3 nearest_point(const glm::dvec3& p, const glm::dvec3& a, const glm::dvec3& b,
                         const glm::dvec3& c) {
  const glm::dvec3 ab = b - a, ac = c - a, ap = p - a;
  const double d1 = glm::dot(ab, ap), d2 = glm::dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return a;
  const glm::dvec3 bp = p - b;
  const double d3 = glm::dot(ab, bp), d4 = glm::dot(ac, bp);
  if (d3 >= 0 && d4 <= d3) return b;
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0 && d1 > d3) return a + ab * (d1 / (d1 - d3));
  const glm::dvec3 cp = p - c;
  const double d5 = glm::dot(ab, cp), d6 = glm::dot(ac, cp);
  if (d6 >= 0 && d5 <= d6) return c;
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0 && d2 > d6) return a + ac * (d2 / (d2 - d6));
  const double va = d3 * d6 - d5 * d4, along = d4 - d3, back = d5 - d6;
  if (va <= 0 && along >= 0 && back >= 0 && along + back > 0)
    return b + (c - b) * (along / (along + back));
  const double sum = va + vb + vc;
  if (!(sum > 0)) return a;  // a triangle without area; a point of it all the same
  return a + (ab * vb + ac * vc) / sum;
}

double square(const glm::dvec3& v) { return glm::dot(v, v); }

// A triangle, or a part of one.
struct TrianglePart {
  std::array<glm::dvec3, 3> corner;
  std::array<std::uint32_t, 3> nearest;  // a triangle of the other surface, for each corner
  double upper = 0;                      // the square of its largest distance is at most this
};

void find_upper(const TriangleTree& other, TrianglePart& piece) {
  piece.upper = INFINITY;
  for (int i = 0; i < 3; ++i) {
    const std::uint32_t t = piece.nearest[std::size_t(i)];
    if ((i > 0 && t == piece.nearest[0]) || (i > 1 && t == piece.nearest[1])) continue;
    double largest = 0;
    for (const glm::dvec3& corner : piece.corner)
      largest = std::max(largest, other.square_distance(corner, t));
    piece.upper = std::min(piece.upper, largest);
  }
}

}  // namespace

TriangleTree::TriangleTree(std::span<const glm::vec3> positions,
                           std::span<const std::uint32_t> indices) {
  RILIEVO_EXPECTS(indices.size() >= 3 && indices.size() % 3 == 0);
  std::vector<glm::vec3> centers;
  for (std::size_t t = 0; t < indices.size(); t += 3) {
    given_.push_back({positions[indices[t]], positions[indices[t + 1]], positions[indices[t + 2]]});
    centers.push_back((given_.back()[0] + given_.back()[1] + given_.back()[2]) / 3.0f);
  }
  std::vector<std::uint32_t> order(given_.size());
  std::iota(order.begin(), order.end(), 0u);
  corners_.reserve(given_.size());
  build(order, centers);
  given_ = {};
}

std::uint32_t TriangleTree::build(std::span<std::uint32_t> order,
                                  std::span<const glm::vec3> centers) {
  const auto at = std::uint32_t(nodes_.size());
  Node node{glm::vec3(INFINITY), glm::vec3(-INFINITY)};
  glm::vec3 low(INFINITY), high(-INFINITY);  // of the centres
  for (const std::uint32_t t : order) {
    for (const glm::vec3& corner : given_[t])
      node.min = glm::min(node.min, corner), node.max = glm::max(node.max, corner);
    low = glm::min(low, centers[t]), high = glm::max(high, centers[t]);
  }
  nodes_.push_back(node);
  if (order.size() <= kLeafTriangles) {
    nodes_[at].first = std::uint32_t(corners_.size()),
    nodes_[at].count = std::uint32_t(order.size());
    for (const std::uint32_t t : order) corners_.push_back(given_[t]);
    return at;
  }
  const glm::vec3 extent = high - low;
  const int axis = extent.x >= extent.y && extent.x >= extent.z ? 0 : extent.y >= extent.z ? 1 : 2;
  const std::size_t half = order.size() / 2;
  std::nth_element(order.begin(), order.begin() + std::ptrdiff_t(half), order.end(),
                   [&](std::uint32_t a, std::uint32_t b) {
                     const float x = centers[a][axis], y = centers[b][axis];
                     return x != y ? x < y : a < b;
                   });
  build(order.first(half), centers);
  const std::uint32_t second = build(order.subspan(half), centers);
  nodes_[at].first = second;
  return at;
}

double TriangleTree::square_distance(const glm::dvec3& p, std::uint32_t triangle) const {
  const std::array<glm::vec3, 3>& c = corners_[triangle];
  return square(nearest_point(p, glm::dvec3(c[0]), glm::dvec3(c[1]), glm::dvec3(c[2])) - p);
}

TriangleTree::Nearest TriangleTree::nearest(const glm::dvec3& p, std::uint32_t first) const {
  Nearest best{first, square_distance(p, first)};
  const auto away = [&](std::uint32_t node) {
    return square(glm::clamp(p, glm::dvec3(nodes_[node].min), glm::dvec3(nodes_[node].max)) - p);
  };
  // Halves of halves: no deeper than the bits of a number of triangles.
  struct Entry {
    std::uint32_t node;
    double square;
  };
  std::array<Entry, 64> stack;
  std::size_t count = 0;
  stack[count++] = {0, away(0)};
  while (count > 0) {
    const Entry entry = stack[--count];
    if (entry.square >= best.square) continue;
    const Node& node = nodes_[entry.node];
    for (std::uint32_t t = node.first; t < node.first + node.count; ++t)
      if (const double d = square_distance(p, t); d < best.square) best = {t, d};
    if (node.count > 0) continue;
    Entry near{entry.node + 1, away(entry.node + 1)}, far{node.first, away(node.first)};
    if (far.square < near.square) std::swap(near, far);
    stack[count++] = far;
    stack[count++] = near;
  }
  return best;
}

DistanceBounds farthest_from(const TriangleTree& other, std::span<const glm::vec3> positions,
                             std::span<const std::uint32_t> indices, std::size_t other_triangles,
                             const DistanceOptions& options) {
  constexpr std::uint32_t kUnknown = 0xFFFFFFFFu;
  std::vector<std::uint32_t> nearest(positions.size(), kUnknown);
  double lower = 0;  // these are squares until the end
  std::uint32_t last = 0;
  for (const std::uint32_t vertex : indices) {
    if (nearest[vertex] != kUnknown) continue;
    const TriangleTree::Nearest found = other.nearest(glm::dvec3(positions[vertex]), last);
    nearest[vertex] = last = found.triangle;
    lower = std::max(lower, found.square);
  }
  const auto decided = [&] {
    const double distance = std::sqrt(lower);
    const double above = distance + std::max(options.share * distance, options.slack);
    return above * above;
  };
  double upper = lower;
  std::vector<TrianglePart> pending, next;
  for (std::size_t t = 0; t + 2 < indices.size(); t += 3) {
    TrianglePart piece;
    for (std::size_t k = 0; k < 3; ++k) {
      piece.corner[k] = glm::dvec3(positions[indices[t + k]]);
      piece.nearest[k] = nearest[indices[t + k]];
    }
    find_upper(other, piece);
    if (piece.upper > decided())
      pending.push_back(piece);
    else
      upper = std::max(upper, piece.upper);
  }
  double work = options.work * double(indices.size() / 3 + other_triangles);
  while (!pending.empty() && work > 0 && lower <= options.too_far * options.too_far) {
    // The farther half of the distances first: if work ends, what is left is not much too large.
    double most = 0;
    for (const TrianglePart& piece : pending) most = std::max(most, piece.upper);
    const double from = std::max(decided(), most / 4);
    next.clear();
    for (const TrianglePart& piece : pending) {
      if (piece.upper <= from || work <= 0) {
        if (piece.upper > decided())
          next.push_back(piece);
        else
          upper = std::max(upper, piece.upper);
        continue;
      }
      --work;
      // At the middle of the longest edge, from corner k.
      std::size_t k = 0;
      double longest = -1;
      for (std::size_t i = 0; i < 3; ++i)
        if (const double d = square(piece.corner[(i + 1) % 3] - piece.corner[i]); d > longest)
          longest = d, k = i;
      const std::size_t l = (k + 1) % 3;
      const glm::dvec3 middle = 0.5 * (piece.corner[k] + piece.corner[l]);
      const TriangleTree::Nearest found = other.nearest(middle, piece.nearest[k]);
      lower = std::max(lower, found.square);
      for (const std::size_t replaced : {k, l}) {
        TrianglePart half = piece;
        half.corner[replaced] = middle;
        half.nearest[replaced] = found.triangle;
        find_upper(other, half);
        half.upper = std::min(half.upper, piece.upper);
        if (half.upper > decided())
          next.push_back(half);
        else
          upper = std::max(upper, half.upper);
      }
    }
    pending.swap(next);
  }
  for (const TrianglePart& piece : pending) upper = std::max(upper, piece.upper);
  return {std::sqrt(lower), std::sqrt(std::max(lower, upper))};
}

}  // namespace rilievo
