// Which views are drawn changes with the direction to the eye, and so does from which triangle
// holes are filled. A cell is divided into small parts. What is within an angle of some direction
// of a part is within that angle, and the way there and back, of the part's middle.

#include "rilievo/layered_impostor/eye_cells.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <span>

namespace rilievo {
namespace {

constexpr double kCellAngle = std::numbers::pi / 2 / kEyeCellsASide;
constexpr int kParts = 8;  // of a cell, a side

// A point of a face of the cube, at angles from its middle.
glm::dvec3 on_face(int face, double a, double b) {
  glm::dvec3 p;
  p[face / 2] = face % 2 ? -1 : 1;
  p[(face / 2 + 1) % 3] = std::tan(a);
  p[(face / 2 + 2) % 3] = std::tan(b);
  return p;
}

// A point of a cell, (x, y) in [0, 1]^2.
glm::dvec3 in_cell(int cell, double x, double y) {
  constexpr int kSide = kEyeCellsASide;
  const int face = cell / (kSide * kSide), i = cell / kSide % kSide, j = cell % kSide;
  return on_face(face, (i + x) * kCellAngle - std::numbers::pi / 4,
                 (j + y) * kCellAngle - std::numbers::pi / 4);
}

// Is a direction among the corners' where the product with `normal` is not negative?
bool some_ahead(std::span<const glm::dvec3> corners, const glm::dvec3& normal) {
  return std::any_of(corners.begin(), corners.end(),
                     [&](const glm::dvec3& c) { return glm::dot(c, normal) >= -1e-9; });
}

// The views whose slices fill holes of `view` for a direction among the corners': those of the
// triangle at the view that holds it (pick_views_around), or any neighbours', if none may.
void add_fillers(const ViewSet& set, int view, std::span<const glm::dvec3> corners,
                 std::vector<bool>& drawn) {
  std::vector<std::array<int, 3>> at_view;  // the view first, counter-clockwise
  for (std::array<int, 3> t : set.triangles) {
    const auto found = std::find(t.begin(), t.end(), view);
    if (found == t.end()) continue;
    std::rotate(t.begin(), found, t.end());
    at_view.push_back(t);
  }
  const auto normal = [&](int a, int b) {
    return glm::cross(set.directions[std::size_t(a)], set.directions[std::size_t(b)]);
  };
  std::vector<int> neighbors;
  for (const auto& edge : set.edges)
    for (int side = 0; side < 2; ++side)
      if (edge[std::size_t(side)] == view) neighbors.push_back(edge[std::size_t(1 - side)]);
  // All around the view, and no corner beyond any triangle's far side.
  bool held = at_view.size() == neighbors.size();
  for (const auto& [v, a, b] : at_view) held = held && !some_ahead(corners, -normal(a, b));
  for (const auto& [v, a, b] : at_view) {
    if (held && !(some_ahead(corners, normal(v, a)) && some_ahead(corners, normal(b, v)))) continue;
    drawn[std::size_t(a)] = drawn[std::size_t(b)] = true;
  }
  if (held) return;
  for (const int neighbor : neighbors) drawn[std::size_t(neighbor)] = true;
}

EyeCell make_cell(int index) {
  EyeCell cell;
  glm::dvec3 sum(0.0);
  for (int k = 0; k < 4; ++k) {
    cell.corners[std::size_t(k)] = in_cell(index, k & 1, k >> 1);
    sum += glm::normalize(cell.corners[std::size_t(k)]);
  }
  cell.middle = glm::normalize(sum);
  for (glm::dvec3& corner : cell.corners) {
    corner /= glm::dot(corner, cell.middle);
    cell.farthest = std::max(cell.farthest, glm::length(corner));
  }
  return cell;
}

}  // namespace

const EyeCell& eye_cell(int cell) {
  static const std::array<EyeCell, kEyeCells> kCells = [] {
    std::array<EyeCell, kEyeCells> cells;
    for (int i = 0; i < kEyeCells; ++i) cells[std::size_t(i)] = make_cell(i);
    return cells;
  }();
  return kCells[std::size_t(cell)];
}

int eye_cell_of(const glm::dvec3& direction) {
  const glm::dvec3 size = glm::abs(direction);
  const int axis = size.x >= size.y && size.x >= size.z ? 0 : size.y >= size.z ? 1 : 2;
  const auto place = [&](int k) {
    const double angle = std::atan(direction[k] / size[axis]) + std::numbers::pi / 4;
    return std::clamp(int(angle / kCellAngle), 0, kEyeCellsASide - 1);
  };
  const int face = 2 * axis + (direction[axis] < 0);
  return (face * kEyeCellsASide + place((axis + 1) % 3)) * kEyeCellsASide + place((axis + 2) % 3);
}

std::vector<bool> views_drawn_from(const LayeredImpostor& impostor, const LayeredOptions& options,
                                   int cell) {
  // From a part's middle to its corner, half a part along either side: on a cube's face a step of
  // an angle is a turn of at most that. There and back.
  constexpr double kSlack = 2 * kCellAngle / kParts;
  const ViewSet& set = impostor.views;
  const bool sliced = options.method == LayeredMethod::slices;
  const double zone = options.handover * mean_spacing(set);
  const auto count = std::size_t(views_at_hand(set.directions.size(), options.max_views));
  std::vector<bool> drawn(set.directions.size());
  std::vector<double> angles(set.directions.size()), sorted;
  for (int part = 0; part < kParts * kParts; ++part) {
    const auto at = [&](double x, double y) {
      return glm::normalize(
          in_cell(cell, (part % kParts + x) / kParts, (part / kParts + y) / kParts));
    };
    const glm::dvec3 middle = at(0.5, 0.5);
    const std::array<glm::dvec3, 4> corners{at(0, 0), at(1, 0), at(0, 1), at(1, 1)};
    for (std::size_t v = 0; v < angles.size(); ++v)
      angles[v] = std::acos(std::clamp(glm::dot(set.directions[v], middle), -1.0, 1.0));
    // The nearest ones; of slices, those that share the pixels.
    sorted = angles;
    std::nth_element(sorted.begin(), sorted.begin() + std::ptrdiff_t(count - 1), sorted.end());
    double within = sorted[count - 1];
    if (sliced) within = std::min(within, *std::min_element(angles.begin(), angles.end()) + zone);
    for (std::size_t v = 0; v < angles.size(); ++v) {
      if (angles[v] > within + kSlack) continue;
      drawn[v] = true;
      if (sliced && options.max_views > 1) add_fillers(set, int(v), corners, drawn);
    }
  }
  return drawn;
}

}  // namespace rilievo
