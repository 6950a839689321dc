// From where is an impostor seen, and from where will it be? Pure; any thread.
#pragma once

#include <glm/glm.hpp>
#include <optional>

#include "rilievo/core/camera.h"

namespace rilievo {

// An eye of a frame, in the space of the object at capture.
struct ImpostorEye {
  glm::dvec3 position{0.0};
  glm::dvec3 velocity{0.0};  // metres per second
  glm::dvec3 turn{0.0};      // of the velocity: radians per second about its direction
  glm::dvec3 up{0, 1, 0};
  double focal_px = 500;  // of the frame: pixels per tangent
  double time = 0;        // of what is seen, seconds
  // Where the frame's pixels are, for pictures whose texels lie on them: the frame's rotation, and
  // the lower left corner of its window, tangents. None: pictures look straight at the object.
  struct Grid {
    glm::dmat3 world_from_eye{1.0};
    glm::dvec2 corner{0.0};
  };
  std::optional<Grid> grid = {};
};

// The eye of a frame that stands still.
[[nodiscard]] ImpostorEye impostor_eye(const Camera& frame);

// Where the eye will be in `seconds`, if it keeps its speed and its turn.
[[nodiscard]] glm::dvec3 predicted_eye(const ImpostorEye& eye, double seconds);

}  // namespace rilievo
