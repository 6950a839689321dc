// The triangle of each sample of a picture, and its depth: a visibility buffer.
//
// One or four samples per texel, at OpenGL's usual positions, or one that is staggered. Rows from
// the bottom; raster positions are in texels from the *lower* left corner. Depth is in [0, 1),
// smaller is nearer; 1 means nothing. Triangles are numbered through all meshes of a picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>

#include "rilievo/core/large_buffer.h"

namespace rilievo {

// The visibility buffer of a picture.
struct SampleBuffer {
  int width = 0, height = 0, samples = 1;
  bool staggered = false;  // the one sample of a texel lies at staggered_position()
  std::size_t stride = 0;  // samples in a row
  LargeBuffer<float> depth;
  LargeBuffer<std::uint32_t> triangle;  // valid where depth < 1

  // The memory for pictures of up to `size` texels a side.
  [[nodiscard]] static std::size_t bytes(int size, int samples);
  // Starts an empty picture: depth 1 everywhere. `samples` is 1 or 4; staggered: 1.
  void begin(int width, int height, int samples, bool staggered = false);

  // Row y has `samples` entries for each texel, one texel after the other.
  [[nodiscard]] std::size_t row(int y) const { return std::size_t(y) * stride; }
  [[nodiscard]] const float* depths(int y) const { return &depth[row(y)]; }
  [[nodiscard]] const std::uint32_t* triangles(int y) const { return &triangle[row(y)]; }
};

// The position of a sample in the unit square of its texel.
[[nodiscard]] glm::vec2 sample_position(int sample, int samples);

// Staggered samples lie so many texels beside their texels' middles, in x and in y. Those of two by
// two texels are then in different columns and different rows, evenly, as the four samples of one
// texel are: an edge along a row or a column passes them one after the other, not two at a time.
// Exact in binary, so that places that are computed in different ways are the same.
inline constexpr float kStagger = 0.1875f;
// The position of the sample of texel (x, y) in the texel's unit square.
[[nodiscard]] constexpr glm::vec2 staggered_position(int x, int y) {
  return {0.5f + (y % 2 == 0 ? kStagger : -kStagger), 0.5f + (x % 2 == 0 ? -kStagger : kStagger)};
}

}  // namespace rilievo
