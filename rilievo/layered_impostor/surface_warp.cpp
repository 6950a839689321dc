
#include <algorithm>
#include <cmath>
#include <vector>

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

std::optional<DisparitySegment> segment_over(const Camera& picture, const PixelRay& ray) {
  return disparity_segment(picture, ray.origin + ray.begin * ray.direction,
                           ray.origin + ray.end * ray.direction);
}

struct Seen {
  float eye_z = kNoDepth;
  glm::vec4 color{0.0f};
  std::uint32_t object = kNoObject;
};

// What a view says of a ray. Depths are t of the ray.
struct Answer {
  bool hit = false, certain = false, outline = false, empty = false;
  Seen seen;                                  // of a hit, or of a skin
  double behind_from = 1e300, behind_to = 0;  // if it is not certain
};

Answer ask(const LayeredImpostor& impostor, int view, const PixelRay& ray) {
  const SurfaceHit march = march_picture(impostor, view, ray);
  const DepthImage& picture = impostor.pictures[std::size_t(view)];
  const auto ray_t = [&](const glm::dvec3& at) {
    const glm::dvec3 world = world_from_raster(picture.camera, glm::dvec2(at), 1 / at.z);
    return glm::dot(world - ray.origin, ray.direction) / glm::dot(ray.direction, ray.direction);
  };
  Answer answer;
  answer.hit = march.hit, answer.certain = !march.passed_behind;
  answer.outline = march.passed_outline;
  answer.empty = !march.hit && impostor.complete[std::size_t(view)];
  if (march.hit || (march.passed_behind && !march.passed_outline))
    answer.seen = {float(ray_t(march.at)),
                   color_at(picture, impostor.surfaces[std::size_t(view)], march),
                   picture.object.empty() ? 1 : picture.object(march.texel.x, march.texel.y)};
  if (march.passed_behind) {
    const DisparitySegment segment = *segment_over(picture.camera, ray);
    const auto at = [&](double t) { return ray_t(glm::mix(segment.from, segment.to, t)); };
    answer.behind_from = at(march.behind_from);
    answer.behind_to = march.behind_to < 1 ? at(march.behind_to) : 1e300;
  }
  return answer;
}

// What a pixel shows, as its views answer.
class Shown {
 public:
  // Of a view with weight, or of one of the others.
  void add(const Answer& answer, float weight) {
    if (answer.certain) {
      decide(answer, weight);
    } else {
      if (answer.hit && answer.seen.eye_z < doubtful_.eye_z) doubtful_ = answer.seen;
      if (!answer.hit) {
        inside_ += answer.outline ? -1 : 1;
        if (!answer.outline && skin_.eye_z == kNoDepth) skin_ = answer.seen;
      }
      free_to_ = std::max(free_to_, answer.behind_from);
      if ((answer.hit || answer.empty) && answer.behind_to < beyond_.behind_to) beyond_ = answer;
    }
  }
  // What the views together are certain of.
  void join() {
    if (!decided() && beyond_.behind_to <= free_to_) decide(beyond_, missing());
  }
  [[nodiscard]] float missing() const { return kSureWeight - surface_ - nothing_; }
  // But for rounding, where the last view has all that lacked.
  [[nodiscard]] bool decided() const { return missing() <= 1e-3f * kSureWeight; }
  [[nodiscard]] bool some_certain() const { return surface_ + nothing_ > 0; }

  // Where nobody is certain.
  [[nodiscard]] Seen guess(bool sees_through, bool several) const {
    if (sees_through) return {};
    return doubtful_.eye_z == kNoDepth && inside_ > 0 && several ? skin_ : doubtful_;
  }
  [[nodiscard]] Seen certain() const {
    if (nothing_ > surface_) return {};
    Seen seen = certain_;
    seen.color = blended_ / surface_;
    return seen;
  }

 private:
  void decide(const Answer& answer, float weight) {
    if (answer.empty) nothing_ += weight;
    if (!answer.hit) return;
    surface_ += weight;
    blended_ += weight * answer.seen.color;
    if (weight > heaviest_) heaviest_ = weight, certain_ = answer.seen;
  }

