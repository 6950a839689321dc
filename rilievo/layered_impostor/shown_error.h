// At what angle does an eye see a drawn point beside the place that its colour tells?
//
// Colours come from samples, which are points of the true surface. Slices show the colour of one
// sample, over its texel and over the depths of its patch; the ray march interpolates between
// linked samples, and tells the same mean of their places. A table has the largest angle for each
// range of directions to the eye and of distances, over all texels of the views that are drawn for
// such eyes. Most of a displacement lies along the lines of sight of its picture, so that how large
// it appears depends on the eye.
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

// A bound of sines of angles. The directions to eyes are divided by a cube whose faces have kSide
// by kSide cells. The nearness is the radius of the bounds by the eye's distance from the centre,
// along the middle of the cell; between nodes, values are interpolated.
struct ShownErrorTable {
  static constexpr int kNodes = 5;
  static constexpr std::array<double, kNodes> kNearness{0, 0.3, 0.55, 0.75, 0.9};
  static constexpr std::uint8_t kNever = 255;  // no bound

  std::array<float, kNodes> unit{};
  // In units. Times the nearness, this is the sine.
  std::array<std::array<std::uint8_t, kNodes>, kEyeCells> units{};
};

// Makes the table for the views that are drawn with these options.
[[nodiscard]] ShownErrorTable make_shown_error_table(const LayeredImpostor& impostor,
                                                     const LayeredOptions& options);

// The bound for an eye; infinite for one that is too near.
[[nodiscard]] double shown_error_sine(const ShownErrorTable& table, const glm::dvec3& eye);
// The bound for all eyes at least `distance` radii from the centre.
[[nodiscard]] double shown_error_sine_from(const ShownErrorTable& table, double distance);

}  // namespace rilievo
