#include "rilievo/layered_relief/resample_layers.h"

#include <fmt/format.h>

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

// The texels [min, max) of a parallel camera whose centres lie within the square; the nearest one
// if none does.
struct SquareTexels {
  glm::ivec2 min{0}, max{0};
};
SquareTexels texels_within(const Square& square, const Camera& camera, double step) {
  const glm::dvec2 corner(camera.window.left, camera.window.top), down(1, -1);
  const glm::dvec2 from = down * (glm::dvec2(square.min.x, square.max.y) - corner) / step,
                   to = down * (glm::dvec2(square.max.x, square.min.y) - corner) / step;
  SquareTexels texels{glm::ivec2(glm::ceil(from - 0.5)), glm::ivec2(glm::ceil(to - 0.5))};
  for (const int k : {0, 1})
    if (texels.min[k] >= texels.max[k])
      texels.min[k] = int(std::floor(0.5 * (from[k] + to[k]))), texels.max[k] = texels.min[k] + 1;
  return {glm::max(texels.min, 0), glm::min(texels.max, glm::ivec2(camera.width, camera.height))};
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

  // What is far, or seen by few texels, becomes many samples each.
  double samples = 0;
  each_square(layers, options, [&](const Square& square, const LayerSample&) {
    const SquareTexels texels = texels_within(square, camera, step);
    const glm::dvec2 extent(glm::max(texels.max - texels.min, 0));
    samples += extent.x * extent.y;
  });
  if (samples > double(options.max_samples))
    return Error{layers.name, fmt::format("would become {:.0f} samples, more than {}: take a "
                                          "smaller --size, or leave out what is far (--max-depth)",
                                          samples, options.max_samples)};

  std::vector<std::vector<LayerSample>> lines(std::size_t(camera.width) *
                                              std::size_t(camera.height));
  each_square(layers, options, [&](const Square& square, const LayerSample& given) {
    LayerSample sample = given;
    sample.depth = sample.back = float(square.z);
    const SquareTexels texels = texels_within(square, camera, step);
    for (int y = texels.min.y; y < texels.max.y; ++y)
      for (int x = texels.min.x; x < texels.max.x; ++x)
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
