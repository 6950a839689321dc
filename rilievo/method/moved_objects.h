// What has moved since a frame that fades out: where it was, and where it is.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <optional>
#include <span>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/render/placed_scene.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// Follows the objects of one scene that animations move.
class MovedObjects {
 public:
  explicit MovedObjects(const Scene& scene);

  // A frame of this moment (seconds) fades out. `mixed`: it is itself one of a fade.
  void begin_fade(double time, bool mixed);
  // Boxes in world space around each object that has moved since, from where it was to where it is
  // at this moment. Valid until the next call.
  [[nodiscard]] std::span<const Box> since(double time);

 private:
  struct Place {
    glm::mat4 pose{1};
    Box bounds;
  };

  std::vector<std::uint32_t> moving_;
  // Of its own: each method that draws places its own scene. None: nothing moves.
  std::optional<PlacedScene> placed_;
  std::vector<Place> faded_;  // of each of these
  std::vector<Box> boxes_;
};

}  // namespace rilievo
