#include "rilievo/representation/object_drawable.h"

#include <cmath>

namespace rilievo {
namespace {

// Does the motion scale alike in all directions, and not mirror?
bool is_uniform(const glm::dmat4& motion) {
  const glm::dmat3 m(motion);
  const glm::dmat3 square = glm::transpose(m) * m;
  const double scale2 = (square[0][0] + square[1][1] + square[2][2]) / 3;
  // Poses are floats: their rounding is no stretch.
  constexpr double kRounding = 1e-4;
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      if (!(std::abs(square[i][k] - (i == k ? scale2 : 0)) <= kRounding * scale2)) return false;
  return glm::determinant(m) > 0;
}

}  // namespace

std::optional<glm::dmat4> motion_of(const ObjectDrawable& drawable, const glm::mat4& pose) {
  const glm::dmat4 motion = glm::dmat4(pose) * drawable.object_from_capture;
  if (!is_uniform(motion)) return std::nullopt;
  return motion;
}

}  // namespace rilievo
