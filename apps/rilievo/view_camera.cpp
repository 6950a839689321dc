#include "apps/rilievo/view_camera.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>

namespace rilievo::app {
namespace {

// Straight up there is no left.
constexpr double kMaxPitch = 0.49 * glm::pi<double>();

void look_along(ViewPose& pose, const glm::dvec3& in_world) {
  const glm::dvec3 direction = glm::transpose(pose.world_from_upright) * in_world;
  pose.pitch = std::clamp(std::asin(std::clamp(direction.y, -1.0, 1.0)), -kMaxPitch, kMaxPitch);
  if (std::abs(direction.x) + std::abs(direction.z) > 1e-9)
    pose.yaw = std::atan2(-direction.x, -direction.z);
}

}  // namespace

glm::dvec3 forward_of(const ViewPose& pose) {
  const double level = std::cos(pose.pitch);
  return pose.world_from_upright *
         glm::dvec3(-std::sin(pose.yaw) * level, std::sin(pose.pitch), -std::cos(pose.yaw) * level);
}

glm::dmat3 upright_axes(const glm::dvec3& up) {
  const glm::dvec3 back = std::abs(up.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
  const glm::dvec3 z = glm::normalize(back - glm::dot(back, up) * up);
  return {glm::cross(up, z), up, z};
}

ViewPose pose_of(const Camera& camera, const glm::dmat3& world_from_upright) {
  ViewPose pose;
  pose.eye = camera.position();
  pose.world_from_upright = world_from_upright;
  look_along(pose, camera.forward());
  return pose;
}

void turn(ViewPose& pose, double left, double up) {
  pose.yaw = std::remainder(pose.yaw + left, 2 * glm::pi<double>());
  pose.pitch = std::clamp(pose.pitch + up, -kMaxPitch, kMaxPitch);
}

void fly(ViewPose& pose, const glm::dvec3& right_up_forward) {
  const glm::dvec3 right =
      pose.world_from_upright * glm::dvec3(std::cos(pose.yaw), 0, -std::sin(pose.yaw));
  pose.eye += right * right_up_forward.x + up_of(pose) * right_up_forward.y +
              forward_of(pose) * right_up_forward.z;
}

void circle(ViewPose& pose, const glm::dvec3& center, double left, double up, double closer) {
  const glm::dvec3 away = center - pose.eye;
  const double distance = std::max(1e-6, glm::length(away));
  if (glm::length(away) > 1e-6) look_along(pose, away / distance);
  // Dragging to the left carries the scene to the left, and the eye to the right.
  turn(pose, left, up);
  pose.eye = center - distance * std::exp(-std::clamp(closer, -5.0, 5.0)) * forward_of(pose);
}

}  // namespace rilievo::app
