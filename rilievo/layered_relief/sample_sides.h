// Which side of its surface does a sample of a layered picture show?
//
// A line of sight hits the inner side of a teapot's wall, too, and the other pictures' lines of
// sight the outer side at the same place. Both have colours of their own: a wall that has samples
// of both looks peppered. World space, metres; of parallel pictures.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <unordered_set>
#include <vector>

#include "rilievo/core/depth_image.h"

namespace rilievo {

// Objects that are closed bodies, which have an inner side that nobody sees: of the lines of sight
// that meet one once or an even number of times, at least kClosedShare go in as often as they come
// out. Leaves are met once as often as twice. Other odd numbers come of bodies that touch, too,
// whose surfaces are merged there; but leaves, however many, are met an even number of times by
// half of all lines at most, and of a body at least kLeastEven.
inline constexpr double kClosedShare = 0.85, kLeastEven = 0.6;
[[nodiscard]] std::unordered_set<std::uint32_t> find_closed_objects(
    std::span<const LayeredDepthImage* const> pictures);

// The samples of a layered picture with the side that they show.
class SampleSides {
 public:
  // `closed`: of find_closed_objects(). `layers` must outlive the object.
  SampleSides(const LayeredDepthImage& layers, const std::unordered_set<std::uint32_t>& closed);

  // The unit normal towards the picture's viewers, by the nearest samples of neighbouring lines of
  // sight.
  [[nodiscard]] const glm::vec3& normal(std::size_t sample) const { return normals_[sample]; }
  // Are there such neighbours along both axes? Else it is towards the viewers as if the surface
  // were across their sight, which may as well be along it.
  [[nodiscard]] bool knows_normal(std::size_t sample) const { return knows_normal_[sample] != 0; }
  [[nodiscard]] const LayeredDepthImage& layers() const { return layers_; }

  // Where its line of sight goes into a closed object: as counted along the line; where that meets
  // the object an odd number of times, so that one hit is missing, as its neighbours on the
  // surface.
  [[nodiscard]] bool is_outer(std::size_t sample) const { return outer_[sample]; }
  // Where it comes out of one: the side that nobody sees.
  [[nodiscard]] bool is_inner(std::size_t sample) const {
    return is_closed(sample) && !outer_[sample];
  }

  // When a picture that looks along `forward` takes a sample of this one: 0, first, if it is an
  // outer side that faces the other's viewers, or nearly; 1 if it faces them; 2 if it shows the
  // side that they do not see. What is not closed has no order: 0.
  [[nodiscard]] int turn(std::size_t sample, const glm::dvec3& forward) const;
  static constexpr int kTurns = 3;
  [[nodiscard]] bool is_closed(std::size_t sample) const { return is_closed_[sample] != 0; }

 private:
  struct Unsettled {
    std::size_t sample, line;
  };
  void settle(std::vector<Unsettled> unsettled);

  const LayeredDepthImage& layers_;
  std::vector<glm::vec3> normals_;
  std::vector<std::uint8_t> is_closed_, knows_normal_;  // not of bool: threads write these
  std::vector<bool> outer_;
  std::vector<float> z_;
};

}  // namespace rilievo
