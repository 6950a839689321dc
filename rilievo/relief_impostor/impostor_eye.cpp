#include "rilievo/relief_impostor/impostor_eye.h"

#include <cmath>

namespace rilievo {

// A velocity v that turns by w a second about the unit axis a goes, in t,
//
//   (a.v) a t  +  (v - (a.v) a) sin(wt)/w  +  (a x v) (1 - cos(wt))/w
ImpostorEye impostor_eye(const Camera& frame) {
  ImpostorEye eye;
  eye.position = frame.position();
  eye.up = glm::dvec3(frame.world_from_eye[1]);
  eye.focal_px = frame.width / (frame.window.right - frame.window.left);
  eye.grid = {glm::dmat3(frame.world_from_eye), {frame.window.left, frame.window.bottom}};
  return eye;
}

glm::dvec3 predicted_eye(const ImpostorEye& eye, double seconds) {
  const double rate = glm::length(eye.turn);
  if (rate * seconds < 1e-9) return eye.position + eye.velocity * seconds;
  const glm::dvec3 axis = eye.turn / rate;
  const glm::dvec3 along = axis * glm::dot(axis, eye.velocity);
  return eye.position + along * seconds +
         (eye.velocity - along) * (std::sin(rate * seconds) / rate) +
         glm::cross(axis, eye.velocity) * ((1 - std::cos(rate * seconds)) / rate);
}

}  // namespace rilievo
