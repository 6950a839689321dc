// The distance of a point from a box.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/core/bounds.h"

namespace rilievo {

// From a point to the nearest of a box, which is not empty; 0 within it.
[[nodiscard]] inline double distance_to(const Box& box, const glm::dvec3& point) {
  return glm::distance(glm::clamp(point, glm::dvec3(box.min), glm::dvec3(box.max)), point);
}

}  // namespace rilievo
