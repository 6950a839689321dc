// A texel's line of sight passes through its middle: apex + z dir, with |dir| its stretch per metre
// of eye_z. Let the sample be at z = s, its piece over [f, b], and a slice at z = k show what has
// depths in [p, r): the texel is on it if [f, b] meets [p, r). A point drawn is at raster offset o
// from the texel's middle,
//
//   P = apex + k (dir + o t),   S = apex + s dir,   t: a texel at z = 1
//   |P - S| <= |k - s| |dir| + k |o t|,   |k - s| <= max(k - p, r - k) + max(s - f, b - s)
//
// and k |o t| is at most the way from the middle of the texel to its corner, on the slice. As for
// the surface: some point of the piece has the depth in [f, b] nearest to k, which is within
// max(k - p, r - k) of it, and lies in the same texel, from corner to corner at worst.
//
// Seen from an eye, a point at distance d and one at most D < d from it span an angle of at most
// asin(D / d). Samples and pieces lie within the bounds; what is drawn may lie beside them.

#include "rilievo/layered_impostor/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rilievo/core/expects.h"
#include "rilievo/warp/parallax.h"

namespace rilievo {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
// What a drawer may keep of a texel's interval: 16 bits of the view's range, rounded outwards.
constexpr double kIntervalStep = 1.0 / 65535;
// Of the ball around the bounds.
constexpr double kServedRadii = 1.2;

// Tangent of the angle between the frame's axis and the farthest point of the box that is in the
// frame, at most.
double off_axis_tan(const Box& bounds, const glm::dmat4& world_from_impostor, const Camera& frame) {
  const glm::dmat4 eye_from_impostor = glm::inverse(frame.world_from_eye) * world_from_impostor;
  const double in_frame = corner_tan(frame);
  double farthest = 0;
  for (const glm::vec3& corner : bounds.corners()) {
    const glm::dvec4 at = eye_from_impostor * glm::dvec4(corner, 1);
    if (!(at.z < 0)) return in_frame;
    farthest = std::max(farthest, std::hypot(at.x, at.y) / -at.z);
  }
  return std::min(farthest, in_frame);
}

// For samples at least `distance` metres from the eye and within `off_axis_tan` of the axis.
LayeredError bound_at(const LayeredErrorStats& stats, bool sliced, const Camera& frame,
                      double distance, double off_axis_tan) {
  RILIEVO_EXPECTS(frame.projection == Projection::perspective);
  LayeredError error;
  error.surface_m = sliced ? stats.slice + 2 * stats.texel : 0;
  error.sample_m = (sliced ? stats.slice : 0) + stats.reach + stats.texel;
  const auto pixels = [&](double metres) {
    if (metres == 0) return 0.0;
    if (!(metres < distance)) return kNever;
    return pixels_from_angle(frame, off_axis_tan, std::asin(metres / distance));
  };
  error.surface_px = pixels(error.surface_m);
  error.sample_px = pixels(error.sample_m);
  const double placed_m = (sliced ? stats.slice : 0) + stats.texel;
  // Polygons are off by half a pixel's diagonal too.
  error.total_px = std::max(0.0, pixels(placed_m) - std::sqrt(0.5));
  return error;
}

}  // namespace

LayeredErrorStats layered_error_stats(const LayeredImpostor& impostor) {
  LayeredErrorStats stats;
  for (std::size_t v = 0; v < impostor.pictures.size(); ++v) {
    const TexelSurface& surface = impostor.surfaces[v];
    const Camera& camera = surface.camera;
    const std::vector<Slice>& slices = impostor.slices[v];
    if (slices.empty()) continue;
    const auto& [l, r, b, t] = camera.window;
    const double dx = (r - l) / camera.width, dy = (t - b) / camera.height;
    double half = kIntervalStep * double(slices.back().back - slices.front().front);
    double thickest = 0, farthest = 0;
    for (const Slice& slice : slices) {
      thickest = std::max({thickest, double(slice.eye_z) - double(slice.front),
                           double(slice.back) - double(slice.eye_z)});
      farthest = std::max(farthest, double(slice.back));
    }
    half += thickest;
    double steepest = 1;  // stretch of the lines of sight
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const SurfaceTexel& texel = surface.texels(x, y);
        if (texel.q == 0) continue;
        const double u = l + (x + 0.5) * dx, w = t - (y + 0.5) * dy;
        const double stretch = std::sqrt(1 + u * u + w * w);
        const double z = 1 / double(texel.q);
        const DepthInterval piece = piece_interval(texel, impostor.slicing);
        const DepthInterval walked = depth_interval(texel);
        const double reach = std::max({z - double(piece.front), double(piece.back) - z,
                                       z - double(walked.front), double(walked.back) - z});
        farthest = std::max(farthest, double(walked.back));
        steepest = std::max(steepest, stretch);
        stats.reach = std::max(stats.reach, reach * stretch);
      }
    stats.slice = std::max(stats.slice, half * steepest);
    stats.texel = std::max(stats.texel, 0.5 * farthest * std::hypot(dx, dy));
  }
  return stats;
}

bool is_served(const Box& bounds, const glm::dmat4& world_from_impostor, const Camera& frame) {
  const glm::dvec3 eye(glm::inverse(world_from_impostor) * glm::dvec4(frame.position(), 1));
  return glm::length(eye - glm::dvec3(bounds.center())) >= kServedRadii * double(bounds.radius());
}

LayeredError bound_layered_error_from(const LayeredErrorStats& stats, bool sliced,
                                      const Camera& frame, double distance) {
  return bound_at(stats, sliced, frame, distance, corner_tan(frame));
}

LayeredError bound_layered_error(const LayeredErrorStats& stats, bool sliced, const Box& bounds,
                                 const glm::dmat4& world_from_impostor, const Camera& frame) {
  const double scale = glm::length(glm::dvec3(world_from_impostor[0]));
  const glm::dvec3 eye(glm::inverse(world_from_impostor) * glm::dvec4(frame.position(), 1));
  const glm::dvec3 outside = glm::max(
      glm::max(glm::dvec3(bounds.min) - eye, eye - glm::dvec3(bounds.max)), glm::dvec3(0.0));
  return bound_at({stats.slice * scale, stats.reach * scale, stats.texel * scale}, sliced, frame,
                  scale * glm::length(outside), off_axis_tan(bounds, world_from_impostor, frame));
}

}  // namespace rilievo
