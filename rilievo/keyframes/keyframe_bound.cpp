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

}  // namespace

KeyframeBound bound_keyframes(std::span<const WarpedKeyframe> keyframes, const Camera& frame) {
  KeyframeBound bound;
  const double f = pixels_of_tangent(frame), t = largest_tangent(frame.window);
  bool first = true;
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
    bound.gap_px = first ? gap : std::min(bound.gap_px, gap);
    first = false;
  }
  return bound;
}

}  // namespace rilievo
