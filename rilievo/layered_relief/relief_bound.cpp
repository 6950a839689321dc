// Lines of sight as points of the plane at distance 1 along the relief's direction: the box's
// corners give the steepest one, and how large the result can be. Then as relief_error.cpp has it.
#include "rilievo/layered_relief/relief_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace rilievo {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kUnit = 32767;

glm::dvec3 forward_of(const ReliefStats& stats, int i) {
  const auto& [x, y, z] = stats.forward[std::size_t(i)];
  return glm::normalize(glm::dvec3(x, y, z));
}

// How the box lies before an eye that looks along `forward`.
struct Sight {
  double nearest = kInfinity, farthest = 0;  // along forward
  double plane = 0;  // the relief's plane; how far that may be wrong is counted in
  double least_plane = 0, most_plane = 0;
  [[nodiscard]] bool warpable() const {
    return least_plane > 0 && nearest > 1.01 * most_plane / kMaxPrewarpMagnification;
  }
};

Sight sight_of(const ReliefStats& stats, const Box& bounds, int i, const glm::dvec3& eye) {
  const glm::dvec3 forward = forward_of(stats, i);
  const double radius = double(bounds.radius());
  Sight sight;
  sight.plane = glm::dot(glm::dvec3(bounds.center()) - eye, forward) +
                stats.plane[std::size_t(i)] / kUnit * radius;
  // A unit of the plane's, and of the direction's.
  const double wrong = 4 * radius / kUnit;
  sight.least_plane = sight.plane - wrong;
  sight.most_plane = sight.plane + wrong;
  for (const glm::vec3& corner : bounds.corners()) {
    const double along = glm::dot(glm::dvec3(corner) - eye, forward);
    sight.nearest = std::min(sight.nearest, along);
    sight.farthest = std::max(sight.farthest, along);
  }
  sight.nearest -= wrong;
  sight.farthest += wrong;
  return sight;
}

double focal_of(const Camera& camera) {
  return std::max(camera.width / (camera.window.right - camera.window.left),
                  camera.height / (camera.window.top - camera.window.bottom));
}

// What is warped for the eye of a camera.
struct Warped {
  double most_tangent = 0;  // of a line of sight's angle with the relief's direction
  double texel = 0;         // along its diagonal, averaged or not, pixels on the axis
  double splat = 1;  // source texels: a side of a square whose diagonal no splat's is longer than
  double least_magnified = 0;  // texels of the result for one of the relief, where that is farthest
};

Warped warped_for(const ReliefStats& stats, const Box& bounds, int picked, const Sight& sight,
                  const Camera& camera) {
  const glm::dvec3 eye = camera.position(), forward = forward_of(stats, picked);
  Warped result;
  std::array<glm::dvec3, 8> sights;
  for (int i = 0; i < 8; ++i) {
    const glm::dvec3 to = glm::dvec3(bounds.corners()[std::size_t(i)]) - eye;
    sights[std::size_t(i)] = to / glm::dot(to, forward) - forward;
    result.most_tangent = std::max(result.most_tangent, glm::length(sights[std::size_t(i)]));
  }
  // Of slopes t and s along both axes the sides are sqrt(1 + t^2) and sqrt(1 + s^2) times as long:
  // the diagonal is sqrt(1 + (t^2 + s^2) / 2) times as long.
  const double slope = double(stats.faces_eye) * 1.001 * result.most_tangent;
  result.splat = double(stats.splat_size) * std::sqrt(1 + 0.5 * slope * slope);
  double across = 0;  // of the result, at distance 1
  for (int i = 0; i < 8; ++i)
    for (int k = i + 1; k < 8; ++k)
      across = std::max(across, glm::distance(sights[std::size_t(i)], sights[std::size_t(k)]));
  // What Prewarp::warp halves, and the splats that reach beyond.
  const double reach = double(stats.largest_texel) *
                       std::max(1.0, double(stats.splat_size) * std::sqrt(1 + slope * slope));
  const double texels = (across * sight.most_plane + 2 * reach * sight.most_plane / sight.nearest) /
                        double(stats.least_texel);
  double resolution = double(stats.resolution);
  while (texels * resolution > stats.max_size - 2) resolution *= 0.5;
  const double texel_px = std::sqrt(2.0) * double(stats.largest_texel) / resolution /
                          sight.least_plane * focal_of(camera);
  result.texel = std::max(texel_px, std::sqrt(2.0) * double(stats.texel_px));
  result.least_magnified = resolution * sight.least_plane / sight.farthest;
  return result;
}

