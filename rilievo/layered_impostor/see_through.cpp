#include "rilievo/layered_impostor/see_through.h"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

constexpr int kSampleLines = 64;  // in u and in v
// Outlines differ by a texel or two from picture to picture, and thin things come and go.
constexpr int kNear = 2;
// Of a neighbour's samples. Closed bodies have none; of the pictures that look along a lawn, the
// one that sees least of its back has 0.0035.
constexpr double kLeastShare = 0.002;

struct SurfaceSample {
  glm::dvec3 at{0.0}, normal{0.0};  // the normal points to the picture's viewers; any length
};

// From a point towards the viewers who see it along the picture's line of sight.
glm::dvec3 towards_viewers(const Camera& camera, const glm::dvec3& at) {
  return camera.keeps_farthest() ? at - camera.position() : camera.position() - at;
}

std::vector<SurfaceSample> samples_of(const TexelSurface& surface) {
  const int w = surface.texels.width(), h = surface.texels.height();
  const int stride = std::max(1, (std::max(w, h) + kSampleLines - 1) / kSampleLines);
  std::vector<SurfaceSample> samples;
  for (int y = stride / 2; y < h; y += stride)
    for (int x = stride / 2; x < w; x += stride) {
      const SurfaceTexel& texel = surface.texels(x, y);
      if (texel.q == 0) continue;
      const glm::dvec2 center(x + 0.5, y + 0.5);
      const auto point = [&](double du, double dv) {
        const glm::dvec2 at = center + glm::dvec2(du, dv);
        return world_from_raster(surface.camera, at, 1 / surface_q(texel, center, at));
      };
      SurfaceSample sample;
      sample.at = point(0, 0);
      sample.normal = glm::cross(point(0.5, 0) - point(-0.5, 0), point(0, 0.5) - point(0, -0.5));
      if (glm::dot(sample.normal, towards_viewers(surface.camera, sample.at)) < 0)
        sample.normal = -sample.normal;
      samples.push_back(sample);
    }
  return samples;
}

bool is_empty_around(const TexelSurface& surface, const glm::dvec3& world) {
  const glm::dvec3 at = raster_from_world(surface.camera, world);
  const int w = surface.texels.width(), h = surface.texels.height();
  if (!(at.z > 0 && at.x >= kNear && at.y >= kNear && at.x < w - kNear && at.y < h - kNear))
    return false;
  const int x = int(at.x), y = int(at.y);
  for (int v = y - kNear; v <= y + kNear; ++v)
    for (int u = x - kNear; u <= x + kNear; ++u)
      if (surface.texels(u, v).q != 0) return false;
  return true;
}

bool sees_through(const TexelSurface& surface, std::span<const SurfaceSample> shown) {
  std::size_t behind = 0, in_front = 0;
  for (const SurfaceSample& sample : shown) {
    if (!is_empty_around(surface, sample.at)) continue;
    const bool back = glm::dot(sample.normal, towards_viewers(surface.camera, sample.at)) < 0;
    ++(back ? behind : in_front);
  }
  return double(behind) > kLeastShare * double(shown.size()) && behind > in_front;
}

}  // namespace

std::vector<bool> find_seeing_through(const ViewSet& views,
                                      std::span<const TexelSurface> surfaces) {
  std::vector<std::vector<SurfaceSample>> samples(surfaces.size());
  parallel_for(std::size_t(0), surfaces.size(),
               [&](std::size_t i) { samples[i] = samples_of(surfaces[i]); });
  std::vector<char> found(surfaces.size());  // one byte each: threads write beside each other
  parallel_for(std::size_t(0), surfaces.size(), [&](std::size_t i) {
    for (const auto& [a, b] : views.edges)
      if (a == int(i) || b == int(i)) {
        const int neighbor = a == int(i) ? b : a;
        if (sees_through(surfaces[i], samples[std::size_t(neighbor)])) found[i] = 1;
      }
  });
  return {found.begin(), found.end()};
}

}  // namespace rilievo
