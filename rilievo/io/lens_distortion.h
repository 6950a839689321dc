// Lenses that are no pinholes, and how they bend a picture.
//
// With a = x / z and b = y / z of a point (x right, y down, z forwards) and r^2 = a^2 + b^2, a
// pinhole shows it at (fl_x a + cx, fl_y b + cy), a lens at (fl_x a' + cx, fl_y b' + cy):
//   radial   OpenCV: a' = a s + 2 p1 a b + p2 (r^2 + 2 a^2), b' = b s + p1 (r^2 + 2 b^2) + 2 p2 a
//   b,
//            s = (1 + k1 r^2 + k2 r^4 + k3 r^6) / (1 + k4 r^2 + k5 r^4 + k6 r^6)
//   series   the same with s = 1 + k1 r^2 + k2 r^4 + k3 r^6 + k4 r^8 (nerfstudio)
//   fisheye  OpenCV: with t = atan r, a' = a t (1 + k1 t^2 + k2 t^4 + k3 t^6 + k4 t^8) / r, and b'
//            from b as a' from a
#pragma once

#include <array>
#include <glm/glm.hpp>

namespace rilievo {

// The coefficients of a lens.
struct LensDistortion {
  enum class Model { none, radial, series, fisheye } model = Model::none;
  std::array<double, 6> k{};
  std::array<double, 2> p{};
};

// (a', b') of (a, b).
[[nodiscard]] glm::dvec2 distorted(const LensDistortion& lens, const glm::dvec2& point);

// The radius r up to which the formula's radius grows with r; beyond, it would fold the picture.
// At most `farthest`.
[[nodiscard]] double largest_radius(const LensDistortion& lens, double farthest);

}  // namespace rilievo