// 1 / cos^2 of the angle between the frame's axis and the line of sight, at most, over what the
// frame shows of the box.
double obliqueness(const Camera& camera, const Box& bounds) {
  const auto& [l, r, b, t] = camera.window;
  double x = std::max(std::abs(l), std::abs(r)), y = std::max(std::abs(b), std::abs(t));
  const glm::dmat4 eye_from_world = glm::inverse(camera.world_from_eye);
  double most_x = 0, most_y = 0;
  for (const glm::vec3& corner : bounds.corners()) {
    const glm::dvec4 at = eye_from_world * glm::dvec4(corner, 1);
    if (!(-at.z > 0)) return 1 + x * x + y * y;
    most_x = std::max(most_x, std::abs(at.x / at.z));
    most_y = std::max(most_y, std::abs(at.y / at.z));
  }
  x = std::min(x, most_x), y = std::min(y, most_y);
  return 1 + x * x + y * y;
}

}  // namespace

ReliefStats relief_stats(const ReliefSet& set, const Box& bounds, double moved,
                         const PrewarpOptions& options, double lacks, const StrokeSize& strokes) {
  RILIEVO_EXPECTS(!set.reliefs.empty() && set.reliefs.size() <= ReliefStats::kMaxCount);
  ReliefStats stats;
  for (const LayeredRelief& relief : set.reliefs)
    if (relief.perspective()) return stats;
  stats.count = int(set.reliefs.size());
  stats.max_size = options.max_size;
  stats.splat_size = options.splat == Splat::nearest ? 0.0f : float(options.splat_size);
  stats.faces_eye = options.splats_face_eye ? 1 : 0;
  stats.resolution = float(options.resolution);
  stats.moved = float(moved);
  if (lacks > 0) stats.lacks = std::nextafter(float(lacks), std::numeric_limits<float>::max());
  stats.disc_radius = std::nextafter(float(strokes.disc_radius), std::numeric_limits<float>::max());
  if (strokes.disc_radius == 0) stats.disc_radius = 0;
  stats.stroke_texels = float(strokes.texels);
  double least = kInfinity, largest = 0, depth = 0;
  const double radius = std::max(double(bounds.radius()), 1e-30);
  for (int i = 0; i < stats.count; ++i) {
    const LayeredRelief& relief = set.reliefs[std::size_t(i)];
    const ReliefFrame frame = relief.frame();
    for (int k = 0; k < 3; ++k)
      stats.forward[std::size_t(i)][std::size_t(k)] =
          std::int16_t(std::lround(std::clamp(frame.f[k], -1.0, 1.0) * kUnit));
    const double plane =
        glm::dot(frame.origin - glm::dvec3(bounds.center()), forward_of(stats, i)) / radius;
    stats.plane[std::size_t(i)] = std::int16_t(std::lround(std::clamp(plane, -1.0, 1.0) * kUnit));
    for (const double side : {glm::length(frame.a), glm::length(frame.b)})
      least = std::min(least, side), largest = std::max(largest, side);
    depth = std::max(depth, relief.merged_d + 0.5 * relief.d_step);
  }
  // Rounded to the safe side.
  stats.least_texel = std::nextafter(float(least), 0.0f);
  stats.largest_texel = std::nextafter(float(largest), std::numeric_limits<float>::max());
  stats.depth = std::nextafter(float(depth), std::numeric_limits<float>::max());
  return stats;
}

