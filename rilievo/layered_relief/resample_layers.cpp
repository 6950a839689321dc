#include "rilievo/layered_relief/resample_layers.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace rilievo {
namespace {

// A sample's square, in the eye space that both cameras share: x right, y up, metres.
struct Square {
  glm::dvec2 min{0.0}, max{0.0};
  double z = 0;
};

// Calls visit(square, sample) for the samples that are wanted.
template <class Visit>
void each_square(const LayeredDepthImage& layers, const ResampleOptions& options, Visit&& visit) {
  const Camera& camera = layers.camera;
  const auto& [l, r, b, t] = camera.window;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const std::size_t i = std::size_t(y) * std::size_t(camera.width) + std::size_t(x);
      for (std::uint64_t s = layers.first[i]; s < layers.first[i + 1]; ++s) {
        const LayerSample& sample = layers.samples[s];
        const double z = eye_z_from(layers.depth_kind, sample.depth, camera, {x + 0.5, y + 0.5});
        if (!(z > 0) || z > options.max_z) continue;
        const double left = l + (r - l) * x / camera.width, top = t - (t - b) * y / camera.height;
        const double right = l + (r - l) * (x + 1) / camera.width;
        const double bottom = t - (t - b) * (y + 1) / camera.height;
        visit(Square{glm::dvec2(left, bottom) * z, glm::dvec2(right, top) * z, z}, sample);
      }
    }
}

}  // namespace

Result<ResampledLayers> resample_layers(const LayeredDepthImage& layers,
                                        const ResampleOptions& options) {
  RILIEVO_EXPECTS(layers.camera.projection == Projection::perspective && options.size >= 1);
  glm::dvec2 low(1e300), high(-1e300);
  double nearest = 1e300, farthest = 0, largest = 0;
  each_square(layers, options, [&](const Square& square, const LayerSample&) {
    low = glm::min(low, square.min), high = glm::max(high, square.max);
    nearest = std::min(nearest, square.z), farthest = std::max(farthest, square.z);
    largest = std::max(largest, glm::distance(square.min, square.max));
  });
  if (!(farthest > 0)) return Error{layers.name, "has no samples to be resampled"};

  ResampledLayers out;
  out.layers.name = layers.name;
  Camera& camera = out.layers.camera;
  camera = layers.camera;
  camera.projection = Projection::parallel;
  const double step = std::max(high.x - low.x, high.y - low.y) / options.size;
  camera.width = std::clamp(int(std::ceil((high.x - low.x) / step - 1e-9)), 1, options.size);
  camera.height = std::clamp(int(std::ceil((high.y - low.y) / step - 1e-9)), 1, options.size);
  camera.window = {low.x, low.x + step * camera.width, high.y - step * camera.height, high.y};
  camera.z_near = 0.999 * nearest;
  camera.z_far = 1.001 * farthest;
  // A parallel line of sight shows what was seen up to half a square's diagonal beside it, or, if
  // it is only the nearest one, up to half a texel's.
  out.error = 0.5 * std::max(largest, std::sqrt(2.0) * step);

  std::vector<std::vector<LayerSample>> lines(std::size_t(camera.width) *
                                              std::size_t(camera.height));
  each_square(layers, options, [&](const Square& square, const LayerSample& given) {
    LayerSample sample = given;
    sample.depth = sample.back = float(square.z);
    // Texels whose centres lie within.
    const auto first = [](double from) { return int(std::ceil(from - 0.5)); };
    int x0 = first((square.min.x - camera.window.left) / step);
    int x1 = first((square.max.x - camera.window.left) / step);
    int y0 = first((camera.window.top - square.max.y) / step);
    int y1 = first((camera.window.top - square.min.y) / step);
    const glm::dvec2 middle = 0.5 * (square.min + square.max);
    if (x0 >= x1) x0 = int(std::floor((middle.x - camera.window.left) / step)), x1 = x0 + 1;
    if (y0 >= y1) y0 = int(std::floor((camera.window.top - middle.y) / step)), y1 = y0 + 1;
    for (int y = std::max(y0, 0); y < std::min(y1, camera.height); ++y)
      for (int x = std::max(x0, 0); x < std::min(x1, camera.width); ++x)
        lines[std::size_t(y) * std::size_t(camera.width) + std::size_t(x)].push_back(sample);
  });
  out.layers.first.push_back(0);
  for (std::vector<LayerSample>& line : lines) {
    std::stable_sort(line.begin(), line.end(),
                     [](const LayerSample& a, const LayerSample& b) { return a.depth < b.depth; });
    out.layers.samples.insert(out.layers.samples.end(), line.begin(), line.end());
    out.layers.first.push_back(out.layers.samples.size());
  }
  return out;
}

}  // namespace rilievo
