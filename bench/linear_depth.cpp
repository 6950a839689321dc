#include "bench/linear_depth.h"

#include "rilievo/core/depth.h"

namespace rilievo::bench {
namespace {

// Where the line from `eye` through `through` meets the plane at distance `z` along -z of `camera`.
glm::dvec3 meet(const Camera& camera, double z, const glm::dvec3& eye, const glm::dvec3& through) {
  const glm::dvec3 along = through - eye;
  const double from_plane = glm::dot(eye - camera.position(), camera.forward()) - z;
  return eye - along * (from_plane / glm::dot(along, camera.forward()));
}

double eye_z(const Camera& camera, const glm::dvec3& world) {
  return glm::dot(world - camera.position(), camera.forward());
}

double window_z(const Camera& camera, const glm::dvec3& world) {
  return depth_from_eye_z(DepthKind::window_z, eye_z(camera, world), camera, {});
}

}  // namespace

LinearDepth linear_depth(const Camera& capture, const glm::dvec2& raster, double delta,
                         const Camera& frame) {
  // Section 3: un-project the texel, take it to the frame's eye space.
  const double point_z = eye_z_from(DepthKind::window_z, delta, capture, raster);
  const glm::dvec3 point = world_from_raster(capture, raster, point_z);
  // The pixel: the line of sight through the polygon's point, and what it meets of the frustum.
  const glm::dvec3 polygon = world_from_raster(capture, raster, capture.z_near);
  const glm::dvec3 n = meet(capture, capture.z_near, frame.position(), polygon);
  const glm::dvec3 f = meet(capture, capture.z_far, frame.position(), polygon);
  const glm::dvec3 on_ray = meet(capture, point_z, frame.position(), polygon);
  // Eq. (4).
  const double z_n = window_z(frame, n), z_f = window_z(frame, f);
  const double z = z_n + (z_f - z_n) * delta;
  return {eye_z(frame, point), eye_z(frame, on_ray),
          eye_z_from(DepthKind::window_z, z, frame, raster)};
}

}  // namespace rilievo::bench
