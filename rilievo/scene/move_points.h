// Moves the points of a curve of translations. Internal to scenes.
#pragma once

#include "rilievo/scene/scene.h"

namespace rilievo {

// Adds `by` to every point of the curve; tangents of cubic splines stay. Requires a curve of
// translations.
inline void move_points(Channel& channel, const glm::dvec3& by) {
  // Of a cubic spline every second of three values is a point.
  const bool cubic = channel.interpolation == Channel::Interpolation::cubic_spline;
  for (std::size_t i = cubic ? 1 : 0; i < channel.values.size(); i += cubic ? 3 : 1)
    channel.values[i] = glm::vec4(glm::dvec4(channel.values[i]) + glm::dvec4(by, 0));
}

}  // namespace rilievo
