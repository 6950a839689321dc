#include "rilievo/layered_relief/sample_coverage.h"

#include <algorithm>
#include <cmath>

namespace rilievo {

Placing::Placing(const LayeredDepthImage& to)
    : to_(to), eye_from_world_(eye_from_world(to.camera)) {
  const Camera& camera = to.camera;
  const auto& [l, r, b, t] = camera.window;
  const double across = camera.width / (r - l), down = camera.height / (t - b);
  // Of a parallel picture a depth is a distance, or a share of that from z_near to z_far.
  const bool share = to.depth_kind == DepthKind::window_z;
  const double per_metre = share ? 1 / (camera.z_far - camera.z_near) : 1.0;
  const glm::dmat4 about_from_eye(
      {across, 0, 0, 0}, {0, -down, 0, 0}, {0, 0, -per_metre, 0},
      {-l * across, t * down, share ? -camera.z_near * per_metre : 0.0, 1});
  about_from_world_ = about_from_eye * eye_from_world_;
}

std::optional<PlacedIn> Placing::find(const glm::dvec3& world) const {
  const Camera& camera = to_.camera;
  const glm::dvec3 eye(eye_from_world_ * glm::dvec4(world, 1));
  const auto& [l, r, b, t] = camera.window;
  const double at_x = (eye.x - l) / (r - l) * camera.width;
  const double at_y = (t - eye.y) / (t - b) * camera.height;
  // Faces of the box around everything lie on the picture's very edge.
  constexpr double kRounding = 1e-3;
  if (!(at_x >= -kRounding && at_x <= camera.width + kRounding)) return std::nullopt;
  if (!(at_y >= -kRounding && at_y <= camera.height + kRounding)) return std::nullopt;
  const auto x = std::size_t(std::clamp(at_x, 0.0, camera.width - 0.5));
  const auto y = std::size_t(std::clamp(at_y, 0.0, camera.height - 0.5));
  return PlacedIn{{at_x, at_y},
                  y * std::size_t(camera.width) + x,
                  depth_from_eye_z(to_.depth_kind, -eye.z, camera,
                                   glm::dvec2(double(x) + 0.5, double(y) + 0.5))};
}

SampleCoverage::SampleCoverage(const LayeredDepthImage& layers, double reach)
    : layers_(layers), reach_(reach), added_(layers.first.size() - 1) {
  const Camera& camera = layers.camera;
  per_metre_ = layers.depth_kind == DepthKind::window_z ? 1 / (camera.z_far - camera.z_near) : 1.0;
  metres_ = 1 / per_metre_;
  texel_ = {(camera.window.right - camera.window.left) / camera.width,
            (camera.window.top - camera.window.bottom) / camera.height};
  around_ = int(std::ceil(reach / std::min(texel_.x, texel_.y) - 1e-9));
  own_.reserve(layers.samples.size());
  for (const LayerSample& sample : layers.samples) own_.push_back(sample.depth);
}

void SampleCoverage::add(std::size_t line, float depth) {
  std::vector<float>& depths = added_[line];
  depths.insert(std::upper_bound(depths.begin(), depths.end(), depth), depth);
}

// Looked for first where the last place had one, which is mostly beside this one, then in the line
// of sight through the place, which has most of them.
bool SampleCoverage::covers(const glm::dvec3& place) {
  const Camera& camera = layers_.camera;
  const int x0 = std::clamp(int(place.x), 0, camera.width - 1);
  const int y0 = std::clamp(int(place.y), 0, camera.height - 1);
  // The farthest along a line of sight, squared; negative: none.
  const auto left = [&](int x, int y) {
    const double across = (x + 0.5 - place.x) * texel_.x, up = (y + 0.5 - place.y) * texel_.y;
    return reach_ * reach_ - (across * across + up * up);
  };
  const double deeper = (double(last_.depth) - place.z) * metres_;
  if (deeper * deeper <= left(last_.x, last_.y)) return true;
  const auto has_one = [&](int x, int y) {
    const double squared = left(x, y);
    if (squared < 0) return false;
    const double along = std::sqrt(squared) * per_metre_;
    const auto is_among = [&](const float* begin, const float* end) {
      const float* const near = std::partition_point(
          begin, end, [&](float depth) { return double(depth) - place.z < -along; });
      if (near == end || double(*near) - place.z > along) return false;
      last_ = {x, y, *near};
      return true;
    };
    const std::size_t line = std::size_t(y) * std::size_t(camera.width) + std::size_t(x);
    const std::vector<float>& added = added_[line];
    return is_among(own_.data() + layers_.first[line], own_.data() + layers_.first[line + 1]) ||
           is_among(added.data(), added.data() + added.size());
  };
  if (has_one(x0, y0)) return true;
  for (int y = std::max(y0 - around_, 0); y <= std::min(y0 + around_, camera.height - 1); ++y)
    for (int x = std::max(x0 - around_, 0); x <= std::min(x0 + around_, camera.width - 1); ++x)
      if ((x != x0 || y != y0) && has_one(x, y)) return true;
  return false;
}

}  // namespace rilievo
