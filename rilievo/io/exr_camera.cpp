#include "rilievo/io/exr_camera.h"

#include <cmath>

namespace rilievo {
namespace {

// Floats in the file, and renderers that build their matrices in floats.
constexpr double kRigidTolerance = 1e-3;

bool finite(const glm::dmat4& m) {
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r)
      if (!std::isfinite(m[c][r])) return false;
  return true;
}

bool rigid(const glm::dmat3& axes) {
  const glm::dmat3 product = glm::transpose(axes) * axes;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      if (std::abs(product[c][r] - (c == r ? 1.0 : 0.0)) > kRigidTolerance) return false;
  return true;
}

Error wrong(const char* reason) { return Error{"", reason}; }

}  // namespace

StandardMatrices standard_matrices(const Camera& camera) {
  StandardMatrices m;
  glm::dmat4 forward_z(1.0);
  forward_z[2][2] = -1.0;
  m.camera_from_world = forward_z * eye_from_world(camera);
  // From [-1, 1], y up, to [0, 1], y down; z likewise to window_z.
  glm::dmat4 ndc_from_clip(1.0);
  ndc_from_clip[0][0] = 0.5;
  ndc_from_clip[1][1] = -0.5;
  ndc_from_clip[2][2] = 0.5;
  ndc_from_clip[3] = {0.5, 0.5, 0.5, 1.0};
  m.ndc_from_world = ndc_from_clip * clip_from_world(camera);
  return m;
}

Result<Camera> camera_from_standard(const StandardMatrices& matrices) {
  if (!finite(matrices.camera_from_world) || !finite(matrices.ndc_from_world))
    return wrong("worldToCamera or worldToNDC is not finite");

  // The pose: a rotation or a reflection, and a translation.
  const glm::dmat4& view = matrices.camera_from_world;
  if (view[0][3] != 0 || view[1][3] != 0 || view[2][3] != 0 || view[3][3] != 1)
    return wrong("worldToCamera is not affine");
  const glm::dmat3 rotation(view);
  if (!rigid(rotation)) return wrong("worldToCamera is not a rigid pose");

  // ndc_from_camera: what is left of worldToNDC without the pose. Rows x, y, w of its columns.
  const glm::dmat4 ndc_from_camera = matrices.ndc_from_world * glm::inverse(view);
  const auto row = [&](int r) {
    return glm::dvec4(ndc_from_camera[0][r], ndc_from_camera[1][r], ndc_from_camera[2][r],
                      ndc_from_camera[3][r]);
  };
  glm::dvec4 x = row(0), y = row(1), w = row(3);

  // w is a multiple of the distance along the line of sight (perspective) or of 1 (parallel).
  const double scale = std::abs(w.z) + std::abs(w.w);
  const bool parallel = std::abs(w.z) < kRigidTolerance * scale;
  if (!(scale > 0) || std::abs(w.x) + std::abs(w.y) > kRigidTolerance * scale)
    return wrong("worldToNDC is not a projection from worldToCamera's pose");
  const double unit = parallel ? w.w : std::abs(w.z);
  if (unit == 0) return wrong("worldToNDC is degenerate");
  x /= unit, y /= unit, w /= unit;

  // A camera space that looks down -z has w = -z. Parallel projections have no such sign: there the
  // handedness decides, the world being right-handed.
  const bool left_handed = glm::determinant(rotation) < 0;
  const double forward = parallel ? (left_handed ? 1.0 : -1.0) : w.z;
  if ((forward > 0) != left_handed) return wrong("worldToCamera belongs to a left-handed world");

  // On the plane one metre ahead: ndc = a u + c, where c comes with z (perspective) or 1.
  const double center_x = parallel ? x.w : x.z * forward;
  const double center_y = parallel ? y.w : y.z * forward;
  // What must vanish: a shear of x and y; the rays' shear (parallel), or their distance from the
  // eye (perspective), which is rounded the more the farther the eye is from the world's origin.
  const double size = std::abs(x.x) + std::abs(y.y);
  const double reach = 1 + glm::length(glm::dvec3(view[3]));
  const double rest =
      parallel ? (std::abs(x.z) + std::abs(y.z)) / size
               : (std::abs(x.w) + std::abs(y.w)) / (size * reach) + std::abs(w.w) / reach;
  if (std::abs(x.y) + std::abs(y.x) > kRigidTolerance * size || !(rest <= kRigidTolerance))
    return wrong("worldToNDC is not a projection from worldToCamera's pose");
  if (!(x.x > 0) || y.y == 0) return wrong("worldToNDC is mirrored or degenerate");

  // y down: corners at 0 and 1. y up: RenderMan's screen, corners at -1 and 1.
  const bool down = y.y < 0;
  const double low = down ? 0.0 : -1.0;
  Camera camera;
  camera.projection = parallel ? Projection::parallel : Projection::perspective;
  camera.window.left = (low - center_x) / x.x;
  camera.window.right = (1.0 - center_x) / x.x;
  camera.window.top = ((down ? 0.0 : 1.0) - center_y) / y.y;
  camera.window.bottom = ((down ? 1.0 : -1.0) - center_y) / y.y;

  // The nearest rigid pose in doubles: Gram-Schmidt, beginning with the line of sight. The rows of
  // `rotation` are the camera's axes in the world.
  const glm::dmat3 axes = glm::transpose(rotation);
  const glm::dvec3 back = glm::normalize(axes[2] * -forward);
  const glm::dvec3 up = glm::normalize(axes[1] - back * glm::dot(axes[1], back));
  const glm::dvec3 right = glm::cross(up, back);
  const glm::dvec3 eye = glm::dvec3(glm::inverse(view)[3]);
  camera.world_from_eye = {glm::dvec4(right, 0), glm::dvec4(up, 0), glm::dvec4(back, 0),
                           glm::dvec4(eye, 1)};
  return camera;
}

}  // namespace rilievo
