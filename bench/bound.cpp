#include "bench/bound.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>
#include <optional>

#include "bench/random.h"
#include "rilievo/measure/stats.h"
#include "rilievo/nailboard/error.h"

namespace rilievo::bench {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
// Frames drawn from each captured picture, and rays cast along each side of it.
constexpr int kFramesPerPicture = 8, kRays = 40;

// A union of boxes and balls, and from how far it is looked at, in radii of its bounds.
struct Solid {
  std::string name;
  std::vector<Box> boxes;
  std::vector<Ball> balls;
  double least_distance = 1.5, largest_distance = 30;
};

Box box(const glm::vec3& low, const glm::vec3& high) { return {low, high}; }

std::vector<Solid> solids() {
  std::vector<Solid> all;
  all.push_back({"thin", {box({-2, -1.5f, -0.01f}, {2, 1.5f, 0.01f})}, {}});
  all.push_back({"concave",  // an open crate
                 {box({-1, -1, -1}, {1, -0.9f, 1}), box({-1, -1, -1}, {-0.9f, 1, 1}),
                  box({0.9f, -1, -1}, {1, 1, 1}), box({-1, -1, -1}, {1, 1, -0.9f}),
                  box({-1, -1, 0.9f}, {1, 1, 1})},
                 {}});
  Solid deep{"deep", {}, {}};  // two rows of posts
  for (int i = 0; i < 8; ++i) {
    const float z = -10 + 2.5f * float(i);
    deep.boxes.push_back(box({-1, -1, z}, {-0.8f, 1, z + 0.2f}));
    deep.boxes.push_back(box({0.8f, -1, z}, {1, 1, z + 0.2f}));
  }
  all.push_back(deep);
  all.push_back(
      {"far", {box({-0.2f, -2, -0.2f}, {0.2f, 1, 0.2f})}, {{{0, 1.5, 0}, 1.2}}, 50, 2000});
  all.push_back({"near", {}, {{{0, 0, 0}, 1}, {{0.6, 0.5, 0.3}, 0.6}}, 1.1, 2});
  all.push_back({"tiny",
                 {box({-0.004f, -0.004f, -0.004f}, {0.002f, 0.002f, 0.002f})},
                 {{{0.002, 0.002, 0.002}, 0.003}}});
  all.push_back({"tree",
                 {box({-0.15f, 0, -0.15f}, {0.15f, 3, 0.15f})},
                 {{{0, 3.5, 0}, 1.5}, {{0.6, 4.6, 0.3}, 1}, {{-0.5, 4.9, -0.4}, 0.9}},
                 3,
                 60});
  return all;
}

Box bounds(const Solid& solid) {
  Box all;
  for (const Box& b : solid.boxes) all.add(b);
  for (const Ball& b : solid.balls) {
    all.add(glm::vec3(b.center - b.radius)), all.add(glm::vec3(b.center + b.radius));
  }
  return all;
}

// The first point of the solid on the ray origin + s direction, s > 0.
std::optional<double> hit(const Solid& solid, const glm::dvec3& origin,
                          const glm::dvec3& direction) {
  double nearest = kInfinity;
  for (const Box& b : solid.boxes) {
    const glm::dvec3 low = (glm::dvec3(b.min) - origin) / direction;
    const glm::dvec3 high = (glm::dvec3(b.max) - origin) / direction;
    const glm::dvec3 in = glm::min(low, high), out = glm::max(low, high);
    const double enter = std::max({in.x, in.y, in.z}), leave = std::min({out.x, out.y, out.z});
    if (enter <= leave && enter > 0) nearest = std::min(nearest, enter);
  }
  for (const Ball& b : solid.balls) {
    const glm::dvec3 o = origin - b.center;
    const double a = glm::dot(direction, direction), half = glm::dot(o, direction);
    const double discriminant = half * half - a * (glm::dot(o, o) - b.radius * b.radius);
    if (discriminant < 0) continue;
    const double enter = (-half - std::sqrt(discriminant)) / a;
    if (enter > 0) nearest = std::min(nearest, enter);
  }
  return nearest < kInfinity ? std::optional(nearest) : std::nullopt;
}

struct Sample {
  glm::dvec2 texel;  // a texel's centre
  double eye_z;
};

struct Captured {
  PictureGeometry picture;
  std::vector<Sample> samples;
};

// A picture of the solid, and what a grid of its texels shows.
Captured capture(const Solid& solid, SplitMix64& random) {
  const Box all = bounds(solid);
  const double radius = all.radius();
  Captured made;
  for (;;) {
    const double distance = radius * random.power(solid.least_distance, solid.largest_distance);
    const glm::dvec3 eye = glm::dvec3(all.center()) + distance * random.direction();
    const Result<Camera> camera =
        tight_camera(Projection::perspective, eye, random.direction(), all);
    // From within a corner of the box a picture is as wide as the eye can look.
    if (!camera.ok() || camera->window.right - camera->window.left > 3 ||
        camera->window.top - camera->window.bottom > 3)
      continue;
    made.picture.capture = *camera;
    break;
  }
  Camera& camera = made.picture.capture;
  // Around one texel a pixel of a 720p frame with a field of view of a radian.
  const double texels_per_tangent = 660 * random.power(0.4, 2.5);
  const auto texels = [&](double extent) {
    return std::clamp(int(extent * texels_per_tangent), 8, 1024);
  };
  camera.width = texels(camera.window.right - camera.window.left);
  camera.height = texels(camera.window.top - camera.window.bottom);
  made.picture = picture_geometry(camera);
  for (int y = 0; y < kRays; ++y)
    for (int x = 0; x < kRays; ++x) {
      const glm::dvec2 texel(std::floor((x + random.next()) / kRays * camera.width) + 0.5,
                             std::floor((y + random.next()) / kRays * camera.height) + 0.5);
      const glm::dvec3 one_metre = world_from_raster(camera, texel, 1) - camera.position();
      if (const std::optional<double> d = hit(solid, camera.position(), one_metre))
        made.samples.push_back({texel, *d});
    }
  return made;
}

struct Frame {
  Camera camera;
  RigidMotion motion;
};

// A new eye, near or not so near, looking at the solid or past it; half of the time the solid has
// moved as well.
Frame new_frame(const Solid& solid, const PictureGeometry& picture, SplitMix64& random) {
  const double distance = picture.plane_z;
  const glm::dvec3 center(bounds(solid).center());
  const glm::dvec3 old_eye = picture.capture.position();
  Frame frame;
  const glm::dvec3 eye = old_eye + random.vector(distance * random.power(1e-3, 0.3));
  const glm::dvec3 target = center + random.vector(distance * random.between(0, 0.4));
  const glm::dvec3 up = random.next() < 0.5 ? glm::dvec3(0, 1, 0) : random.direction();
  frame.camera =
      look_at(eye, target, up, random.between(0.5, 1.5), 1280, 720, 1e-3 * distance, 10 * distance);
  if (random.next() < 0.5) {
    glm::dmat4 m = glm::translate(glm::dmat4(1), center);
    m = glm::translate(m, random.vector(distance * random.power(1e-4, 0.1)));
    const glm::dvec3 axis = random.direction();
    m = glm::rotate(m, random.power(1e-3, 0.2), axis);
    frame.motion.now_from_then = glm::translate(m, -center);
  }
  return frame;
}

// The largest distance between what the frame shows, or ought to show, and where it belongs, as
// PictureError defines it: from a sample's place on the rectangle, and from the corners of the cell
// in which it is shown less the half diagonal of a pixel.
double measure(const Captured& captured, const Frame& frame) {
  const Camera& camera = frame.camera;
  const Camera& picture = captured.picture.capture;
  const glm::dmat4 clip_from_then = clip_from_world(camera) * frame.motion.now_from_then;
  struct Pixel {
    glm::dvec2 at;
    double weight;
    bool inside;
  };
  const auto project = [&](const glm::dvec3& then) {
    const glm::dvec4 clip = clip_from_then * glm::dvec4(then, 1);
    const bool inside =
        clip.w >= camera.z_near && std::abs(clip.x) <= clip.w && std::abs(clip.y) <= clip.w;
    return Pixel{{clip.x / clip.w * 0.5 * camera.width, clip.y / clip.w * 0.5 * camera.height},
                 clip.w,
                 inside};
  };
  double worst = 0;
  for (const Sample& sample : captured.samples) {
    const Pixel truth = project(world_from_raster(picture, sample.texel, sample.eye_z));
    const auto drawn_at = [&](const glm::dvec2& texel) {
      return project(world_from_raster(picture, texel, captured.picture.plane_z));
    };
    const auto distance = [&](const Pixel& drawn) {
      // What is nearer than the near plane is not drawn.
      const bool drawable = truth.weight > 0 && drawn.weight >= camera.z_near;
      return drawable ? glm::length(drawn.at - truth.at) : kInfinity;
    };
    const Pixel drawn = drawn_at(sample.texel);
    // What belongs into the frame and is drawn elsewhere is missing.
    if (drawn.inside || truth.inside) worst = std::max(worst, distance(drawn));
    for (int corner = 0; corner < 4; ++corner) {
      const glm::dvec2 step(corner & 1 ? 0.5 : -0.5, corner & 2 ? 0.5 : -0.5);
      if (const Pixel shown = drawn_at(sample.texel + step); shown.inside)
        worst = std::max(worst, distance(shown) - std::sqrt(0.5));
    }
  }
  return worst;
}

}  // namespace

