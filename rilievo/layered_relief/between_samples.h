// What lies between the samples of a layered picture? Its surfaces go on there.
//
// Lines of sight hit a surface in a lattice, up to 0.87 texels from what lies in the middle, and
// farther in the unit of a picture with finer texels. World space, metres; of parallel pictures.
#pragma once

#include <cstddef>
#include <functional>
#include <glm/glm.hpp>

#include "rilievo/layered_relief/sample_sides.h"

namespace rilievo {

// A place on the surface between samples.
struct PlaceBetween {
  std::size_t sample = 0;  // one of those around it
  glm::dvec3 world{0.0};
  glm::vec4 color{0};  // a mean of theirs
};

// Calls visit(place) for places beside the samples that `of` wants, between neighbouring samples
// that lie on one surface: of one closed object, with normals that agree, each in the plane of the
// other within kOnePlane texels. Neighbouring places, and those beside the samples, are at most
// `spacing` apart. Surfaces of what is not closed, such as leaves, are as wide as the gaps between
// them: there is nothing sure to lie between their samples.
inline constexpr double kOnePlane = 0.3;
void each_place_between(const SampleSides& sides, double spacing,
                        const std::function<bool(std::size_t sample)>& of,
                        const std::function<void(const PlaceBetween&)>& visit);

}  // namespace rilievo
