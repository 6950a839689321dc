#include "rilievo/core/depth.h"

#include <algorithm>
#include <cmath>

namespace rilievo {
namespace {

// Length of the texel's ray per unit of eye_z.
double ray_per_eye_z(const Camera& camera, const glm::dvec2& raster) {
  if (camera.projection == Projection::parallel) return 1.0;
  const auto& [l, r, b, t] = camera.window;
  const double x = l + raster.x / camera.width * (r - l);
  const double y = t - raster.y / camera.height * (t - b);
  return std::sqrt(x * x + y * y + 1.0);
}

}  // namespace

double eye_z_from(DepthKind kind, double depth, const Camera& camera, const glm::dvec2& raster) {
  if (std::isinf(depth)) return depth;
  const double n = camera.z_near, f = camera.z_far;
  switch (kind) {
    case DepthKind::eye_z:
      return depth;
    case DepthKind::ray:
      return depth / ray_per_eye_z(camera, raster);
    case DepthKind::window_z:
      if (camera.projection == Projection::parallel) return n + depth * (f - n);
      return f * n / (f - depth * (f - n));
  }
  return kNoDepth;
}

double depth_from_eye_z(DepthKind kind, double eye_z, const Camera& camera,
                        const glm::dvec2& raster) {
  if (std::isinf(eye_z)) return eye_z;
  const double n = camera.z_near, f = camera.z_far;
  switch (kind) {
    case DepthKind::eye_z:
      return eye_z;
    case DepthKind::ray:
      return eye_z * ray_per_eye_z(camera, raster);
    case DepthKind::window_z:
      if (camera.projection == Projection::parallel) return (eye_z - n) / (f - n);
      return f * (eye_z - n) / (eye_z * (f - n));
  }
  return kNoDepth;
}

std::uint32_t encode_delta(float window_z, int bits) {
  RILIEVO_EXPECTS(2 <= bits && bits <= 16);
  const float steps = float(delta_steps(bits));
  return std::uint32_t(std::floor(std::clamp(window_z, 0.0f, 1.0f) * steps + 0.5f));
}

float decode_delta(std::uint32_t code, int bits) {
  RILIEVO_EXPECTS_LT(code, delta_transparent(bits));
  return float(code) / float(delta_steps(bits));
}

}  // namespace rilievo
