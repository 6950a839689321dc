// The triangle of each sample of a picture, and its depth: a visibility buffer.
//
// One or four samples per texel, at OpenGL's usual positions. Rows from the bottom; raster
// positions are in texels from the *lower* left corner. Depth is in [0, 1), smaller is nearer; 1
// means nothing. Triangles are numbered through all meshes of a picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>

#include "rilievo/core/large_buffer.h"

namespace rilievo {

// The visibility buffer of a picture.
struct SampleBuffer {
  int width = 0, height = 0, samples = 1;
  std::size_t stride = 0;  // samples in a row
  LargeBuffer<float> depth;
  LargeBuffer<std::uint32_t> triangle;  // valid where depth < 1

  // The memory for pictures of up to `size` texels a side.
  [[nodiscard]] static std::size_t bytes(int size, int samples);
  // Starts an empty picture: depth 1 everywhere. `samples` is 1 or 4.
  void begin(int width, int height, int samples);

  // Row y has `samples` entries for each texel, one texel after the other.
  [[nodiscard]] std::size_t row(int y) const { return std::size_t(y) * stride; }
  [[nodiscard]] const float* depths(int y) const { return &depth[row(y)]; }
  [[nodiscard]] const std::uint32_t* triangles(int y) const { return &triangle[row(y)]; }
};

// The position of a sample in the unit square of its texel.
[[nodiscard]] glm::vec2 sample_position(int sample, int samples);

}  // namespace rilievo
