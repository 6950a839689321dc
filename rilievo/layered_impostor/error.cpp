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
//
// The total is by the angle itself (angular_error.cpp), which is smaller: of the way along the line
// of sight the eye sees the part across its own.

#include "rilievo/layered_impostor/error.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "rilievo/core/expects.h"
#include "rilievo/layered_impostor/slice_quads.h"
#include "rilievo/warp/parallax.h"

namespace rilievo {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
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
// `angular_sine`: what the table says.
LayeredError bound_at(const LayeredErrorStats& stats, double scale, const Camera& frame,
                      double distance, double off_axis_tan, double angular_sine) {
  RILIEVO_EXPECTS(frame.projection == Projection::perspective);
  LayeredError error;
  error.surface_m = stats.sliced ? scale * (stats.slice + 2 * stats.texel) : 0;
  error.sample_m = scale * ((stats.sliced ? stats.slice : 0) + stats.reach + stats.texel);
  const auto pixels = [&](double sine) {
    if (sine == 0) return 0.0;
    return sine < 1 ? pixels_from_angle(frame, off_axis_tan, std::asin(sine)) : kNever;
  };
  error.surface_px = error.surface_m == 0 ? 0 : pixels(error.surface_m / distance);
  error.sample_px = pixels(error.sample_m / distance);
  // Polygons are off by half a pixel's diagonal too.
  error.total_px = std::max(0.0, pixels(angular_sine) - std::sqrt(0.5));
  if (stats.strokes.any())
    error.total_px +=
        pixels(scale * stats.strokes.disc_radius / distance) +
        strip_difference_px(stats.strokes.texels, pixels(scale * stats.texel / distance));
  return error;
}

// In the impostor's space; and from the centre of the bounds, in radii.
glm::dvec3 placed_eye(const glm::dmat4& world_from_impostor, const Camera& frame) {
  return glm::dvec3(glm::inverse(world_from_impostor) * glm::dvec4(frame.position(), 1));
}
glm::dvec3 relative_to(const Box& bounds, const glm::dvec3& eye) {
  return (eye - glm::dvec3(bounds.center())) / double(bounds.radius());
}
bool serves(const glm::dvec3& relative_eye) { return glm::length(relative_eye) >= kServedRadii; }

}  // namespace

LayeredErrorStats layered_error_stats(const LayeredImpostor& impostor,
                                      const LayeredOptions& options) {
  LayeredErrorStats stats;
  stats.sliced = options.method == LayeredMethod::slices;
  stats.strokes = impostor.strokes;
  stats.angular = make_angular_error_table(impostor, options);
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

LayeredError bound_layered_error_from(const LayeredErrorStats& stats, const Box& bounds,
                                      const Camera& frame, double distance) {
  // The box holds its centre.
  const double radii = distance / double(bounds.radius());
  return bound_at(stats, 1, frame, distance, corner_tan(frame),
                  angular_error_sine_from(stats.angular, radii));
}

LayeredError bound_layered_error(const LayeredErrorStats& stats, const Box& bounds,
                                 const glm::dmat4& world_from_impostor, const Camera& frame) {
  const double scale = glm::length(glm::dvec3(world_from_impostor[0]));
  const glm::dvec3 eye = placed_eye(world_from_impostor, frame),
                   relative = relative_to(bounds, eye);
  const glm::dvec3 outside = glm::max(
      glm::max(glm::dvec3(bounds.min) - eye, eye - glm::dvec3(bounds.max)), glm::dvec3(0.0));
  return bound_at(stats, scale, frame, scale * glm::length(outside),
                  off_axis_tan(bounds, world_from_impostor, frame),
                  serves(relative) ? angular_error_sine(stats.angular, relative) : kNever);
}

}  // namespace rilievo
