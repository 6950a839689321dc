// Where does a sample of a picture with depth appear when seen from an eye? (S4.2)
//
// A parallel relief's sample at texel position (u, v) with displacement d stands for the world
// point origin + u a + v b + d f. Seen from an eye in front of the plane d = 0, it covers the point
//
//   u' = (u + k1 d) / (1 + k3 d),   v' = (v + k2 d) / (1 + k3 d)
//
// of that plane. After the pre-warp has moved all samples there, a flat rectangle textured with the
// result, drawn in perspective, shows what the eye sees.
//
// A perspective relief's displacement is d = -1 / eye_z, and its sample stands for the point
// origin + (f + u a + v b) / -d, origin being the eye that saw it. The same formula then gives the
// texel position, of a picture that looks in the same direction, in which any other eye sees it.
// Doubles; world space, metres; u, v in texels.
#pragma once

#include <limits>
#include <optional>

#include "rilievo/core/camera.h"

namespace rilievo {

// The frame of a relief in world space.
struct ReliefFrame {
  glm::dvec3 origin{0.0};    // the point u = v = d = 0; of a perspective relief its eye
  glm::dvec3 a{1.0, 0, 0};   // one texel to the right; of a perspective relief at eye_z 1
  glm::dvec3 b{0, -1.0, 0};  // one texel down
  glm::dvec3 f{0, 0, -1.0};  // one metre deeper, unit; of a perspective relief u = v = 0 at eye_z 1
  bool perspective = false;

  [[nodiscard]] glm::dvec3 world(double u, double v, double d) const {
    const glm::dvec3 aside = u * a + v * b;
    return perspective ? origin + (f + aside) / -d : origin + aside + d * f;
  }
  // From an eye towards the position (u', v') at which it sees samples.
  [[nodiscard]] glm::dvec3 ray(const glm::dvec3& eye, double u, double v) const {
    const glm::dvec3 aside = u * a + v * b;
    return perspective ? f + aside : origin + aside - eye;
  }
};

// The frame of a camera's raster positions, with d = eye_z - plane_z, or -1 / eye_z of a
// perspective one.
[[nodiscard]] ReliefFrame relief_frame(const Camera& camera, double plane_z);

// The warp for one eye: the coefficients of the formula above.
struct ReliefWarp {
  double k1 = 0, k2 = 0, k3 = 0;

  // The size of a thing at displacement d relative to the same thing on the plane d = 0, or in the
  // picture of a perspective relief. Positive in front of the eye.
  [[nodiscard]] double magnification(double d) const { return 1 / (1 + k3 * d); }
  [[nodiscard]] glm::dvec2 moved(double u, double v, double d) const {
    return magnification(d) * glm::dvec2(u + k1 * d, v + k2 * d);
  }
  // The foot of the perpendicular from the eye onto the plane; where a perspective relief shows the
  // eye. Where one texel hides another, it is the one nearer to this point, or farther from it if
  // k3 < 0: for eyes that have moved back from a perspective relief's.
  [[nodiscard]] glm::dvec2 epipole() const { return {k1 / k3, k2 / k3}; }
  // Displacements of what an eye sees no more than `most` times enlarged begin here, if not all do:
  // what lies before is too near, or behind the eye.
  [[nodiscard]] double least_d(double most) const {
    return k3 > 0 ? (1 / most - 1) / k3 : -std::numeric_limits<double>::infinity();
  }
};

// The warp for `eye`; none if the eye is not in front of the plane (on the side that f points away
// from). Perspective reliefs have one for every eye.
[[nodiscard]] std::optional<ReliefWarp> relief_warp(const ReliefFrame& frame,
                                                    const glm::dvec3& eye);

}  // namespace rilievo
