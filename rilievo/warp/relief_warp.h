// Where does a sample of a parallel picture with depth appear when seen from an eye? (S4.2)
//
// A relief's sample at texel position (u, v) with displacement d stands for the world point
// origin + u a + v b + d f. Seen from an eye in front of the plane d = 0, it covers the point
//
//   u' = (u + k1 d) / (1 + k3 d),   v' = (v + k2 d) / (1 + k3 d)
//
// of that plane. After the pre-warp has moved all samples there, a flat rectangle textured with the
// result, drawn in perspective, shows what the eye sees. Doubles; world space, metres; u, v in
// texels.
#pragma once

#include <optional>

#include "rilievo/core/camera.h"

namespace rilievo {

// The affine frame of a relief in world space.
struct ReliefFrame {
  glm::dvec3 origin{0.0};    // the point u = v = d = 0
  glm::dvec3 a{1.0, 0, 0};   // one texel to the right
  glm::dvec3 b{0, -1.0, 0};  // one texel down
  glm::dvec3 f{0, 0, -1.0};  // one metre deeper, unit

  [[nodiscard]] glm::dvec3 world(double u, double v, double d) const {
    return origin + u * a + v * b + d * f;
  }
};

// The frame of a parallel camera's raster positions, with d = eye_z - plane_z.
[[nodiscard]] ReliefFrame relief_frame(const Camera& camera, double plane_z);

// The warp for one eye: the coefficients of the formula above.
struct ReliefWarp {
  double k1 = 0, k2 = 0, k3 = 0;

  // The size of a thing at displacement d relative to the same thing on the plane d = 0. Positive
  // in front of the eye.
  [[nodiscard]] double magnification(double d) const { return 1 / (1 + k3 * d); }
  [[nodiscard]] glm::dvec2 moved(double u, double v, double d) const {
    return magnification(d) * glm::dvec2(u + k1 * d, v + k2 * d);
  }
  // The foot of the perpendicular from the eye onto the plane. Where one texel hides another, it is
  // the one nearer to this point.
  [[nodiscard]] glm::dvec2 epipole() const { return {k1 / k3, k2 / k3}; }
};

// The warp for `eye`; none if the eye is not in front of the plane (on the side that f points away
// from).
[[nodiscard]] std::optional<ReliefWarp> relief_warp(const ReliefFrame& frame,
                                                    const glm::dvec3& eye);

}  // namespace rilievo
