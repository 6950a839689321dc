// Steps are counted from all texels beside cut gates at once, nearest first, over the edges between
// faces too. The cosine follows from disparities: over a face a plane n.X = 1 has the disparity
// s = n.(a, b, 1) at (a, b, 1), so that s and its slopes give n.
#include "rilievo/environment_nodes/texel_weights.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

constexpr std::uint8_t kNotReached = 255;  // steps: not reached

struct FaceTexel {
  int face = 0;
  glm::ivec2 at{0};
};

// Sides as SideTexel has them.
FaceTexel beyond(const CubeGrid& grid, const FaceTexel& t, int side) {
  constexpr glm::ivec2 kSteps[] = {{0, -1}, {1, 0}, {0, 1}, {-1, 0}};
  const glm::ivec2 to = t.at + kSteps[side];
  const int n = grid.size();
  if (to.x >= 0 && to.y >= 0 && to.x < n && to.y < n) return {t.face, to};
  const SideTexel next = grid.across({t.face, side, side % 2 == 0 ? t.at.x : t.at.y});
  return {next.face, grid.side_texel(next.side, next.along)};
}

bool is_cut(const CubeGrid& grid, const FaceTexel& t, int side) {
  const int x = t.at.x, y = t.at.y, last = grid.size() - 1;
  switch (side) {
    case 0:
      return y > 0 ? grid.cut_below(t.face, x, y - 1) : grid.cut_border({t.face, side, x});
    case 1:
      return x < last ? grid.cut_right(t.face, x, y) : grid.cut_border({t.face, side, y});
    case 2:
      return y < last ? grid.cut_below(t.face, x, y) : grid.cut_border({t.face, side, x});
    default:
      return x > 0 ? grid.cut_right(t.face, x - 1, y) : grid.cut_border({t.face, side, y});
  }
}

std::array<Image<std::uint8_t>, 6> steps_from_silhouettes(const CubeGrid& grid) {
  const int n = grid.size();
  std::array<Image<std::uint8_t>, 6> steps;
  std::vector<FaceTexel> front, next;
  for (int f = 0; f < 6; ++f) {
    steps[std::size_t(f)] = Image<std::uint8_t>(n, n, kNotReached);
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const FaceTexel t{f, {x, y}};
        bool beside = grid.at(f, t.at) == kNothing;
        for (int side = 0; side < 4 && !beside; ++side) beside = is_cut(grid, t, side);
        if (!beside) continue;
        steps[std::size_t(f)](x, y) = 0;
        front.push_back(t);
      }
  }
  for (int step = 1; step < kFeather; ++step) {
    next.clear();
    for (const FaceTexel& t : front)
      for (int side = 0; side < 4; ++side) {
        const FaceTexel to = beyond(grid, t, side);
        std::uint8_t& there = steps[std::size_t(to.face)](to.at.x, to.at.y);
        if (there != kNotReached) continue;
        there = std::uint8_t(step);
        next.push_back(to);
      }
    front.swap(next);
  }
  return steps;
}

// How fast disparity changes per texel along an axis, within the surface.
double slope(const CubeGrid& grid, const FaceTexel& t, int before, int after) {
  const auto linked = [&](int side) {
    const FaceTexel to = beyond(grid, t, side);
    return to.face == t.face && !is_cut(grid, t, side);
  };
  const auto at = [&](int side) { return double(grid.at(t.face, beyond(grid, t, side).at)); };
  const double here = double(grid.at(t.face, t.at));
  const bool has_before = linked(before), has_after = linked(after);
  if (has_before && has_after) return 0.5 * (at(after) - at(before));
  if (has_after) return at(after) - here;
  return has_before ? here - at(before) : 0;
}

double facing(const CubeGrid& grid, const FaceTexel& t) {
  const double s = double(grid.at(t.face, t.at)), n = grid.size();
  if (s <= 0) return 1;  // the sky
  const glm::dvec3 sight((2 * t.at.x + 1) / n - 1, (2 * t.at.y + 1) / n - 1, 1);
  glm::dvec3 normal(0.5 * n * slope(grid, t, 3, 1), 0.5 * n * slope(grid, t, 0, 2), 0);
  normal.z = s - normal.x * sight.x - normal.y * sight.y;
  return s / (glm::length(normal) * glm::length(sight));
}

}  // namespace

std::array<Image<std::uint8_t>, 6> texel_weights(const CubeGrid& grid) {
  std::array<Image<std::uint8_t>, 6> weights = steps_from_silhouettes(grid);
  const int n = grid.size();
  parallel_for(0, 6, [&](int f) {
    Image<std::uint8_t>& face = weights[std::size_t(f)];
    for (int y = 0; y < n; ++y)
      for (int x = 0; x < n; ++x) {
        const double feather = std::min(double(face(x, y)) / kFeather, 1.0);
        face(x, y) = std::uint8_t(std::lround(255 * feather * facing(grid, {f, {x, y}})));
      }
  });
  return weights;
}

}  // namespace rilievo
