#include "rilievo/core/camera_path.h"

#include <algorithm>
#include <cmath>
#include <glm/gtc/constants.hpp>
#include <span>

namespace rilievo {
namespace {

constexpr double kVerticalFov = 0.87;  // 50 degrees
constexpr double kOrbitSpeed = 10.0 * glm::pi<double>() / 180.0;
constexpr double kFirstAzimuth = 0.5;  // from +z towards +x
constexpr double kElevation = 15.0 * glm::pi<double>() / 180.0;

// The keys around `i` that no cut separates from it.
std::span<const PathKey> shot_of(std::span<const PathKey> keys, std::size_t i) {
  std::size_t first = i, last = i;
  // Three on each side: no more are asked for.
  while (first > 0 && i - first < 3 && !is_cut(keys[first - 1], keys[first])) --first;
  while (last + 1 < keys.size() && last - i < 3 && !is_cut(keys[last], keys[last + 1])) ++last;
  return keys.subspan(first, last - first + 1);
}

// Velocity of the eye at key `k`: the slope there of the parabola through three neighbouring keys
// (k in their middle where there are keys on both sides). A straight walk at constant speed stays
// one; a circle with a key every h radians is left by about h^2 / 6 of the step.
glm::dvec3 velocity(std::span<const PathKey> keys, std::size_t k) {
  const auto step = [&](std::size_t i) { return keys[i + 1].time - keys[i].time; };
  const auto chord = [&](std::size_t i) { return (keys[i + 1].eye - keys[i].eye) / step(i); };
  if (keys.size() == 2) return chord(0);
  const std::size_t last = keys.size() - 1;
  const std::size_t a = k == 0 ? 0 : k == last ? last - 2 : k - 1;
  const glm::dvec3 curvature = (chord(a + 1) - chord(a)) / (step(a) + step(a + 1));
  return k == a       ? chord(a) - curvature * step(a)
         : k == a + 1 ? chord(a) + curvature * step(a)
                      : chord(a + 1) + curvature * step(a + 1);
}

PathKey between(const std::vector<PathKey>& keys, double time) {
  if (keys.size() == 1 || time <= keys.front().time) return keys.front();
  if (time >= keys.back().time) return keys.back();
  const auto above = std::upper_bound(keys.begin(), keys.end(), time,
                                      [](double t, const PathKey& key) { return t < key.time; });
  const std::size_t i = std::size_t(above - keys.begin()) - 1;
  const PathKey &a = keys[i], &b = keys[i + 1];
  if (is_cut(a, b)) return a;
  const std::span<const PathKey> shot = shot_of(keys, i);
  const auto in_shot = std::size_t(&a - shot.data());
  const double step = b.time - a.time, s = (time - a.time) / step;
  // Cubic Hermite: C1 through every key.
  const double s2 = s * s, s3 = s2 * s;
  PathKey p;
  p.time = time;
  p.eye = a.eye * (2 * s3 - 3 * s2 + 1) + b.eye * (3 * s2 - 2 * s3) +
          step * (velocity(shot, in_shot) * (s3 - 2 * s2 + s) +
                  velocity(shot, in_shot + 1) * (s3 - s2));
  p.world_from_eye = glm::normalize(glm::slerp(a.world_from_eye, b.world_from_eye, s));
  p.vertical_fov = glm::mix(a.vertical_fov, b.vertical_fov, s);
  return p;
}

// From where all of `bounds` is seen: the ball around it fits into a frame that is at least as wide
// as high, from
//   sin(fov / 2) = radius / distance, and 5 % for comfort.
// With a gaze: from its eye, whatever is seen from there.
struct Framing {
  glm::dvec3 center{0.0};  // looked at
  double radius = 1.0, distance = 0.0;
  double elevation = kElevation;
  glm::dvec3 up, level, aside;  // orthonormal; the eye is level * cos(elevation) ... at first
  double near_reach = 0, far_reach = 0;  // of the bounds from `center`, towards eyes and away

  Framing(const Box& bounds, const Vantage& vantage) : up(glm::normalize(vantage.up)) {
    glm::dvec3 middle(0.0);
    if (!bounds.empty()) {
      middle = 0.5 * (glm::dvec3(bounds.min) + glm::dvec3(bounds.max));
      radius = 0.5 * glm::length(glm::dvec3(bounds.max) - glm::dvec3(bounds.min));
    }
    // A single point far from the origin still needs a distance that doubles can resolve.
    radius = std::max({radius, 1e-6 * glm::length(middle), 1e-6});
    if (!vantage.gaze) {
      center = middle;
      distance = 1.05 * radius / std::sin(0.5 * kVerticalFov);
      // Any two directions at right angles to `up`; for +y those of z and x.
      const glm::dvec3 z = std::abs(up.z) < 0.9 ? glm::dvec3(0, 0, 1) : glm::dvec3(0, 1, 0);
      const glm::dvec3 e = glm::normalize(z - glm::dot(z, up) * up), f = glm::cross(up, e);
      level = std::cos(kFirstAzimuth) * e + std::sin(kFirstAzimuth) * f;
      near_reach = far_reach = radius;
    } else {
      center = vantage.gaze->target;
      const glm::dvec3 outwards = vantage.gaze->eye - center;
      distance = glm::length(outwards);
      const double rise = glm::dot(outwards, up);
      level = glm::normalize(outwards - rise * up);
      elevation = std::asin(std::clamp(rise / distance, -1.0, 1.0));
      near_reach = 0.98 * distance;  // the eye is within: something may be right before it
      far_reach = glm::distance(center, middle) + radius;
    }
    aside = glm::cross(up, level);
  }

