// Where will the eye be some frames from now, judging by the last ones?
//
// The mean step and turn of the last frames go on. A jump is no motion: after it the eye stands,
// until it moves again; nor does one long step, of a frame that took long, tell how fast it goes.
// World space; metres and radians per frame.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/core/camera.h"

namespace rilievo {

// Follows an eye.
class EyePrediction {
 public:
  // The turn that is predicted at most, in all: an eye that turns fast soon looks at one thing. So
  // a turn goes on ever more slowly, as if for so many frames in the end.
  static constexpr double kMostTurn = 0.5, kTurningFrames = 24;

  // The next frame's camera.
  void follow(const Camera& camera);
  // The last camera, moved on by `frames` frames. Requires that one was followed.
  [[nodiscard]] Camera after(double frames) const;
  // How fast it turns about its own y and x axes, radians per frame, without sign.
  [[nodiscard]] double turning_sideways() const;
  [[nodiscard]] double turning_upwards() const;
  // Not if the last step was the first one, nor in the first frame in which the eye stands.
  [[nodiscard]] bool speed_known() const { return speed_known_; }
  // Has the eye jumped to the last camera?
  [[nodiscard]] bool jumped() const { return jumped_; }

 private:
  bool any_ = false, jumped_ = false, stood_ = false, speed_known_ = true;
  Camera last_;
  // Turns are axes in world space, as long as their angles.
  glm::dvec3 step_{0.0}, turn_{0.0};
  glm::dvec3 last_step_{0.0}, last_turn_{0.0};
};

}  // namespace rilievo
