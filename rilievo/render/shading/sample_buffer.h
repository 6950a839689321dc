// Which triangle does each sample of a picture show, and how deep? (A visibility buffer.)
//
// One or four samples a texel, at OpenGL's usual places. Rows from the bottom; raster positions are
// in texels from the *lower* left corner. Depth is in [0, 1), the less the nearer; 1 is nothing.
// Triangles are numbered through all meshes of a picture.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <vector>

namespace rilievo {

struct SampleBuffer {
  int width = 0, height = 0, samples = 1;
  std::size_t stride = 0;  // samples from one row to the next
  std::vector<float> depth;
  std::vector<std::uint32_t> triangle;  // where depth < 1

  [[nodiscard]] static std::size_t bytes(int size, int samples);
  // A new picture, empty: depth 1 everywhere. `samples` is 1 or 4.
  void begin(int width, int height, int samples);

  // Of row y: `samples` entries a texel, one texel after the other.
  [[nodiscard]] std::size_t row(int y) const { return std::size_t(y) * stride; }
  [[nodiscard]] const float* depths(int y) const { return &depth[row(y)]; }
  [[nodiscard]] const std::uint32_t* triangles(int y) const { return &triangle[row(y)]; }
};

// Of a sample, in the unit square of its texel.
[[nodiscard]] glm::vec2 sample_position(int sample, int samples);

}  // namespace rilievo
