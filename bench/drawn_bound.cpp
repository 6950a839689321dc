#include "bench/drawn_bound.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <numbers>
#include <unordered_map>
#include <vector>

#include "bench/drawn_by.h"
#include "bench/random.h"
#include "rilievo/compare/drawn_frame.h"
#include "rilievo/frame/gl/opengl_target.h"
#include "rilievo/measure/stats.h"
#include "rilievo/scene/builtin/mesh_builder.h"

namespace rilievo::bench {
namespace {

constexpr int kBalls = 240, kMovingBalls = 40;
constexpr int kDrawnWidth = 640, kDrawnHeight = 360;
constexpr float kSeconds = 8;        // of the animation
constexpr int kFramesToACut = 20;    // at 25 frames a second
constexpr int kMinPixels = 40;       // of a ball that is looked at
constexpr std::uint32_t kLooks = 4;  // one ball in so many is: cases are of more frames
constexpr int kDrawnSamples = 4;

// Balls of 1 152 triangles each, in a box of 40 x 16 x 40 m; some go to and fro.
Scene cloud_of_balls(SplitMix64& random) {
  Scene scene;
  Mesh ball;
  add_blob(ball, 12, [](const glm::vec3& direction) { return BuiltVertex{direction}; });
  scene.materials.emplace_back();
  ball.material = 0;
  scene.meshes.push_back(std::move(ball));
  Model model;
  model.parts.push_back({0, glm::mat4(1)});
  scene.models.push_back(model);
  scene.duration = kSeconds;
  for (int i = 0; i < kBalls; ++i) {
    const glm::vec3 at{random.between(-20, 20), random.between(-8, 8), random.between(-20, 20)};
    Object object;
    const float radius = float(random.power(0.1, 0.5));
    object.placement = glm::scale(glm::mat4(1), glm::vec3(radius));
    if (i < kMovingBalls) {
      object.node = int(scene.nodes.size());
      scene.nodes.emplace_back();
      const glm::vec3 there = at + glm::vec3(random.vector(random.between(0.2, 3)));
      Channel channel;
      channel.node = object.node;
      channel.times = {0, kSeconds / 2, kSeconds};
      channel.values = {glm::vec4(at, 0), glm::vec4(there, 0), glm::vec4(at, 0)};
      scene.channels.push_back(std::move(channel));
    } else {
      object.placement = glm::translate(glm::mat4(1), at) * object.placement;
    }
    scene.objects.push_back(std::move(object));
  }
  finish(scene);
  return scene;
}

// A straight way past the cloud or through it, the eyes on a place in it.
struct Leg {
  glm::dvec3 eye, velocity, target;
};

Leg new_leg(SplitMix64& random) {
  Leg leg;
  const double distance = random.between(10, 50);
  leg.eye = distance * glm::normalize(random.direction() * glm::dvec3(1, 0.3, 1));
  leg.velocity = random.vector(random.power(0.2, 4));  // metres a second
  leg.target = random.vector(random.between(0, 8));
  return leg;
}

struct Pixels {
  std::vector<glm::ivec2> at;
  glm::dvec2 centroid{0};
  glm::ivec2 low{std::numeric_limits<int>::max()}, high{-1};

  void add(int x, int y) {
    at.emplace_back(x, y);
    centroid += glm::dvec2(x, y);
    low = glm::min(low, glm::ivec2(x, y)), high = glm::max(high, glm::ivec2(x, y));
  }
};

std::unordered_map<std::uint32_t, Pixels> pixels_of(const Image<std::uint32_t>& ids) {
  std::unordered_map<std::uint32_t, Pixels> found;
  for (int y = 0; y < ids.height(); ++y)
    for (int x = 0; x < ids.width(); ++x)
      if (ids(x, y) != 0) found[ids(x, y)].add(x, y);
  for (auto& [id, pixels] : found) pixels.centroid /= double(pixels.at.size());
  return found;
}

// Is there nothing but sky around, so far that no other object may reach it, and is the frame's
// edge as far away?
bool is_alone(const Image<std::uint32_t>& ids, std::uint32_t id, const Pixels& pixels, int margin) {
  const glm::ivec2 low = pixels.low - margin, high = pixels.high + margin;
  if (low.x < 0 || low.y < 0 || high.x >= ids.width() || high.y >= ids.height()) return false;
  for (int y = low.y; y <= high.y; ++y)
    for (int x = low.x; x <= high.x; ++x)
      if (ids(x, y) != 0 && ids(x, y) != id) return false;
  return true;
}

// The largest distance of a pixel of `from` at which `others` does not show the object from the
// nearest pixel of `to`.
double farthest(const Pixels& from, const Image<std::uint32_t>& others, std::uint32_t id,
                const Pixels& to) {
  int most = 0;
  for (const glm::ivec2& p : from.at) {
    if (others(p.x, p.y) == id) continue;
    int nearest = std::numeric_limits<int>::max();
    for (const glm::ivec2& q : to.at) {
      const glm::ivec2 d = p - q;
      nearest = std::min(nearest, d.x * d.x + d.y * d.y);
    }
    most = std::max(most, nearest);
  }
  return std::sqrt(double(most));
}

// The strip of a ball that an eye sees and the capture's eye did not, at its widest, in radii: no
// bound of positions is about it (cache.md, "What was hidden at capture").
double unseen_of_ball(const glm::dvec3& center, const glm::dvec3& captured_from,
                      const glm::dvec3& eye) {
  return 1 - glm::dot(glm::normalize(captured_from - center), glm::normalize(eye - center));
}

// How many of the frame's pixels a texel of a picture covers, at distances from the two eyes.
double texel_px(const Camera& capture, double captured_from, const Camera& camera, double now) {
  const auto size = [](const Camera& c, double distance) {
    return (c.window.right - c.window.left) / c.width * distance;
  };
  return size(capture, captured_from) / size(camera, now);
}

class DrawnCases {
 public:
  DrawnCases(const Scene& scene, double scale) : scene_(scene), scale_(scale) {}

