#include "rilievo/layered_relief/merge_layers.h"

#include <span>
#include <utility>

namespace rilievo {
namespace {

// Calls add(samples of a line of sight, out) for each of them and puts the index together.
template <class Add>
LayeredDepthImage rebuilt(const LayeredDepthImage& layers, Add&& add) {
  LayeredDepthImage out;
  out.name = layers.name;
  out.camera = layers.camera;
  out.depth_kind = layers.depth_kind;
  out.first.reserve(layers.first.size());
  out.first.push_back(0);
  for (std::size_t i = 0; i + 1 < layers.first.size(); ++i) {
    const std::size_t from = layers.first[i], to = layers.first[i + 1];
    add(std::span(layers.samples).subspan(from, to - from), out.samples);
    out.first.push_back(out.samples.size());
  }
  return out;
}

}  // namespace

LayeredDepthImage merge_layers(const LayeredDepthImage& layers, double tolerance) {
  return rebuilt(layers, [&](std::span<const LayerSample> line, std::vector<LayerSample>& out) {
    double kept = 0;
    bool any = false;
    for (const LayerSample& sample : line) {
      if (any && double(sample.depth) - kept <= tolerance) continue;
      out.push_back(sample);
      kept = double(sample.depth);
      any = true;
    }
  });
}

LayeredDepthImage gather_layers(const LayeredDepthImage& layers, float least_alpha) {
  return rebuilt(layers, [&](std::span<const LayerSample> line, std::vector<LayerSample>& out) {
    LayerSample sum;
    float most = 0;
    for (const LayerSample& sample : line) {
      const float open = 1 - sum.color.a, share = open * sample.color.a;
      if (share <= 0) continue;
      if (share > most) {
        most = share;
        sum.depth = sum.back = sample.depth;
        sum.object = sample.object;
      }
      sum.color += open * sample.color;
      if (sum.color.a < least_alpha) continue;
      sum.color /= sum.color.a;
      out.push_back(sum);
      sum = {};
      most = 0;
    }
  });
}

}  // namespace rilievo
