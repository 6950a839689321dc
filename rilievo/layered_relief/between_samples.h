// What lies between the samples of a layered picture? Its surfaces go on there.
//
// Lines of sight hit a surface in a lattice, up to 0.87 texels from what lies in the middle, and
// farther in the unit of a picture with finer texels. World space, metres; of parallel pictures.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <glm/glm.hpp>
#include <vector>

#include "rilievo/layered_relief/sample_sides.h"

namespace rilievo {

// A place on the surface between samples.
struct PlaceBetween {
  // Those around it: of the texel, right of it, below it, and both; the first one where there is
  // none.
  std::array<std::size_t, 4> around{};
  double right = 0, low = 0;  // from the first one to the others, 0 to 1
  glm::dvec3 world{0.0};
};

// The mean of the samples around it.
[[nodiscard]] glm::vec4 color_of(const LayeredDepthImage& layers, const PlaceBetween& place);

// Which neighbouring samples lie on one surface: of one closed object, with normals that agree,
// each in the plane of the other within kOnePlane texels. Surfaces of what is not closed, such as
// leaves, are as wide as the gaps between them: there is nothing sure to lie between their samples.
inline constexpr double kOnePlane = 0.3;
class SurfaceLattice {
 public:
  // `sides` must outlive the object.
  explicit SurfaceLattice(const SampleSides& sides);

  // Calls visit(place) for places between neighbours, beside the samples that `of` wants.
  // Neighbouring places, and those beside the samples, are at most `spacing` apart.
  void each_place(double spacing, const std::function<bool(std::size_t sample)>& of,
                  const std::function<void(const PlaceBetween&)>& visit) const;

 private:
  static constexpr std::uint32_t kNoNeighbor = 0xffffffff;
  void each_place_beside(std::size_t sample, double spacing,
                         const std::function<void(const PlaceBetween&)>& visit) const;

  const SampleSides& sides_;
  std::vector<glm::dvec3> world_;  // of each sample
  // Of each sample: right of it, below it, and both.
  std::vector<std::array<std::uint32_t, 3>> neighbors_;
};

}  // namespace rilievo
