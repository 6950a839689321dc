// The passes over texels of keyframes/make_keyframe.h. Internal: not a stable interface.
//
// From a captured picture to texels: bytes of its colours, inverses of its depths, and of each four
// quarters one texel.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

namespace rilievo {

// sRGB bytes R, G, B of linear light, R in the lowest bits, by a table that is exact to a quarter
// of a byte where the curve is steepest and better elsewhere. What is no number is black.
void srgb_bytes_of(const glm::vec4* linear, int count, std::uint32_t* bytes);

// 1 / eye_z; 0 where nothing is.
void inverses_of(const float* eye_z, int count, float* inverse_z);

// The two rows of quarters of a row of texels, from the top, with the rows above and below. Quarter
// -1 and the one behind the last are there, too.
struct QuarterRows {
  const std::uint32_t* colors[4];
  const float* inverse_z[4];
  const std::uint32_t* objects[2];  // of the two rows; null: none
};

// Where a row of texels is stored.
struct TexelRow {
  std::uint32_t* colors[2];  // two rows of quarters, with their Quarter codes
  float* inverse_z;
  std::uint32_t* objects;
};

// Joins the quarters of `texels` texels. Of their depths the second nearest counts, because where
// two of four show what is in front, it has half of the texel; a texel's depth is the mean of those
// on its surface. `smooth`: the sides of a quarter that show the same surface count a sixth each,
// about as much as a pixel's own width shows of them.
void join_quarters(const QuarterRows& rows, int texels, bool smooth, const TexelRow& out);

}  // namespace rilievo
