// How do a mouse and keys move an eye? Flying, and circling around a point.
//
// World space, metres, radians; any direction may be up. Pure.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/core/camera.h"

namespace rilievo::app {

// Yaw 0, pitch 0 looks along -z of the upright axes; a positive yaw turns left, a positive pitch
// up, which is their y.
struct ViewPose {
  glm::dvec3 eye{0.0};
  double yaw = 0, pitch = 0;
  glm::dmat3 world_from_upright{1.0};  // a rotation
};

// Axes with y along `up`, which is a unit vector; the world's own if that is +y.
[[nodiscard]] glm::dmat3 upright_axes(const glm::dvec3& up);

[[nodiscard]] glm::dvec3 forward_of(const ViewPose& pose);
[[nodiscard]] inline glm::dvec3 up_of(const ViewPose& pose) { return pose.world_from_upright[1]; }
[[nodiscard]] ViewPose pose_of(const Camera& camera, const glm::dmat3& world_from_upright);

// Turns the gaze; the pitch stays short of straight up and down.
void turn(ViewPose& pose, double left, double up);
// Moves by right, up, forward in the gaze's own directions (up is that of the upright axes).
void fly(ViewPose& pose, const glm::dvec3& right_up_forward);
// Around `center`, looking at it; `closer` multiplies the distance by exp(-closer).
void circle(ViewPose& pose, const glm::dvec3& center, double left, double up, double closer);

}  // namespace rilievo::app
