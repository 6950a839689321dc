#include "rilievo/core/camera.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_inverse.hpp>

#include "rilievo/core/box_view.h"

namespace rilievo {
namespace {

bool finite(const glm::dvec3& v) {
  return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z);
}

// The pose of an eye at `position` that looks along `direction`.
glm::dmat4 pose(const glm::dvec3& position, const glm::dvec3& direction, const glm::dvec3& up) {
  const glm::dvec3 back = -glm::normalize(direction);
  glm::dvec3 right = glm::cross(up, back);
  // Looking along `up`: any other axis will do, but always the same one.
  if (glm::dot(right, right) < 1e-12 * glm::dot(up, up)) {
    const glm::dvec3 axis = std::abs(back.x) < 0.9 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 0, 1);
    right = glm::cross(axis, back);
  }
  right = glm::normalize(right);
  const glm::dvec3 true_up = glm::cross(back, right);
  return {glm::dvec4(right, 0), glm::dvec4(true_up, 0), glm::dvec4(back, 0),
          glm::dvec4(position, 1)};
}

}  // namespace

glm::dmat4 eye_from_world(const Camera& camera) {
  return glm::affineInverse(camera.world_from_eye);
}

glm::dmat4 clip_from_eye(const Camera& camera) {
  const auto& [l, r, b, t] = camera.window;
  const double n = camera.z_near, f = camera.z_far;
  glm::dmat4 m(0.0);
  m[0][0] = 2 / (r - l);
  m[1][1] = 2 / (t - b);
  if (camera.projection == Projection::parallel) {
    m[3][0] = -(r + l) / (r - l);
    m[3][1] = -(t + b) / (t - b);
    m[2][2] = -2 / (f - n);
    m[3][2] = -(f + n) / (f - n);
    m[3][3] = 1;
  } else {
    // Eq. (1) of [Schaufler 1997] with the window given on z = -1 instead of z = -n.
    m[2][0] = (r + l) / (r - l);
    m[2][1] = (t + b) / (t - b);
    m[2][2] = -(f + n) / (f - n);
    m[3][2] = -2 * f * n / (f - n);
    m[2][3] = -1;
  }
  return m;
}

glm::dmat4 clip_from_world(const Camera& camera) {
  return clip_from_eye(camera) * eye_from_world(camera);
}

glm::dmat4 clip_from_relative(const Camera& camera) {
  glm::dmat4 turn = camera.world_from_eye;
  turn[3] = {0, 0, 0, 1};
  return clip_from_eye(camera) * glm::transpose(turn);
}

glm::dvec3 raster_from_world(const Camera& camera, const glm::dvec3& world) {
  const glm::dvec3 eye = glm::dvec3(eye_from_world(camera) * glm::dvec4(world, 1));
  const double eye_z = -eye.z;
  const double scale = camera.projection == Projection::parallel ? 1.0 : 1.0 / eye_z;
  const auto& [l, r, b, t] = camera.window;
  return {(eye.x * scale - l) / (r - l) * camera.width,
          (t - eye.y * scale) / (t - b) * camera.height, eye_z};
}

glm::dvec3 world_from_raster(const Camera& camera, const glm::dvec2& raster, double eye_z) {
  const double scale = camera.projection == Projection::parallel ? 1.0 : eye_z;
  const auto& [l, r, b, t] = camera.window;
  const glm::dvec4 eye{(l + raster.x / camera.width * (r - l)) * scale,
                       (t - raster.y / camera.height * (t - b)) * scale, -eye_z, 1};
  return glm::dvec3(camera.world_from_eye * eye);
}

Camera camera_of_part(const Camera& camera, int x, int y, int width, int height) {
  Camera part = camera;
  const ImageWindow& w = camera.window;
  const double per_column = (w.right - w.left) / camera.width,
               per_row = (w.top - w.bottom) / camera.height;
  // A side that they share stays what it is.
  if (x != 0) part.window.left = w.left + x * per_column;
  if (x + width != camera.width) part.window.right = w.left + (x + width) * per_column;
  if (y != 0) part.window.top = w.top - y * per_row;
  if (y + height != camera.height) part.window.bottom = w.top - (y + height) * per_row;
  part.width = width, part.height = height;
  return part;
}

Camera supersampled(const Camera& camera, int times) {
  Camera finer = camera;
  finer.width *= times, finer.height *= times;
  finer.texels_per_pixel *= float(times);
  return finer;
}

double texel_angle(const Camera& camera) {
  const double step = (camera.window.right - camera.window.left) / camera.width;
  if (camera.projection == Projection::parallel) return step;
  const double center = 0.5 * (camera.window.right + camera.window.left);
  return std::atan(center + 0.5 * step) - std::atan(center - 0.5 * step);
}

