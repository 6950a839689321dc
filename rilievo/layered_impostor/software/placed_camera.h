// Where does a frame's eye stand in the world of a capture? Internal to
// `layered_impostor/software`.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "rilievo/core/camera.h"
#include "rilievo/kind/drawable.h"

namespace rilievo {

// The frame's camera in the world of the capture. There its rays are t d with t the frame's eye_z,
// divided by the scale of the placement.
struct PlacedCamera {
  Camera camera;
  double scale = 1;
};

// None if the instance has no size.
[[nodiscard]] inline std::optional<PlacedCamera> place_camera(const Camera& frame,
                                                              const Instance& instance) {
  const glm::dmat4& motion = instance.world_from_capture;
  PlacedCamera placed{frame, glm::length(glm::dvec3(motion[0]))};
  if (!(placed.scale > 0)) return std::nullopt;
  placed.camera.world_from_eye = glm::inverse(motion) * frame.world_from_eye;
  for (int k = 0; k < 3; ++k) placed.camera.world_from_eye[k] *= placed.scale;
  placed.camera.z_near /= placed.scale, placed.camera.z_far /= placed.scale;
  return placed;
}

}  // namespace rilievo
