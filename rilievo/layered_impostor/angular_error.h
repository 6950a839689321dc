// How far, as an angle seen by the eye, is a drawn point from the surface point whose colour it
// has?
//
// Samples are points of the true surface. Slices give the colour of one sample to its whole texel,
// over all depths of its patch; the ray march interpolates colours between linked samples. The
// *source* of a colour is its sample, or the mean position of the samples by the same weights. A
// table has the largest angle between drawn points and their sources, for each range of directions
// and of distances of the eye, over all texels of the views that are drawn for such eyes. Most of a
// displacement lies along the lines of sight of its picture, so how large it appears depends on the
// eye.
//
// Eyes are relative to the centre of the impostor's bounds, in radii of the bounds, in the space of
// the capture. Plain data. Pure, any thread; does not depend on the number of threads.
#pragma once

#include <array>
#include <cstdint>
#include <glm/glm.hpp>

#include "rilievo/layered_impostor/draw_options.h"
#include "rilievo/layered_impostor/eye_cells.h"
#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo {

// An upper bound of the sine of that angle, for each cell of directions to the eye (eye_cells.h),
// at a few values of the nearness: the radius of the bounds divided by the eye's distance from the
// centre, along the middle of the cell. Between them the bound is interpolated.
struct AngularErrorTable {
  static constexpr int kNodes = 5;
  static constexpr std::array<double, kNodes> kNearness{0, 0.3, 0.55, 0.75, 0.9};
  static constexpr std::uint8_t kNever = 255;  // no bound

  // The sine is the nearness times unit times units.
  std::array<float, kNodes> unit{};
  std::array<std::array<std::uint8_t, kNodes>, kEyeCells> units{};
};

// Makes the table for the views that are drawn with these options. Looks at each texel.
[[nodiscard]] AngularErrorTable make_angular_error_table(const LayeredImpostor& impostor,
                                                         const LayeredOptions& options);

// The bound for an eye; infinite for one that is nearer than the table's last node.
[[nodiscard]] double angular_error_sine(const AngularErrorTable& table, const glm::dvec3& eye);
// The bound for all eyes at least `distance` radii from the centre.
[[nodiscard]] double angular_error_sine_from(const AngularErrorTable& table, double distance);

}  // namespace rilievo
