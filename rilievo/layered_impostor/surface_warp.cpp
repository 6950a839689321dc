
#include <algorithm>
#include <array>
#include <cmath>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/layered_impostor/pixel_march.h"
#include "rilievo/layered_impostor/slice_quads.h"
#include "rilievo/layered_impostor/warp.h"

namespace rilievo {
namespace {

// Colour between the texels that are linked to the one that was hit.
glm::vec4 color_at(const DepthImage& picture, const TexelSurface& surface, const SurfaceHit& hit) {
  const glm::ivec2 texel = hit.texel;
  const SampleWeights weights = sample_weights(surface.texels(texel.x, texel.y),
                                               glm::dvec2(hit.at) - (glm::dvec2(texel) + 0.5));
  return interpolate(weights, texel,
                     [&](const glm::ivec2& at) { return picture.color(at.x, at.y); });
}

struct Seen {
  float eye_z = kNoDepth;
  glm::vec4 color{0.0f};
  std::uint32_t object = kNoObject;
};

Seen what_is_seen(const LayeredImpostor& impostor, int view, const PixelRay& ray,
                  const SurfaceHit& march) {
  const DepthImage& picture = impostor.pictures[view];
  const glm::dvec3 world = world_from_raster(picture.camera, glm::dvec2(march.at), 1 / march.at.z);
  return {
      float(glm::dot(world - ray.origin, ray.direction) / glm::dot(ray.direction, ray.direction)),
      color_at(picture, impostor.surfaces[view], march),
      picture.object.empty() ? 1 : picture.object(march.texel.x, march.texel.y)};
}

// Those with weight, then the others, those first that look along the ray.
std::array<int, ServingViews::kMaxCount> in_order(const LayeredImpostor& impostor,
                                                  const ServingViews& serving,
                                                  const PixelRay& ray) {
  std::array<int, ServingViews::kMaxCount> views{};
  std::copy_n(serving.views, serving.count, views.begin());
  std::stable_sort(views.begin() + serving.weighted, views.begin() + serving.count,
                   [&](int a, int b) {
                     return looks_along(impostor.pictures[std::size_t(a)].camera, ray) >
                            looks_along(impostor.pictures[std::size_t(b)].camera, ray);
                   });
  return views;
}

}  // namespace

RayBounds::RayBounds(const Box& bounds) {
  const glm::dvec3 slack(1e-4 * double(bounds.radius()) + 1e-9);
  low_ = glm::dvec3(bounds.min) - slack, high_ = glm::dvec3(bounds.max) + slack;
}

bool RayBounds::keep(PixelRay& ray) const {
  for (int a = 0; a < 3; ++a) {
    const double t0 = (low_[a] - ray.origin[a]) / ray.direction[a];
    const double t1 = (high_[a] - ray.origin[a]) / ray.direction[a];
    if (std::isnan(t0) || std::isnan(t1)) continue;  // along a face
    ray.begin = std::max(ray.begin, std::min(t0, t1));
    ray.end = std::min(ray.end, std::max(t0, t1));
  }
  return ray.begin < ray.end;
}

double looks_along(const Camera& picture, const PixelRay& ray) {
  const glm::dvec3 middle = ray.origin + 0.5 * (ray.begin + ray.end) * ray.direction;
  const glm::dvec3 from = middle - picture.position();
  const double along = glm::dot(from, ray.direction) / glm::length(from);
  return picture.keeps_farthest() ? -along : along;
}

std::optional<PixelRay> pixel_ray(const Box& bounds, const Camera& camera,
                                  const glm::dvec2& raster) {
  PixelRay ray;
  ray.origin = camera.position();
  ray.direction = world_from_raster(camera, raster, 1.0) - ray.origin;
  ray.begin = camera.z_near;
  ray.end = camera.z_far;
  if (!RayBounds(bounds).keep(ray)) return std::nullopt;
  return ray;
}

SurfaceHit march_picture(const LayeredImpostor& impostor, int view, const PixelRay& ray) {
  const std::optional<DisparitySegment> segment =
      disparity_segment(impostor.pictures[view].camera, ray.origin + ray.begin * ray.direction,
                        ray.origin + ray.end * ray.direction);
  return segment ? intersect(impostor.surfaces[view], *segment) : SurfaceHit{};
}

DepthImage warp_surfaces(const LayeredImpostor& impostor, const Camera& camera,
                         const SurfaceWarpOptions& options) {
  RILIEVO_EXPECTS(camera.projection == Projection::perspective);
  RILIEVO_EXPECTS(options.max_views >= 1 && options.max_views <= kMaxViewsAsked);
  const ServingViews serving = views_for_eye(
      impostor, camera.position(), {.max_views = options.max_views, .handover = options.handover});
  const std::size_t weighted = std::size_t(serving.weighted), asked = std::size_t(serving.asked);

  DepthImage frame;
  frame.camera = camera;
  frame.color = ColorImage(camera.width, camera.height);
  frame.depth = Image<float>(camera.width, camera.height, kNoDepth);
  frame.object = Image<std::uint32_t>(camera.width, camera.height, kNoObject);
  parallel_for(0, camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x) {
      const std::optional<PixelRay> ray = pixel_ray(impostor.bounds, camera, {x + 0.5, y + 0.5});
      if (!ray) continue;
      Seen certain, doubtful, skin;
      int inside = 0;
      bool sees_through = false;
      float surface = 0, nothing = 0, heaviest = 0;
      glm::vec4 blended(0.0f);
      const std::array<int, ServingViews::kMaxCount> views = in_order(impostor, serving, *ray);
      for (std::size_t i = 0; i < asked; ++i) {
        if (i >= weighted && surface + nothing > 0) break;
        const float weight = i < weighted ? serving.weights[i] : 1.0f;
        const SurfaceHit march = march_picture(impostor, views[i], *ray);
        if (march.hit) {
          const Seen seen = what_is_seen(impostor, views[i], *ray, march);
          if (seen.eye_z < doubtful.eye_z) doubtful = seen;
          if (march.passed_behind) continue;
          surface += weight;
          blended += weight * seen.color;
          if (weight > heaviest) heaviest = weight, certain = seen;
        } else if (!march.passed_behind) {
          if (impostor.complete[std::size_t(views[i])]) nothing += weight;
          sees_through |= impostor.sees_through[std::size_t(views[i])];
        } else {
          inside += march.passed_outline ? -1 : 1;
          if (!march.passed_outline && skin.eye_z == kNoDepth)
            skin = what_is_seen(impostor, views[i], *ray, march);
        }
      }
      if (nothing > surface || (surface == 0 && sees_through)) continue;
      if (doubtful.eye_z == kNoDepth && inside > 0 && asked > 1) doubtful = skin;
      const Seen& shown = surface > 0 ? certain : doubtful;
      if (shown.eye_z == kNoDepth) continue;
      frame.depth(x, y) = shown.eye_z;
      frame.color(x, y) = surface > 0 ? blended / surface : shown.color;
      frame.object(x, y) = shown.object;
    }
  });
  return frame;
}

}  // namespace rilievo
