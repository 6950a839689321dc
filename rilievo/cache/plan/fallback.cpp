#include "rilievo/cache/plan/fallback.h"

#include <algorithm>
#include <cmath>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

// Of `texels` side by side in [low, high], keeps those that touch [from, to], and one on each side.
void keep_texels(double from, double to, double& low, double& high, int& texels) {
  const double texel = (high - low) / texels;
  const auto place = [&](double x) { return std::clamp((x - low) / texel, 0.0, double(texels)); };
  const int first = std::max(0, int(std::floor(place(from))) - 1);
  const int end = std::max(first + 1, std::min(texels, int(std::ceil(place(to))) + 1));
  if (end < texels) high = low + end * texel;
  if (first > 0) low += first * texel;
  texels = end - first;
}

}  // namespace

double fallback_scale(const ViewAxes& view, double pixels, double budget, double coarsest,
                      const CacheOptions& options) {
  const double all = double(view.camera.width) * view.camera.height;
  const double at_full_scale = options.cost.fallback_texel * std::max(1.0, std::min(pixels, all));
  const double scale = std::clamp(std::sqrt(std::max(0.0, budget) / at_full_scale), coarsest, 1.0);
  return std::min(scale,
                  double(options.max_texels) / std::max(view.camera.width, view.camera.height));
}

PictureGeometry fallback_geometry(const ViewAxes& view, std::span<const Box> boxes, double scale,
                                  const CacheOptions& options) {
  RILIEVO_EXPECTS(!boxes.empty());
  const glm::dvec3 forward = view.forward;
  double front = view.camera.z_far, back = view.camera.z_near;
  for (const Box& box : boxes) {
    const double middle = glm::dot(glm::dvec3(box.center()) - view.eye, forward);
    const double reach = 0.5 * glm::dot(glm::dvec3(box.extent()), glm::abs(forward));
    front = std::min(front, middle - reach), back = std::max(back, middle + reach);
  }
  Camera camera = view.camera;
  camera.width = std::max(1, int(std::ceil(scale * camera.width)));
  camera.height = std::max(1, int(std::ceil(scale * camera.height)));
  ImageWindow around{INFINITY, -INFINITY, INFINITY, -INFINITY};
  for (const Box& box : boxes) {
    const ImageWindow one = covered_window(view, box);
    around = {std::min(around.left, one.left), std::max(around.right, one.right),
              std::min(around.bottom, one.bottom), std::max(around.top, one.top)};
  }
  ImageWindow& window = camera.window;
  keep_texels(around.left, around.right, window.left, window.right, camera.width);
  keep_texels(around.bottom, around.top, window.bottom, window.top, camera.height);
  // Surfaces that touch a box must not be clipped by rounding.
  const double slack = 1e-4 * std::max(back - front, 1e-3 * std::abs(back));
  camera.z_near = std::max(camera.z_near, front - slack);
  camera.z_far = std::max(back + slack, camera.z_near * 1.001);
  PictureGeometry geometry = picture_geometry(camera);
  geometry.delta_bits = options.fallback_bits;
  geometry.depth_mode = options.depth_mode;
  return geometry;
}

}  // namespace rilievo
