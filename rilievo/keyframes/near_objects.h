// The objects near the eye that are drawn as polygons instead of warped.
//
// A near object looks different, and hides something else, from each place that the eye passes. A
// warped picture of it shows its silhouettes in the wrong place, shows nothing behind them, and has
// the resolution of another distance. Polygons of an object with few triangles are exact and cheap.
// Keyframes are captured without these objects, and so show what is behind them.
//
// A choice for a keyframe: of the objects whose distance is at most some times the eye's way, and
// which are no larger than some times that way, the nearest first, as many as a number of triangles
// allows. The same input gives the same choice. One thread.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/render/placed_scene.h"

namespace rilievo {

// An object, and how far it is from the eye.
struct ObjectAtDistance {
  double distance = 0;
  std::uint32_t object = 0;
};

// Puts the nearest objects first, and takes those that have at most so many triangles together, one
// after the other; `taken` is ascending.
void take_nearest(const Scene& scene, double triangles, std::vector<ObjectAtDistance>& objects,
                  std::vector<std::uint32_t>& taken);

// How near, and how many.
struct NearObjectsOptions {
  double distance = 1;         // at most so many times the eye's way
  double triangles = 200'000;  // of all of them together
};

// Chooses among some objects of a scene.
class NearObjects {
 public:
  // Larger objects, in multiples of the eye's way, are not chosen: they are mostly surface, as the
  // ground is, which warps well and costs more to shade than to warp.
  static constexpr double kLargest = 10;

  // Among `objects`, ascending. `placed` must outlive the object.
  NearObjects(const PlacedScene& placed, std::vector<std::uint32_t> objects,
              const NearObjectsOptions& options = {});

  // For a keyframe that lasts while the eye goes from `frame` to its own eye.
  void choose(const Camera& keyframe, const Camera& frame);
  // The last choice, ascending; and what else the keyframe sees.
  [[nodiscard]] std::span<const std::uint32_t> near() const { return near_; }
  [[nodiscard]] std::span<const std::uint32_t> rest() const { return rest_; }

 private:
  const PlacedScene& placed_;
  std::vector<std::uint32_t> objects_;
  NearObjectsOptions options_;
  std::vector<ObjectAtDistance> candidates_;
  std::vector<std::uint32_t> in_view_, near_, rest_;
};

}  // namespace rilievo
