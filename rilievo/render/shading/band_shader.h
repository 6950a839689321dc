// The colours of a picture's texels whose samples are known.
//
// Shades each triangle once in each texel where it is visible (seen_triangles.h), and averages over
// the samples, as OpenGL does with several samples per pixel. The samples come from the rasteriser
// or from rays. Internal to render/raster and render/rays.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rilievo/render/shading/sample_buffer.h"
#include "rilievo/render/shading/seen_triangles.h"

namespace rilievo {

// The data that is the same for all texels of a picture.
struct PictureView {
  const SampleBuffer& samples;
  ShadedScene scene;
};

// Shades a few rows of texels at a time. Keeps its buffers; use one object for each thread.
class BandShader {
 public:
  static constexpr int kBand = 8;  // rows at most

  // Shades rows [from, to), at most kBand.
  void shade(const PictureView& view, int from, int to);

  // For the band's texels, row by row: the sum of the colours of covered samples, the number of
  // covered samples, and the nearest depth.
  [[nodiscard]] std::span<const glm::vec3> color_sums() const { return sums_; }
  // ... and how many these are.
  [[nodiscard]] std::span<const std::uint8_t> covered() const { return covered_; }
  [[nodiscard]] std::span<const float> nearest() const { return nearest_; }

 private:
  template <int samples>  // of a texel
  void find_seen(const PictureView& view, int y, int row);

  SeenTriangles seen_;
  std::vector<glm::vec3> sums_;
  std::vector<std::uint8_t> covered_;
  std::vector<float> nearest_;
};

}  // namespace rilievo