BoundStats run_bound_benchmark(const BoundOptions& options) {
  BoundStats stats;
  SplitMix64 random{options.seed};
  const std::vector<Solid> all = solids();
  std::vector<std::vector<double>> tightness(all.size());
  for (const Solid& solid : all) stats.objects.push_back({solid.name});

  Captured captured;
  for (int i = 0; i < options.cases; ++i) {
    const std::size_t which = std::size_t(i / kFramesPerPicture) % all.size();
    if (i % kFramesPerPicture == 0) captured = capture(all[which], random);
    const Frame frame = new_frame(all[which], captured.picture, random);
    const double bound =
        options.scale * bound_error(captured.picture, frame.camera, frame.motion).total_px;
    const double measured = measure(captured, frame);
    BoundStats::OfObject& object = stats.objects[which];
    ++stats.cases, ++object.cases;
    // 1e-6 px: rounding of doubles.
    if (measured > bound + 1e-6) ++stats.violations, ++object.violations;
    if (measured > 0.25) tightness[which].push_back(bound / measured);
  }

  std::vector<double> together;
  for (std::size_t i = 0; i < all.size(); ++i) {
    together.insert(together.end(), tightness[i].begin(), tightness[i].end());
    stats.objects[i].tightness_median = median_of(tightness[i]);
  }
  stats.tightness_median = median_of(together);
  return stats;
}

}  // namespace rilievo::bench