  void add_frame(const Camera& camera, const std::vector<glm::mat4>& poses, const DrawnFrame& truth,
                 const DrawnFrame& seen, const SceneCache& cache) {
    struct Shown {
      double bound_px = 0, unseen = 0, texel_px = 0;
      int pictures = 0;
    };
    std::vector<Shown> shown(scene_.objects.size());
    for (const SceneCache::Shown& picture : cache.shown()) {
      const glm::dvec3 captured_from =
          picture.world_now_from_capture * glm::dvec4(picture.geometry.capture.position(), 1);
      for (const std::uint32_t object : picture.objects) {
        Shown& one = shown[object];
        one.bound_px = std::max(one.bound_px, picture.bound_px);
        const glm::dvec3 center(poses[object][3]);
        one.unseen = std::max(one.unseen, unseen_of_ball(center, captured_from, camera.position()));
        one.texel_px = std::max(
            one.texel_px, texel_px(picture.geometry.capture, glm::length(captured_from - center),
                                   camera, glm::length(camera.position() - center)));
        ++one.pictures;
      }
    }
    const auto wanted = pixels_of(truth.objects), found = pixels_of(seen.objects);
    ++stats.frames;
    stats.captures += seen.stats.captures;
    stats.bound_px_max = std::max(stats.bound_px_max, seen.stats.bound_px.value_or(0));
    const int margin = 3 + int(std::ceil(2 * seen.stats.bound_px.value_or(0)));
    for (const auto& [id, pixels] : wanted) {
      if ((id + std::uint32_t(stats.frames)) % kLooks != 0) continue;
      if (int(pixels.at.size()) < kMinPixels || !is_alone(truth.objects, id, pixels, margin))
        continue;
      const Shown& object = shown[id - 1];
      if (object.pictures == 0) continue;  // drawn from polygons: the same as the truth
      ++stats.cases;
      stats.fading += object.pictures > 1;
      stats.moving += scene_.objects[id - 1].moving;
      const auto there = found.find(id);
      if (there == found.end()) {
        ++stats.missing, ++stats.violations;
        continue;
      }
      const double centroid = glm::length(there->second.centroid - pixels.centroid);
      const double outline = std::max(farthest(there->second, truth.objects, id, pixels),
                                      farthest(pixels, seen.objects, id, there->second));
      const double radius = std::sqrt(double(pixels.at.size()) / std::numbers::pi);
      const double bound = scale_ * object.bound_px + object.unseen * radius;
      stats.centroid_excess_px = std::max(stats.centroid_excess_px, centroid - bound);
      stats.outline_excess_px = std::max(stats.outline_excess_px, outline - bound);
      stats.violations += centroid > bound + centroid_slack_px(object.texel_px) ||
                          outline > bound + outline_slack_px(object.texel_px);
      stats.unseen_px_max = std::max(stats.unseen_px_max, object.unseen * radius);
      if (centroid > 0.5) tightness.push_back(object.bound_px / centroid);
    }
  }

  DrawnBoundStats stats{.centroid_excess_px = -std::numeric_limits<double>::infinity(),
                        .outline_excess_px = -std::numeric_limits<double>::infinity()};
  std::vector<double> tightness;

 private:
  const Scene& scene_;
  double scale_;
};

}  // namespace

Result<DrawnBoundStats> run_drawn_bound_benchmark(const DrawnBoundOptions& options) {
  SplitMix64 random{options.seed};
  const Scene scene = cloud_of_balls(random);
  Result<SceneRenderer> renderer = SceneRenderer::create(scene);
  if (!renderer) return renderer.error();
  Result<OpenGLTarget> target = OpenGLTarget::create(kDrawnWidth, kDrawnHeight, kDrawnSamples);
  if (!target) return target.error();
  ImageCacheOptions cache_options;
  cache_options.error_px = options.error_px;
  cache_options.samples = kDrawnSamples;
  const Result<CachedFrames> cache = make_cache(scene, &*renderer, cache_options);
  if (!cache) return cache.error();
  const auto direct = polygon_drawer(scene, &*renderer, kDrawnSamples);
  std::vector<glm::mat4> poses;

  DrawnCases cases(scene, options.scale);
  Leg leg;
  for (int f = 0; cases.stats.cases < options.cases; ++f) {
    if (f % kFramesToACut == 0) leg = new_leg(random);
    const double seconds = (f % kFramesToACut) / 25.0;
    WalkFrame frame;
    frame.time = f / 25.0;
    frame.camera = look_at(leg.eye + seconds * leg.velocity, leg.target, {0, 1, 0}, 0.8,
                           kDrawnWidth, kDrawnHeight, 0.1, 200);
    Result<DrawnFrame> seen = draw_frame(*cache->frames, *target, frame);
    if (!seen) return seen.error();
    Result<DrawnFrame> truth = draw_frame(*direct, *target, frame);
    if (!truth) return truth.error();
    pose(scene, frame.time, poses);
    cases.add_frame(frame.camera, poses, *truth, *seen, *cache->cache);
    if (options.progress)
      options.progress(std::min(cases.stats.cases, options.cases), options.cases);
    // Pictures stand for most balls; if none ever did, there would be no end.
    if (f == 400 && cases.stats.cases == 0) return Error{"bench bound", "no picture was drawn"};
  }
  cases.stats.tightness_median = median_of(cases.tightness);
  return cases.stats;
}

}  // namespace rilievo::bench