  [[nodiscard]] glm::dvec3 outwards(double turned) const {
    return std::cos(elevation) * (std::cos(turned) * level + std::sin(turned) * aside) +
           std::sin(elevation) * up;
  }
  // Near and far planes for eyes at distances from the center between `distance` and `farthest`.
  void set_planes(CameraPath& path, double farthest) const {
    path.z_near = std::max(0.5 * (distance - near_reach), 1e-3 * near_reach);
    path.z_far = farthest + 1.5 * far_reach;
  }
};

}  // namespace

CameraPath relative_to(const glm::dvec3& origin, CameraPath path) {
  for (PathKey& key : path.keys) key.eye -= origin;
  return path;
}

PathKey look_key(double time, const glm::dvec3& eye, const glm::dvec3& target, const glm::dvec3& up,
                 double vertical_fov) {
  const Camera camera = look_at(eye, target, up, vertical_fov, 1, 1, 1, 2);
  return {time, eye, glm::normalize(glm::quat_cast(glm::dmat3(camera.world_from_eye))),
          vertical_fov};
}

bool is_cut(const PathKey& key, const PathKey& next) {
  // A difference of rounded times may come out larger than it is.
  constexpr double kRounding = 1e-6;
  return next.time - key.time <= kCutSeconds + kRounding;
}

int frame_count(const CameraPath& path) {
  RILIEVO_EXPECTS(!path.keys.empty());
  const double seconds = path.keys.back().time - path.keys.front().time;
  return int(std::clamp(std::round(seconds * kFramesPerSecond), 1.0, 1e9));
}

double frame_time(const CameraPath& path, int frame) {
  RILIEVO_EXPECTS(!path.keys.empty());
  return path.keys.front().time + frame / kFramesPerSecond;
}

Camera camera_at(const CameraPath& path, double time, int width, int height) {
  RILIEVO_EXPECTS(!path.keys.empty());
  const PathKey key = between(path.keys, time);
  Camera camera = look_at(glm::dvec3(0), glm::dvec3(0, 0, -1), glm::dvec3(0, 1, 0),
                          key.vertical_fov, width, height, path.z_near, path.z_far);
  camera.world_from_eye = glm::dmat4(glm::mat3_cast(key.world_from_eye));
  camera.world_from_eye[3] = glm::dvec4(key.eye, 1);
  return camera;
}

CameraPath there_and_back(const CameraPath& path, double seconds) {
  RILIEVO_EXPECTS(!path.keys.empty());
  const double start = path.keys.front().time, length = path.keys.back().time - start;
  CameraPath longer = path;
  // Else the shortest paths would have keys without end.
  if (!(length >= 1 / kFramesPerSecond)) return longer;
  bool back = true;
  for (double turn = length; turn < seconds; turn += length, back = !back)
    for (std::size_t i = 1; i < path.keys.size(); ++i) {
      PathKey key = path.keys[back ? path.keys.size() - 1 - i : i];
      const double since = key.time - start;
      key.time = start + turn + (back ? length - since : since);
      longer.keys.push_back(key);
    }
  return longer;
}

CameraPath orbit_path(const Box& bounds, int frames, const Vantage& vantage) {
  RILIEVO_EXPECTS_GE(frames, 1);
  const Framing framing(bounds, vantage);
  CameraPath path;
  framing.set_planes(path, framing.distance);
  // One key a degree: the curve through them leaves the circle by less than 1e-6 of its radius.
  const double key_step = 1.0 * glm::pi<double>() / 180.0 / kOrbitSpeed;
  const double seconds = frames / kFramesPerSecond;
  const int steps = std::max(1, int(std::ceil(seconds / key_step)));
  for (int i = 0; i <= steps; ++i) {
    const double time = seconds * i / steps;
    path.keys.push_back(
        look_key(time, framing.center + framing.distance * framing.outwards(kOrbitSpeed * time),
                 framing.center, framing.up, kVerticalFov));
  }
  return path;
}

CameraPath walk_path(const Box& bounds, int frames, const Vantage& vantage) {
  RILIEVO_EXPECTS_GE(frames, 1);
  const Framing framing(bounds, vantage);
  const double seconds = frames / kFramesPerSecond;
  const double half_length = 0.5 * seconds * 0.1 * kWalkingSpeed * framing.radius;
  // The middle of the walk frames the bounds. The walker passes at a right angle, so that every
  // other point of the walk is farther away.
  const glm::dvec3 middle = framing.center + framing.distance * framing.outwards(0);
  CameraPath path;
  framing.set_planes(path, std::hypot(framing.distance, half_length));
  for (const double end : {-1.0, 1.0}) {
    PathKey key =
        look_key((0.5 + 0.5 * end) * seconds, middle, framing.center, framing.up, kVerticalFov);
    key.eye += end * half_length * framing.aside;
    path.keys.push_back(key);
  }
  return path;
}

}  // namespace rilievo
