// A camera: from where, and through which rays, a picture is taken.
//
// Eye space is right-handed, in metres: +x right, +y up; the camera looks down its -z. Clip space
// is OpenGL's: after the division, x, y and z lie in [-1, 1], and z = -1 on the near plane. Raster
// space is in texels: its origin is the top left corner of the image, x points right, y down.
//
// Cameras are in double precision, because they place pictures in large worlds. The GPU gets
// single-precision coordinates relative to the eye.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/core/bounds.h"
#include "rilievo/core/result.h"

namespace rilievo {

// How rays leave the camera, and which sample on each ray the picture keeps.
enum class Projection {
  perspective,       // rays leave the eye; the nearest sample is kept
  back_perspective,  // rays leave an apex *behind* the object; the farthest sample is kept (S2.1)
  parallel,          // rays run along -z; the nearest sample is kept
};

// The image's rectangle: for both perspective projections tangents (on the plane z = -1), for a
// parallel projection metres.
struct ImageWindow {
  double left = -1, right = 1, bottom = -1, top = 1;
  friend bool operator==(const ImageWindow&, const ImageWindow&) = default;
};

// A camera: pose, projection, image rectangle, clipping planes and resolution.
struct Camera {
  Projection projection = Projection::perspective;
  glm::dmat4 world_from_eye{1.0};  // rigid: the camera's axes and position in the world
  ImageWindow window;
  double z_near = 0.1, z_far = 100.0;  // distances along -z, 0 < z_near < z_far
  int width = 1, height = 1;           // texels
  // Along each axis, for each pixel of the frames that the picture is for: more than 1 where it is
  // supersampled. Lines and points of n pixels are n * texels_per_pixel texels wide.
  float texels_per_pixel = 1;

  // The eye, or the apex of a back-perspective camera. World space.
  [[nodiscard]] glm::dvec3 position() const { return glm::dvec3(world_from_eye[3]); }
  // The viewing direction: the unit vector along -z. World space.
  [[nodiscard]] glm::dvec3 forward() const { return -glm::dvec3(world_from_eye[2]); }
  [[nodiscard]] bool keeps_farthest() const { return projection == Projection::back_perspective; }

  friend bool operator==(const Camera&, const Camera&) = default;
};

// The camera's matrices, named by target and source space.
[[nodiscard]] glm::dmat4 eye_from_world(const Camera& camera);
[[nodiscard]] glm::dmat4 clip_from_eye(const Camera& camera);
[[nodiscard]] glm::dmat4 clip_from_world(const Camera& camera);
// From points given as world-space offsets from the camera's position. These numbers are small
// enough for single precision.
[[nodiscard]] glm::dmat4 clip_from_relative(const Camera& camera);

// Projects a world point: x, y are its raster position (texels), z is its eye_z (metres along -z),
// which is not positive for a point behind the eye.
[[nodiscard]] glm::dvec3 raster_from_world(const Camera& camera, const glm::dvec3& world);
// The world point at raster position `raster` and distance `eye_z` along -z.
[[nodiscard]] glm::dvec3 world_from_raster(const Camera& camera, const glm::dvec2& raster,
                                           double eye_z);

// The camera of a rectangle of its texels, `x` and `y` from the top left; it may reach beyond.
[[nodiscard]] Camera camera_of_part(const Camera& camera, int x, int y, int width, int height);

// The same view with `times` as many texels along each axis, for frames of the same size.
[[nodiscard]] Camera supersampled(const Camera& camera, int times);

// Angle in radians between the rays through two horizontally adjacent texels at the image's centre.
// For a parallel camera: the width of a texel in metres.
[[nodiscard]] double texel_angle(const Camera& camera);

// A symmetric perspective camera. `vertical_fov` in radians; `up` need not be orthogonal to the
// viewing direction.
[[nodiscard]] Camera look_at(const glm::dvec3& eye, const glm::dvec3& target, const glm::dvec3& up,
                             double vertical_fov, int width, int height, double z_near,
                             double z_far);

// The tightest off-axis camera at `eye` that looks at the centre of `box` and whose frustum holds
// `box`. It is one texel in size. Fails if the box is empty, not finite, or reaches behind the eye
// (a parallel camera takes only its direction from `eye` and accepts every finite box).
[[nodiscard]] Result<Camera> tight_camera(Projection projection, const glm::dvec3& eye,
                                          const glm::dvec3& up, const Box& box);

// Checks that every number is finite, that the frustum is not degenerate, and that the pose is
// rigid (to 1e-6) and not mirrored.
[[nodiscard]] Result<> validate(const Camera& camera);

}  // namespace rilievo
