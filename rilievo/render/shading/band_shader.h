// What colour has each texel of a picture whose samples are known?
//
// Shades each triangle once in each texel where it is visible, at the texel's centre, and averages
// over the samples, as OpenGL does with several samples per pixel. The samples come from the
// rasteriser or from rays. Internal to render/raster and render/rays.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rilievo/render/shading/sample_buffer.h"
#include "rilievo/render/shading/surface_points.h"
#include "rilievo/render/shading/surface_shading.h"

namespace rilievo {

// A mesh in a picture.
struct PlacedMesh {
  const Mesh* mesh = nullptr;
  SurfacePlacement surface;
  // The range of its triangles in the SampleBuffer.
  std::uint32_t first_triangle = 0, triangles = 0;
  std::uint32_t object = 0;  // index into Scene::objects
};

// The data that is the same for all texels of a picture.
struct PictureView {
  const SampleBuffer& samples;
  std::span<const PlacedMesh> meshes;  // in the order of their triangles
  PictureRays rays;
  SurfaceLights lights;
  ColorScale scale = ColorScale::srgb;
  // If not null: the colour of each covered sample, as bytes, the first one in the lowest bits,
  // premultiplied by alpha, which is 255 unless the material blends, goes to the sample's place in
  // the SampleBuffer's rows, and there are no color_sums(). Requires ColorScale::srgb.
  std::uint32_t* sample_colors = nullptr;
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
  static constexpr std::uint32_t kNone = 0xFFFFFFFFu;

  // A triangle in a texel.
  struct Seen {
    std::uint32_t triangle;  // of its mesh
    std::uint32_t next;      // index of another one of its mesh, or kNone
    std::uint16_t x, row;    // texel of the band
    std::uint16_t samples;
  };
  // Of a surface that waits to be shaded.
  struct Waiting {
    std::size_t texel;         // of the band
    std::size_t first_sample;  // of the texel, in the SampleBuffer
    float samples;
    std::uint32_t triangle;  // of the SampleBuffer
  };

  template <int samples>  // of a texel
  void find_seen(const PictureView& view, int y, int row);
  void add_seen(const PictureView& view, std::uint32_t triangle, int x, int row, int samples);
  void add_mesh(const PictureView& view, const PlacedMesh& placed, std::uint32_t first, int from);
  void append(const PictureView& view, const PlacedMesh& placed);
  void flush(const PictureView& view);
  template <std::size_t samples>
  void write_samples(const PictureView& view) const;

  std::vector<Seen> seen_;
  std::vector<std::uint32_t> first_of_;  // by mesh: index into seen_, or kNone
  std::vector<std::uint32_t> met_;       // meshes that are seen
  std::uint32_t mesh_ = 0;               // the last one met
  TriangleRays rays_;
  Surfaces surfaces_;
  SurfaceColors colors_;
  Waiting waiting_[Surfaces::kMaxCount];  // of the surfaces
  std::vector<glm::vec3> sums_;
  std::vector<std::uint8_t> covered_;
  std::vector<float> nearest_;
};

}  // namespace rilievo
