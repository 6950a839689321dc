#include "rilievo/frame/camera_from.h"

#include <cmath>

namespace rilievo {
namespace {

// How far entries that must be 0 or -1 may be off: rounding of single-precision matrices.
constexpr double kMatrixRounding = 1e-5;

bool is_perspective(const glm::dmat4& p) {
  const double scale = std::abs(p[2][3]);
  if (!(scale > 0)) return false;
  const auto zero = [&](double v) { return std::abs(v) <= kMatrixRounding * scale; };
  return p[2][3] < 0 && zero(p[0][1]) && zero(p[0][2]) && zero(p[0][3]) && zero(p[1][0]) &&
         zero(p[1][2]) && zero(p[1][3]) && zero(p[3][0]) && zero(p[3][1]) && zero(p[3][3]);
}

// The nearest rotation to what is one but for rounding: single-precision matrices are rigid to
// 1e-6 or so only.
glm::dmat4 without_rounding(const glm::dmat4& pose) {
  glm::dvec3 x(pose[0]), y(pose[1]);
  x = glm::normalize(x);
  y = glm::normalize(y - glm::dot(x, y) * x);
  glm::dmat4 rigid(1.0);
  rigid[0] = glm::dvec4(x, 0), rigid[1] = glm::dvec4(y, 0),
  rigid[2] = glm::dvec4(glm::cross(x, y), 0);
  rigid[3] = glm::dvec4(glm::dvec3(pose[3]), 1);
  return rigid;
}

bool is_rotation_and_translation(const glm::dmat4& m) {
  const glm::dmat3 r(m);
  const glm::dmat3 product = glm::transpose(r) * r;
  for (int column = 0; column < 3; ++column)
    for (int row = 0; row < 3; ++row)
      if (!(std::abs(product[column][row] - (column == row)) <= kMatrixRounding)) return false;
  for (int column = 0; column < 4; ++column)
    if (!(std::abs(m[column][3] - (column == 3)) <= kMatrixRounding)) return false;
  return glm::determinant(r) > 0;
}

}  // namespace

Result<HostCamera> camera_from(const glm::dmat4& eye_from_world, const glm::dmat4& clip_from_eye,
                               int width, int height, ClipRange range) {
  const char* const kView = "view matrix";
  const char* const kProjection = "projection matrix";
  if (!is_rotation_and_translation(eye_from_world))
    return Error{kView, "is not a rotation and a translation: a camera does not scale or mirror"};
  if (!is_perspective(clip_from_eye))
    return Error{kProjection, "is not a perspective projection that looks down -z"};
  const glm::dmat4 p = clip_from_eye / -clip_from_eye[2][3];
  const double a = p[0][0], b = p[1][1], s = p[2][0], t = p[2][1], c = p[2][2], e = p[3][2];
  if (!(a > 0)) return Error{kProjection, "is mirrored: x does not point right"};
  if (!(b > 0)) return Error{kProjection, "is upside down: y does not point up"};
  if (!(std::abs(e) > 0) || !std::isfinite(c))
    return Error{kProjection, "has no depth: its planes are one"};

  HostCamera host;
  host.reversed = e > 0;
  const double low = range == ClipRange::minus_one_to_one ? -1 : 0;
  // ndc_z = -c + e / d: d = e / (ndc_z + c).
  const double at_near = host.reversed ? 1 : low, at_far = host.reversed ? low : 1;
  Camera& camera = host.camera;
  camera.z_near = e / (at_near + c);
  // Without a far plane the divisor is 0, but for rounding.
  const double far_divisor = at_far + c;
  camera.z_far = std::abs(far_divisor) <= kMatrixRounding * std::abs(at_near + c)
                     ? kFarOfInfinite * camera.z_near
                     : e / far_divisor;
  if (!(camera.z_near > 0 && camera.z_near < camera.z_far))
    return Error{kProjection, range == ClipRange::minus_one_to_one
                                  ? "has no planes 0 < near < far for depths in [-1, 1]"
                                  : "has no planes 0 < near < far for depths in [0, 1]"};
  // x_ndc = a x / d - s: the rectangle is where it is -1 and 1.
  camera.window = {(s - 1) / a, (s + 1) / a, (t - 1) / b, (t + 1) / b};
  camera.world_from_eye = without_rounding(glm::inverse(eye_from_world));
  camera.width = width, camera.height = height;
  if (Result<> valid = validate(camera); !valid) return Error{kView, valid.error().reason};
  // Window depth: [-1, 1] is mapped to [0, 1], which stays.
  const double half = range == ClipRange::minus_one_to_one ? 0.5 : 1;
  host.depth_offset = half * -c + (1 - half);
  host.depth_scale = half * e;
  return host;
}

}  // namespace rilievo
