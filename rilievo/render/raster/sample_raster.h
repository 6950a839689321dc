// Which triangle is nearest at each sample of a picture?
//
// A rasteriser for pictures of very many small triangles: it only finds out what is seen; shading
// comes after, once for each texel and triangle (raster_picture.h). One or four samples a texel, at
// OpenGL's usual places. Raster positions are in texels from the *lower* left corner, depth is
// window_z in [0, 1]. SIMD on all cores; the same bytes for any number of threads and any
// instruction set. No OpenGL.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

namespace rilievo {

// Triangles of one mesh, placed. A vertex p is seen at (x, y, z) / w, each the product of a row
// with (p, 1); all w must be > 0: what reaches behind the eye must not be given.
struct RasterInstance {
  const glm::vec3* positions = nullptr;
  const std::uint32_t* indices = nullptr;  // three a triangle
  std::uint32_t triangles = 0;
  std::uint32_t first_name = 0;  // its triangles are called first_name, first_name + 1, ...
  glm::vec4 row_x, row_y, row_z, row_w;
  // Which faces are seen; front is counter-clockwise in the raster.
  bool front = true, back = false;
};

class SampleRaster {
 public:
  static constexpr int kMaxSize = 4096;  // texels a side

  // Memory that pictures of up to `size` texels a side take.
  [[nodiscard]] static std::size_t bytes(int size, int samples);

  // A new picture, empty: depth 1 everywhere. `samples` is 1 or 4.
  void begin(int width, int height, int samples);
  // Adds what the instances show; of equal depths the first one stays.
  void draw(std::span<const RasterInstance> instances);

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] int samples() const { return samples_; }
  // Of row y: `samples` entries a texel, one texel after the other. A depth of 1 is nothing.
  [[nodiscard]] const float* depths(int y) const { return &depth_[row(y)]; }
  [[nodiscard]] const std::uint32_t* names(int y) const { return &name_[row(y)]; }

  // Of a sample, in the unit square of its texel.
  [[nodiscard]] static glm::vec2 sample_position(int sample, int samples);

  // Triangles that are set up together, and by one thread.
  static constexpr std::uint32_t kRound = 16384, kPiece = 1024;
  static constexpr std::uint32_t kMostLanes = 16;  // of a vector

  // A structure of arrays: triangles that may cover a sample, ready to be rasterised.
  struct Triangles {
    enum Field { x0, y0, x1, y1, x2, y2, z0, z_per_x, z_per_y, z_min, z_max, kFields };
    std::vector<float> field[kFields];
    std::vector<std::uint32_t> name;
    std::vector<std::int32_t> low, high;  // the first and the last row of texels
  };

 private:
  struct Piece {
    std::uint32_t instance, first, count;  // triangles of the instance
    std::uint32_t place, kept;             // in Triangles
  };
  // Of a round, its last piece, and a vector after it.
  static constexpr std::size_t kPlaces = kRound + kPiece + kMostLanes;

  void draw_round(std::span<const RasterInstance> instances);
  [[nodiscard]] std::size_t row(int y) const { return std::size_t(y) * stride_; }

  int width_ = 0, height_ = 0, samples_ = 1;
  std::size_t stride_ = 0;  // samples from one row to the next
  std::vector<float> depth_;
  std::vector<std::uint32_t> name_;
  Triangles triangles_;
  std::vector<Piece> pieces_;
};

}  // namespace rilievo
