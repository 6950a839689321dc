// Which places have a sample of a layered picture near them?
//
// World space, metres; of a parallel picture, to which samples are added.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <limits>
#include <optional>
#include <vector>

#include "rilievo/core/depth_image.h"

namespace rilievo {

// Where a picture has a place of the world.
struct PlacedIn {
  glm::dvec2 at{0.0};    // raster
  std::size_t line = 0;  // of sight
  double depth = 0;      // in the picture's kind
};

// Finds places, as raster_from_world does, with what is the same for all of them. `to` must outlive
// the object.
class Placing {
 public:
  explicit Placing(const LayeredDepthImage& to);
  // None if it is beside the picture.
  [[nodiscard]] std::optional<PlacedIn> find(const glm::dvec3& world) const;
  // Raster and depth, but for rounding; wherever it is.
  [[nodiscard]] glm::dvec3 about(const glm::dvec3& world) const {
    return glm::dvec3(about_from_world_ * glm::dvec4(world, 1));
  }

 private:
  const LayeredDepthImage& to_;
  glm::dmat4 eye_from_world_, about_from_world_;
};

// The samples of a picture, by their lines of sight. `layers` must outlive the object.
class SampleCoverage {
 public:
  // `reach`: metres.
  SampleCoverage(const LayeredDepthImage& layers, double reach);
  // Adds a sample.
  void add(std::size_t line, float depth);
  // Is there a sample within the reach of a place (Placing::about)?
  [[nodiscard]] bool covers(const glm::dvec3& place);

 private:
  struct Sample {
    int x = 0, y = 0;
    float depth = std::numeric_limits<float>::infinity();
  };
  const LayeredDepthImage& layers_;
  double reach_, per_metre_, metres_;
  glm::dvec2 texel_;
  int around_ = 1;  // so many lines of sight to each side are within the reach
  Sample last_;     // which covered a place
  // The picture's own, as its `first` has them, and of each line those added. Both sorted: there
  // are hundreds where a line runs along a face that other pictures see.
  std::vector<float> own_;
  std::vector<std::vector<float>> added_;
};

}  // namespace rilievo
