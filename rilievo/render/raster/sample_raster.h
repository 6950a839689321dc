// Which triangle is nearest at each sample of a picture?
//
// A rasteriser for pictures of very many small triangles: it only finds out what is seen, into a
// SampleBuffer; shading comes after, once for each texel and triangle (raster_picture.h). Depth is
// window_z. Masked triangles have holes: whether a sample lies in one, its own alpha says. SIMD on
// all cores; the same bytes for any number of threads and any instruction set. No OpenGL.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rilievo/render/shading/sample_buffer.h"
#include "rilievo/render/shading/surface_materials.h"

namespace rilievo {

// Where a mesh has holes: where its alpha is below the cutoff.
struct RasterMask {
  const SurfaceTexture* texture = nullptr;  // whose alpha counts; null: plain
  const glm::vec2* uv = nullptr;            // by vertex, of the texture's set; null: all zero
  const glm::vec4* colors = nullptr;        // by vertex, whose alpha counts; null: plain
  float alpha = 1, cutoff = 0;              // of the material
};

[[nodiscard]] RasterMask mask_of(const Mesh& mesh, const SurfaceMaterial& material);

// Triangles of one mesh, placed. A vertex p is seen at (x, y, z) / w, each the product of a row
// with (p, 1); all w must be > 0: what reaches behind the eye must not be given.
struct RasterInstance {
  const glm::vec3* positions = nullptr;
  const std::uint32_t* indices = nullptr;  // three a triangle
  std::uint32_t triangles = 0;
  std::uint32_t first_triangle = 0;  // of its triangles, in the SampleBuffer
  glm::vec4 row_x, row_y, row_z, row_w;
  // Which faces are seen; front is counter-clockwise in the raster.
  bool front = true, back = false;
  const RasterMask* mask = nullptr;  // if it has holes
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

  [[nodiscard]] const SampleBuffer& seen() const { return seen_; }

  // Triangles that are set up together, and by one thread.
  static constexpr std::uint32_t kRound = 16384, kPiece = 1024;
  static constexpr std::uint32_t kMaxLanes = 16;  // of a vector

  // A structure of arrays: triangles that may cover a sample, ready to be rasterised.
  struct Triangles {
    enum Field {
      x0,
      y0,
      x1,
      y1,
      x2,
      y2,
      z0,
      z_per_x,
      z_per_y,
      z_min,
      z_max,
      // Of masked triangles alone: 1 / w of each corner; 1: the last two were exchanged, else 0.
      per_w0,
      per_w1,
      per_w2,
      exchanged,
      kFields
    };
    std::vector<float> field[kFields];
    std::vector<std::uint32_t> triangle;  // as in the SampleBuffer
    std::vector<std::int32_t> low, high;  // the first and the last row of texels
  };

 private:
  struct Piece {
    std::uint32_t instance, first, count;  // triangles of the instance
    std::uint32_t place, kept;             // in Triangles
  };
  // Of a round, its last piece, and a vector after it.
  static constexpr std::size_t kCapacity = kRound + kPiece + kMaxLanes;

  void draw_round(std::span<const RasterInstance> instances);

  SampleBuffer seen_;
  Triangles triangles_;
  std::vector<Piece> pieces_;
};

}  // namespace rilievo
