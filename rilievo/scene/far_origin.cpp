#include "rilievo/scene/far_origin.h"

#include <algorithm>
#include <cmath>

namespace rilievo {
namespace {

double largest(const glm::dvec3& v) {
  return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)});
}

// The median of each coordinate.
glm::dvec3 median(std::vector<glm::dvec3>& points) {
  glm::dvec3 out;
  const auto middle = points.begin() + std::ptrdiff_t(points.size() / 2);
  for (int axis = 0; axis < 3; ++axis) {
    std::nth_element(points.begin(), middle, points.end(),
                     [axis](const auto& a, const auto& b) { return a[axis] < b[axis]; });
    out[axis] = (*middle)[axis];
  }
  return out;
}

}  // namespace

glm::dvec3 far_origin(std::vector<glm::dvec3> points) {
  if (points.empty()) return glm::dvec3(0);
  glm::dvec3 low = points.front(), high = low;
  for (const glm::dvec3& p : points) low = glm::min(low, p), high = glm::max(high, p);
  const glm::dvec3 middle = median(points);
  for (glm::dvec3& p : points) p = glm::abs(p - middle);
  // Medians, so that a few points elsewhere, such as a mark at 0, do not count.
  const double spread = largest(median(points));
  const bool all_far = largest(0.5 * (low + high)) > 16 * 0.5 * glm::distance(low, high);
  if (!all_far && largest(middle) <= 256 * spread) return glm::dvec3(0);
  // Of a single point the place itself decides.
  const double step = std::exp2(std::round(std::log2(std::max(spread, 1e-9 * largest(middle)))));
  return glm::round(middle / step) * step;
}

}  // namespace rilievo