// A point of a surface has a sample within `lacks`. The sample's splat of s texels may be hidden by
// the splats of deeper samples, of neighbouring texels, which are drawn later: they leave what is
// from -(1 - s / 2) to s / 2 of a texel beside its middle, along both axes. The result's texel that
// shows it is there: within max(s / 2, 1 - s / 2, 1 / 2) of the middle, along both axes. A splat
// that is smaller than a texel of the result may lie between the middles of all: nothing is known
// then.
double relief_gap_px(const ReliefStats& stats, const Box& bounds, const Camera& camera) {
  RILIEVO_EXPECTS(camera.projection == Projection::perspective);
  const int picked = pick_relief(stats, bounds, camera.position());
  if (picked < 0 || stats.lacks == 0) return kInfinity;
  const Sight sight = sight_of(stats, bounds, picked, camera.position());
  const Warped result = warped_for(stats, bounds, picked, sight, camera);
  if (result.least_magnified * double(stats.splat_size) < 1) return kInfinity;
  const double half = 0.5 * result.splat, least_half = 0.5 * double(stats.splat_size);
  const double beside = std::max({half, 1 - least_half, 0.5});
  const double px =
      (2 * focal_of(camera) * double(stats.lacks) / sight.nearest + 2 * beside * result.texel) *
      obliqueness(camera, bounds);
  return std::max(0.0, px - std::sqrt(2.0));
}

int pick_relief(const ReliefStats& stats, const Box& bounds, const glm::dvec3& eye) {
  const glm::dvec3 away = glm::dvec3(bounds.center()) - eye;
  int best = -1;
  double most = -kInfinity;
  for (int i = 0; i < stats.count; ++i) {
    const double facing = glm::dot(forward_of(stats, i), away);
    if (facing <= most || !sight_of(stats, bounds, i, eye).warpable()) continue;
    most = facing;
    best = i;
  }
  return best;
}

double scale_of(const glm::dmat4& world_from_capture) {
  return glm::length(glm::dvec3(world_from_capture[0]));
}

std::optional<Camera> camera_at_capture(const Camera& frame, const glm::dmat4& world_from_capture) {
  const glm::dmat3 m(world_from_capture);
  const double scale = scale_of(world_from_capture);
  if (!(scale > 0) || !std::isfinite(scale)) return std::nullopt;
  const glm::dmat3 square = glm::transpose(m) * m / (scale * scale);
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k)
      if (!(std::abs(square[i][k] - (i == k ? 1 : 0)) <= 1e-4)) return std::nullopt;
  if (!(glm::determinant(m) > 0)) return std::nullopt;
  Camera camera = frame;
  camera.world_from_eye = glm::inverse(world_from_capture) * frame.world_from_eye;
  for (int k = 0; k < 3; ++k)
    camera.world_from_eye[k] = glm::dvec4(glm::normalize(glm::dvec3(camera.world_from_eye[k])), 0);
  camera.world_from_eye[3].w = 1;
  camera.z_near /= scale;
  camera.z_far /= scale;
  return camera;
}

int relief_level(double texel_px, double most_px) {
  int level = 0;
  while (level < 8 && 2 * texel_px <= most_px) texel_px *= 2, ++level;
  return level;
}

double relief_bound_px(const ReliefStats& stats, const Box& bounds, const Camera& camera) {
  RILIEVO_EXPECTS(camera.projection == Projection::perspective);
  const glm::dvec3 eye = camera.position();
  const int picked = pick_relief(stats, bounds, eye);
  if (picked < 0) return kInfinity;
  const Sight sight = sight_of(stats, bounds, picked, eye);
  const Warped result = warped_for(stats, bounds, picked, sight, camera);
  const double tangent = 1.001 * result.most_tangent,
               sine = tangent / std::sqrt(1 + tangent * tangent);
  const double diagonal = std::sqrt(2.0) * double(stats.largest_texel);
  const double sample = 0.5 * std::max(1.0, result.splat) * diagonal + double(stats.depth) * sine +
                        double(stats.moved) + double(stats.disc_radius);
  const double oblique = obliqueness(camera, bounds);
  const double px = (focal_of(camera) * sample / sight.nearest + 0.5 * result.texel) * oblique;
  return std::max(0.0, px - std::sqrt(0.5)) +
         strip_difference_px(double(stats.stroke_texels),
                             0.5 * focal_of(camera) * diagonal / sight.nearest * oblique);
}

}  // namespace rilievo
