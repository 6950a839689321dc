#include "rilievo/capture/shaders/distance_field.h"

#include <algorithm>
#include <array>
#include <cmath>

namespace rilievo {
namespace {

double torus(const glm::dvec3& p) {
  const double ring = std::hypot(p.x, p.z) - 0.7;
  return std::hypot(ring, p.y) - 0.28;
}

// sin x cos y + sin y cos z + sin z cos x = 0. Each partial derivative, as in cos x cos y - sin z
// sin x, is a dot product of a unit vector and one of length sqrt(2) at most, so that the gradient
// is sqrt(6) at most.
double gyroid(const glm::dvec3& p) {
  constexpr double kWaves = 7, kThickness = 0.02;
  const glm::dvec3 s = glm::sin(kWaves * p), c = glm::cos(kWaves * p);
  const double value = s.x * c.y + s.y * c.z + s.z * c.x;
  const double shell = std::abs(value) / (kWaves * std::sqrt(6.0)) - kThickness;
  return std::max(shell, glm::length(p) - 1);
}

// A cube without crosses of square bars, the largest a third as wide as the cube, the next ones a
// third of that in each of the 27 cells, and so on. In a cell [-1, 1]^3 a bar along z is max(|x|,
// |y|) < 1/3. The bars of neighbouring cells meet, so that the distance to those of the own cell
// is continuous.
double menger(const glm::dvec3& p) {
  const glm::dvec3 q = glm::abs(p) - 0.8;
  double d = std::max({q.x, q.y, q.z});
  double cells = 1;
  for (int level = 0; level < 4; ++level, cells *= 3) {
    const glm::dvec3 cell = cells / 0.8 * p;
    // To [-1, 1], mirrored from cell to cell.
    const glm::dvec3 a = glm::abs(cell - 2.0 * glm::floor(0.5 * cell + 0.5));
    const double bar = std::min({std::max(a.x, a.y), std::max(a.y, a.z), std::max(a.z, a.x)});
    d = std::max(d, (1.0 / 3 - bar) * 0.8 / cells);
  }
  return d;
}

const std::array<DistanceField, 3> kFields = {{
    {"torus", torus, {{-0.98f, -0.28f, -0.98f}, {0.98f, 0.28f, 0.98f}}},
    {"gyroid", gyroid, {glm::vec3(-1), glm::vec3(1)}},
    {"menger", menger, {glm::vec3(-0.8f), glm::vec3(0.8f)}},
}};

// A ray that grazes a surface comes closer in ever smaller steps.
constexpr int kMaxFieldSteps = 20000;

}  // namespace

std::span<const DistanceField> distance_fields() { return kFields; }

const DistanceField* find_distance_field(std::string_view name) {
  for (const DistanceField& field : kFields)
    if (field.name == name) return &field;
  return nullptr;
}

glm::dvec3 distance_normal(const DistanceField& field, const glm::dvec3& at, double step) {
  glm::dvec3 n;
  for (int axis = 0; axis < 3; ++axis) {
    glm::dvec3 to(0.0);
    to[axis] = step;
    n[axis] = field.distance(at + to) - field.distance(at - to);
  }
  const double length = glm::length(n);
  return length > 0 ? n / length : glm::dvec3(0, 1, 0);
}

double trace_field(const DistanceField& field, const glm::dvec3& origin,
                   const glm::dvec3& direction, double length, double precision) {
  // Between the first and the last of the bounds' planes.
  double from = 0, to = length;
  for (int axis = 0; axis < 3; ++axis) {
    const double per = 1 / direction[axis];
    double a = (double(field.bounds.min[axis]) - 1e-4 - origin[axis]) * per;
    double b = (double(field.bounds.max[axis]) + 1e-4 - origin[axis]) * per;
    if (a > b) std::swap(a, b);
    // A ray along the planes gives infinities, which decide nothing or everything.
    if (!std::isnan(a)) from = std::max(from, a);
    if (!std::isnan(b)) to = std::min(to, b);
  }
  for (int i = 0; i < kMaxFieldSteps && from <= to; ++i) {
    const double d = field.distance(origin + from * direction);
    if (d <= precision) return from;
    from += d;
  }
  return -1;
}

}  // namespace rilievo
