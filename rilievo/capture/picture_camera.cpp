#include "rilievo/capture/picture_camera.h"

#include <algorithm>
#include <cmath>

namespace rilievo {

std::optional<Camera> picture_camera(const Camera& frame, const Box& bounds,
                                     const PictureCameraOptions& options) {
  if (bounds.empty() || frame.projection != Projection::perspective) return std::nullopt;
  const glm::dvec3 eye = frame.position();
  const glm::dvec3 nearest =
      glm::clamp(eye, glm::dvec3(bounds.min), glm::dvec3(bounds.max));  // of the box to the eye
  const double distance = glm::length(nearest - eye);
  if (distance < options.min_front * 2 * bounds.radius() || distance <= 0) return std::nullopt;

  const glm::dvec3 up(frame.world_from_eye[1]);
  Result<Camera> made = tight_camera(Projection::perspective, eye, up, bounds);
  if (!made) return std::nullopt;
  Camera camera = *made;

  // A pixel at the angle t from the frame's axis is narrower, as an angle, than one on it: by cos^2
  // t outwards, by cos t across. Take the worst over the part of the bounds that the frame can
  // show.
  const double axis = glm::dot(frame.forward(), camera.forward());
  const double radius = std::asin(
      std::min(1.0, double(bounds.radius()) / glm::length(glm::dvec3(bounds.center()) - eye)));
  const double corner_x = std::max(std::abs(frame.window.left), std::abs(frame.window.right));
  const double corner_y = std::max(std::abs(frame.window.bottom), std::abs(frame.window.top));
  const double corner = std::atan(std::hypot(corner_x, corner_y));
  const double off_axis = std::min(std::acos(std::clamp(axis, -1.0, 1.0)) + radius, corner);
  const double pixel =
      (frame.window.right - frame.window.left) / frame.width * std::pow(std::cos(off_axis), 2);
  // On the picture's own plane z = -1 a texel's angle shrinks outwards too, so the step of the
  // centre is the largest.
  const double texel = pixel / options.texels_per_pixel;

  auto& [l, r, b, t] = camera.window;
  const int width = int(std::ceil((r - l) / texel)) + 2,
            height = int(std::ceil((t - b) / texel)) + 2;
  if (width > options.max_size || height > options.max_size) return std::nullopt;
  const auto widen = [](double& low, double& high, int size) {
    const double border = (high - low) / (size - 2);
    low -= border;
    high += border;
  };
  widen(l, r, width);
  widen(b, t, height);
  camera.width = width;
  camera.height = height;
  return camera;
}

void align_to_texels(double origin, double step, double& from, double& to, int& texels) {
  const double first = std::floor((from - origin) / step), last = std::ceil((to - origin) / step);
  texels = std::max(1, int(last - first));
  from = origin + first * step;
  to = from + texels * step;
}

}  // namespace rilievo
