// Into which cells are the directions to eyes divided, and which views are drawn for each?
//
// A cube around the centre of the bounds; each face has kEyeCellsASide by kEyeCellsASide cells,
// with borders at equal angles. Space of the capture. Pure, any thread.
#pragma once

#include <array>
#include <glm/glm.hpp>
#include <vector>

#include "rilievo/layered_impostor/draw_options.h"
#include "rilievo/layered_impostor/layered_impostor.h"

namespace rilievo {

// The cells along a side of a face.
inline constexpr int kEyeCellsASide = 4;
// All of them.
inline constexpr int kEyeCells = 6 * kEyeCellsASide * kEyeCellsASide;

// The cell's directions are the combinations of its corners with weights that are not negative.
struct EyeCell {
  glm::dvec3 middle{0.0};               // unit
  std::array<glm::dvec3, 4> corners{};  // on the plane corner.middle = 1
  double farthest = 1;                  // length of a corner
};
// The cell of this number. Computed once for all.
[[nodiscard]] const EyeCell& eye_cell(int cell);

// The cell that holds a direction, of any length.
[[nodiscard]] int eye_cell_of(const glm::dvec3& direction);

// For each view: may it be drawn for some eye in the cell, or its slices to fill holes?
[[nodiscard]] std::vector<bool> views_drawn_from(const LayeredImpostor& impostor,
                                                 const LayeredOptions& options, int cell);

}  // namespace rilievo
