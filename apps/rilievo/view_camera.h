// How do a mouse and keys move an eye? Flying, and circling around a point.
//
// World space, +y up; metres, radians. Pure.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/core/camera.h"

namespace rilievo::app {

// Yaw 0, pitch 0 looks along -z; a positive yaw turns left, a positive pitch up.
struct ViewPose {
  glm::dvec3 eye{0.0};
  double yaw = 0, pitch = 0;
};

[[nodiscard]] glm::dvec3 forward_of(const ViewPose& pose);
[[nodiscard]] ViewPose pose_of(const Camera& camera);

// Turns the gaze; the pitch stays short of straight up and down.
void turn(ViewPose& pose, double left, double up);
// Moves by right, up, forward in the gaze's own directions (up is the world's).
void fly(ViewPose& pose, const glm::dvec3& right_up_forward);
// Around `center`, looking at it; `closer` multiplies the distance by exp(-closer).
void circle(ViewPose& pose, const glm::dvec3& center, double left, double up, double closer);

}  // namespace rilievo::app