  Seen certain_, doubtful_, skin_;
  Answer beyond_{.behind_to = 1e300};
  double free_to_ = 0;
  int inside_ = 0;
  float surface_ = 0, nothing_ = 0, heaviest_ = 0;
  glm::vec4 blended_{0.0f};
};

Seen look(const LayeredImpostor& impostor, const ServingViews& serving, const PixelRay& ray) {
  const auto along = [&](int view) {
    return looks_along(impostor.pictures[std::size_t(view)].camera, ray);
  };
  Shown shown;
  bool sees_through = false;
  double known_along = -1e300;
  const auto ask_view = [&](int view, float weight) {
    const Answer answer = ask(impostor, view, ray);
    shown.add(answer, weight);
    const bool passed = answer.certain && !answer.hit;
    sees_through |= passed && impostor.sees_through[std::size_t(view)];
    return answer.certain && (answer.hit || answer.empty);
  };
  for (int i = 0; i < serving.weighted; ++i)
    if (ask_view(serving.views[i], serving.weights[i]))
      known_along = std::max(known_along, along(serving.views[i]));
  shown.join();
  std::vector<int> others(serving.views + serving.weighted, serving.views + serving.count);
  std::ranges::stable_sort(others, [&](int a, int b) { return along(a) > along(b); });
  for (int i = 0; i < serving.asked - serving.weighted; ++i) {
    const int view = others[std::size_t(i)];
    if (shown.decided() || along(view) < known_along) break;
    ask_view(view, shown.missing());
    shown.join();
  }
  return shown.some_certain() ? shown.certain() : shown.guess(sees_through, serving.asked > 1);
}

}  // namespace

RayBounds::RayBounds(const Box& bounds) {
  const glm::dvec3 slack(1e-4 * double(bounds.radius()) + 1e-9);
  low_ = glm::dvec3(bounds.min) - slack, high_ = glm::dvec3(bounds.max) + slack;
}

bool RayBounds::keep(PixelRay& ray) const {
  double first = 0, last = 1e300;
  for (int a = 0; a < 3; ++a) {
    const double t0 = (low_[a] - ray.origin[a]) / ray.direction[a];
    const double t1 = (high_[a] - ray.origin[a]) / ray.direction[a];
    if (std::isnan(t0) || std::isnan(t1)) continue;  // along a face
    first = std::max(first, std::min(t0, t1)), last = std::min(last, std::max(t0, t1));
  }
  ray.middle = 0.5 * (first + last);
  ray.begin = std::max(ray.begin, first), ray.end = std::min(ray.end, last);
  return ray.begin < ray.end;
}

double looks_along(const Camera& picture, const PixelRay& ray) {
  const glm::dvec3 middle = ray.origin + ray.middle * ray.direction;
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
      segment_over(impostor.pictures[std::size_t(view)].camera, ray);
  return segment ? intersect(impostor.surfaces[view], *segment) : SurfaceHit{};
}

DepthImage warp_surfaces(const LayeredImpostor& impostor, const Camera& camera,
                         const SurfaceWarpOptions& options) {
  RILIEVO_EXPECTS(camera.projection == Projection::perspective);
  RILIEVO_EXPECTS(options.max_views >= 1 && options.max_views <= kMaxViewsAsked);
  const ServingViews serving = views_for_eye(
      impostor, camera.position(), {.max_views = options.max_views, .handover = options.handover});

  DepthImage frame;
  frame.camera = camera;
  frame.color = ColorImage(camera.width, camera.height);
  frame.depth = Image<float>(camera.width, camera.height, kNoDepth);
  frame.object = Image<std::uint32_t>(camera.width, camera.height, kNoObject);
  parallel_for(0, camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x) {
      const std::optional<PixelRay> ray = pixel_ray(impostor.bounds, camera, {x + 0.5, y + 0.5});
      if (!ray) continue;
      const Seen shown = look(impostor, serving, *ray);
      if (shown.eye_z == kNoDepth) continue;
      frame.depth(x, y) = shown.eye_z;
      frame.color(x, y) = shown.color;
      frame.object(x, y) = shown.object;
    }
  });
  return frame;
}

}  // namespace rilievo
