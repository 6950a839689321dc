#include "rilievo/keyframes/keyframe_bound.h"

#include <algorithm>
#include <cmath>
#include <glm/glm.hpp>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

double pixels_of_tangent(const Camera& camera) {
  return camera.width / (camera.window.right - camera.window.left);
}

// Of the frame's corners: the largest distance from its axis on the plane z = -1.
double largest_tangent(const ImageWindow& w) {
  return std::hypot(std::max(std::abs(w.left), std::abs(w.right)),
                    std::max(std::abs(w.bottom), std::abs(w.top)));
}

double nearest_of(const Keyframe& key) {
  float nearest = 0;
  for (const InverseRange& block : key.blocks.texels()) nearest = std::max(nearest, block.nearest);
  return nearest;
}

// Does the keyframe see all that the frame's eye sees, from 1 / eye_z `nearest` on? Places are
// ratios of affine functions: their extremes are at corners.
bool sees_all(const Keyframe& key, const Camera& frame, double nearest) {
  const RasterMap map = raster_map(key.camera, frame);
  for (int i = 0; i < 8; ++i) {
    const double x = i & 1 ? frame.width : 0, y = i & 2 ? frame.height : 0, w = i & 4 ? nearest : 0;
    const auto row = [&](const float(&r)[4]) { return r[0] * x + r[1] * y + r[2] + r[3] * w; };
    const double z = row(map.z), at_x = row(map.x), at_y = row(map.y);
    // Rounding must not make it narrower.
    const double slack = 1e-3 * z;
    if (!(z > 0 && at_x >= -slack && at_x <= z * key.camera.width + slack && at_y >= -slack &&
          at_y <= z * key.camera.height + slack))
      return false;
  }
  return true;
}

}  // namespace

KeyframeBound bound_keyframes(std::span<const WarpedKeyframe> keyframes, const Camera& frame) {
  KeyframeBound bound;
  const double f = pixels_of_tangent(frame), t = largest_tangent(frame.window);
  double widest = 0, narrowest = HUGE_VAL;
  for (const WarpedKeyframe& one : keyframes) {
    RILIEVO_EXPECTS(one.keyframe != nullptr);
    const Camera& camera = one.keyframe->camera;
    const double b = glm::length(camera.position() - frame.position());
    // A distance along one axis is at most one from the eye; texels are seen within the keyframe's
    // own corners, where an eye_z is as much smaller than the distance.
    const double corner = std::hypot(1, largest_tangent(camera.window));
    const double w = nearest_of(*one.keyframe) * corner;
    // Nearest things, from the frame's eye: of those that it can draw.
    const double before = 1 / frame.z_near;
    const double nearest =
        b == 0 ? std::min(w, before) : (b * w < 1 ? std::min(w / (1 - b * w), before) : before);
    const double slack = kSameSurfaceDepth * nearest * b;
    const double larger = b * w < 1 ? 1 / (1 - b * w) : kMostMagnified;
    const double m = f / pixels_of_tangent(camera) * (1 + t * t) *
                     std::min(std::max(larger, 1.0), double(kMostMagnified));
    const double along = slack < 1 ? f * (1 + t) * slack / (1 - slack) : HUGE_VAL;
    bound.error_px = std::max(bound.error_px, std::sqrt(2.0) * m + along);
    const double gap = f * (1 + t) * nearest * b;
    widest = std::max(widest, gap);
    if (sees_all(*one.keyframe, frame, nearest)) narrowest = std::min(narrowest, gap);
  }
  bound.gap_px = std::min(widest, narrowest);
  return bound;
}

}  // namespace rilievo
