// From where, and through which rays, was a picture taken?
//
// Eye space is right-handed: +x right, +y up, the camera looks down its -z; metres. Clip space is
// OpenGL's: after the division x, y, z lie in [-1, 1], z = -1 on the near plane. Raster space has
// its origin at the top left corner of the image, x right, y down, in texels.
//
// Doubles, because a camera is used to place pictures in large worlds; what the GPU gets is
// relative.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/core/bounds.h"
#include "rilievo/core/result.h"

namespace rilievo {

enum class Projection {
  perspective,       // rays leave the eye; the nearest sample on each is kept
  back_perspective,  // rays leave an apex *behind* the object; the farthest sample is kept (S2.1)
  parallel,          // rays along -z; the nearest sample is kept
};

// The image's rectangle: on the plane z = -1 (tangents) if the rays meet, else in metres.
struct ImageWindow {
  double left = -1, right = 1, bottom = -1, top = 1;
  friend bool operator==(const ImageWindow&, const ImageWindow&) = default;
};

struct Camera {
  Projection projection = Projection::perspective;
  glm::dmat4 world_from_eye{1.0};  // rigid: the camera's axes and position in the world
  ImageWindow window;
  double z_near = 0.1, z_far = 100.0;  // distances along -z, 0 < z_near < z_far
  int width = 1, height = 1;           // texels

  // The eye; for back-perspective the apex.
  [[nodiscard]] glm::dvec3 position() const { return glm::dvec3(world_from_eye[3]); }
  // Unit vector of -z.
  [[nodiscard]] glm::dvec3 forward() const { return -glm::dvec3(world_from_eye[2]); }
  [[nodiscard]] bool keeps_farthest() const { return projection == Projection::back_perspective; }

  friend bool operator==(const Camera&, const Camera&) = default;
};

[[nodiscard]] glm::dmat4 eye_from_world(const Camera& camera);
[[nodiscard]] glm::dmat4 clip_from_eye(const Camera& camera);
[[nodiscard]] glm::dmat4 clip_from_world(const Camera& camera);
// Of what is given relative to the camera's position, in world axes: small numbers, for floats.
[[nodiscard]] glm::dmat4 clip_from_relative(const Camera& camera);

// Raster position (texels, y down) and eye_z (metres along -z) of a world point. eye_z may be <= 0.
[[nodiscard]] glm::dvec3 raster_from_world(const Camera& camera, const glm::dvec3& world);
// The world point at raster position `raster` and distance `eye_z` along -z.
[[nodiscard]] glm::dvec3 world_from_raster(const Camera& camera, const glm::dvec2& raster,
                                           double eye_z);

// Angle between the lines of sight of two horizontally adjacent texels at the image's centre,
// radians; for a parallel camera the texel's width in metres.
[[nodiscard]] double texel_angle(const Camera& camera);

// A symmetric perspective camera. `vertical_fov` in radians; `up` need not be orthogonal.
[[nodiscard]] Camera look_at(const glm::dvec3& eye, const glm::dvec3& target, const glm::dvec3& up,
                             double vertical_fov, int width, int height, double z_near,
                             double z_far);

// The tightest off-axis camera of kind `projection` at `eye`, looking at the centre of `box`, whose
// frustum holds `box`. `width`, `height` left at 1. Nothing if the box is empty, not finite, or
// reaches behind the eye (for parallel: never fails on a finite box; `eye` gives the direction).
[[nodiscard]] Result<Camera> tight_camera(Projection projection, const glm::dvec3& eye,
                                          const glm::dvec3& up, const Box& box);

// Is every number finite, the frustum not degenerate, and the pose rigid (to 1e-6),
// not mirrored?
[[nodiscard]] Result<> validate(const Camera& camera);

}  // namespace rilievo
