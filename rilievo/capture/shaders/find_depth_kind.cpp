#include "rilievo/capture/shaders/find_depth_kind.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

namespace rilievo {
namespace {

constexpr int kTexels = 64;
constexpr double kFov = 1.4, kTurn = 0.6;  // radians
constexpr int kLeast = 100;                // texels that both must see
// The better kind's median difference, at most that share of the other's.
constexpr double kClear = 0.5;

double median(std::vector<double>& values) {
  const auto middle = values.begin() + std::ptrdiff_t(values.size() / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

// Looks from `eye` along `forward`, turned about the vertical by `angle`.
Camera turned(const glm::dvec3& eye, const glm::dvec3& forward, double angle, double reach) {
  const double c = std::cos(angle), s = std::sin(angle);
  const glm::dvec3 way(c * forward.x + s * forward.z, forward.y, c * forward.z - s * forward.x);
  return look_at(eye, eye + way, {0, 1, 0}, kFov, kTexels, kTexels, 1e-3 * reach, 10 * reach);
}

}  // namespace

DepthKindVotes compare_depth_kinds(const DepthImage& a, const DepthImage& b) {
  std::vector<double> off_eye_z, off_ray;
  for (int y = 0; y < a.camera.height; ++y)
    for (int x = 0; x < a.camera.width; ++x) {
      if (!a.covered(x, y)) continue;
      const glm::dvec3 way = glm::normalize(world_from_raster(a.camera, {x + 0.5, y + 0.5}, 1.0) -
                                            a.camera.position());
      const glm::dvec3 raster = raster_from_world(b.camera, b.camera.position() + way);
      const int u = int(std::floor(raster.x)), v = int(std::floor(raster.y));
      if (!(raster.z > 0) || u < 0 || v < 0 || u >= b.camera.width || v >= b.camera.height)
        continue;
      if (!b.covered(u, v)) continue;
      const double z_a = double(a.depth(x, y)), z_b = double(b.depth(u, v));
      const double ray_a = z_a / glm::dot(way, a.camera.forward());
      const double ray_b = z_b / glm::dot(way, b.camera.forward());
      off_eye_z.push_back(std::abs(ray_a - ray_b) / ray_a);
      off_ray.push_back(std::abs(z_a - z_b) / z_a);
    }
  DepthKindVotes votes;
  votes.texels = int(off_ray.size());
  if (votes.texels < kLeast) return votes;
  votes.off_eye_z = median(off_eye_z), votes.off_ray = median(off_ray);
  if (votes.off_eye_z < kClear * votes.off_ray) votes.kind = DepthKind::eye_z;
  if (votes.off_ray < kClear * votes.off_eye_z) votes.kind = DepthKind::ray;
  return votes;
}

Result<DepthKind> find_depth_kind(CaptureSource& source) {
  const Box bounds = source.bounds({});
  const std::string name(source.name());
  if (bounds.empty()) return Error{name, "shows nothing"};
  const glm::dvec3 center(bounds.center());
  const double reach = std::max(double(bounds.radius()), 1e-6);
  struct View {
    glm::dvec3 eye, forward;
  };
  // Around inside, as a room is seen, then from outside.
  std::vector<View> views;
  for (int side = 0; side < 4; ++side) {
    const double angle = 1.5707963267948966 * side;
    views.push_back({center, {std::sin(angle), 0, -std::cos(angle)}});
  }
  views.push_back({center + glm::dvec3(0, 0, 1.4 * reach), {0, 0, -1}});
  views.push_back({center + glm::dvec3(1.4 * reach, 0, 0), {-1, 0, 0}});
  for (const View& view : views) {
    DepthImage pictures[2];
    for (int i = 0; i < 2; ++i) {
      const Camera camera =
          turned(view.eye, view.forward, i == 0 ? -0.5 * kTurn : 0.5 * kTurn, reach);
      Result<CapturedPicture> captured = source.capture({.camera = camera, .samples = 1});
      if (!captured) return captured.error();
      pictures[i] = std::move(captured->picture);
    }
    const DepthKindVotes votes = compare_depth_kinds(pictures[0], pictures[1]);
    if (votes.kind) return *votes.kind;
  }
  return Error{
      name,
      "shows too little from the middle of its bounds and from outside to tell whether its "
      "depth is along the axis or along the ray: --ray-depth or --axis-depth says it"};
}

}  // namespace rilievo