Camera look_at(const glm::dvec3& eye, const glm::dvec3& target, const glm::dvec3& up,
               double vertical_fov, int width, int height, double z_near, double z_far) {
  const double top = std::tan(0.5 * vertical_fov), right = top * width / height;
  Camera camera;
  camera.world_from_eye = pose(eye, target - eye, up);
  camera.window = {-right, right, -top, top};
  camera.z_near = z_near;
  camera.z_far = z_far;
  camera.width = width;
  camera.height = height;
  return camera;
}

Result<Camera> tight_camera(Projection projection, const glm::dvec3& eye, const glm::dvec3& up,
                            const Box& box) {
  if (box.empty()) return Error{"tight_camera", "the box is empty"};
  const glm::dvec3 center(box.center());
  if (!finite(glm::dvec3(box.min)) || !finite(glm::dvec3(box.max)) || !finite(eye))
    return Error{"tight_camera", "the box or the eye is not finite"};
  if (center == eye) return Error{"tight_camera", "the eye is at the centre of the box"};

  Camera camera;
  camera.projection = projection;
  camera.world_from_eye = pose(eye, center - eye, up);
  auto [w, nearest, farthest] = view_of_box(eye_from_world(camera), box, projection);
  if (projection != Projection::parallel && nearest <= 0)
    return Error{"tight_camera", "the box reaches behind the eye"};
  // A parallel camera may stand anywhere along its axis: place it so that z_near > 0.
  const double size = std::max({w.right - w.left, w.top - w.bottom, farthest - nearest});
  if (projection == Projection::parallel) {
    const double back_off = std::max(size, 1e-6) - nearest;
    camera.world_from_eye[3] += camera.world_from_eye[2] * back_off;
    nearest += back_off;
    farthest += back_off;
  }
  // A box without extent along an axis still needs a frustum: pad by a hair of the other extents.
  const double reach = projection == Projection::parallel ? 1.0 : farthest;
  const double pad = 1e-4 * std::max({w.right - w.left, w.top - w.bottom, size / reach, 1e-9});
  if (w.right - w.left < pad) w.left -= pad, w.right += pad;
  if (w.top - w.bottom < pad) w.bottom -= pad, w.top += pad;
  // Surfaces that touch the box must not be clipped by rounding.
  const double slack = 1e-4 * std::max(farthest - nearest, 1e-3 * farthest);
  camera.z_near = std::max(nearest - slack, 0.5 * nearest);
  camera.z_far = farthest + slack;
  camera.window = w;
  return camera;
}

Result<> validate(const Camera& camera) {
  for (int c = 0; c < 4; ++c)
    for (int r = 0; r < 4; ++r)
      if (!std::isfinite(camera.world_from_eye[c][r]))
        return Error{"camera", "the pose is not finite"};
  const glm::dmat3 axes(camera.world_from_eye);
  const glm::dmat3 gram = glm::transpose(axes) * axes;
  for (int c = 0; c < 3; ++c)
    for (int r = 0; r < 3; ++r)
      if (std::abs(gram[c][r] - (c == r ? 1.0 : 0.0)) > 1e-6)
        return Error{"camera", "the axes are not orthonormal"};
  if (glm::determinant(axes) < 0) return Error{"camera", "the axes are mirrored"};
  const glm::dvec4 last_row{camera.world_from_eye[0][3], camera.world_from_eye[1][3],
                            camera.world_from_eye[2][3], camera.world_from_eye[3][3]};
  if (last_row != glm::dvec4(0, 0, 0, 1)) return Error{"camera", "the pose is not affine"};
  const auto& [l, r, b, t] = camera.window;
  for (double v : {l, r, b, t, camera.z_near, camera.z_far})
    if (!std::isfinite(v)) return Error{"camera", "the frustum is not finite"};
  if (!(std::isfinite(camera.texels_per_pixel) && camera.texels_per_pixel > 0))
    return Error{"camera", "the number of texels of a pixel is not positive"};
  if (!(l < r) || !(b < t)) return Error{"camera", "the image window is empty"};
  if (!(0 < camera.z_near && camera.z_near < camera.z_far))
    return Error{"camera", "z_near and z_far do not satisfy 0 < z_near < z_far"};
  if (camera.width < 1 || camera.height < 1 || camera.width > (1 << 16) ||
      camera.height > (1 << 16))
    return Error{"camera", "the image size is not between 1 and 65536"};
  return Done{};
}

}  // namespace rilievo
