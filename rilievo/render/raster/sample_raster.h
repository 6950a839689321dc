// Which triangle, line or point is nearest at each sample of a picture?
//
// A rasteriser for pictures of very many small triangles, or points; lines and points count as
// triangles below. It only fills a SampleBuffer (a
// visibility buffer); shading comes later, once for each pair of a texel and a triangle
// (raster_picture.h). What lies behind all that a block of the picture shows is left out early, as
// in [Greene, Kass and Miller 1993, Hierarchical Z-Buffer Visibility]. Depth is window_z. Masked
// triangles have holes: a sample lies in one if the alpha there is below the cutoff. SIMD on all
// cores; the result depends neither on the number of threads nor on the instruction set. No OpenGL.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rilievo/core/bounds.h"
#include "rilievo/render/object_work.h"
#include "rilievo/render/raster/farthest_blocks.h"
#include "rilievo/render/shading/sample_buffer.h"
#include "rilievo/render/shading/surface_materials.h"

namespace rilievo {

// The mask of a mesh: it has holes where its alpha is below the cutoff.
struct RasterMask {
  const SurfaceTexture* texture = nullptr;  // with the alpha; null: none
  const glm::vec2* uv = nullptr;            // for each vertex, of the texture's set; null: all zero
  const glm::vec4* colors = nullptr;        // for each vertex, with alpha; null: none
  float alpha = 1, cutoff = 0;              // of the material
};

// The mask of a mesh with a masked material.
[[nodiscard]] RasterMask mask_of(const Mesh& mesh, const SurfaceMaterial& material);

// How points and lines are drawn, of a camera's picture.
struct RasterStrokes {
  float radius = 0;  // of points, metres of the world; 0: radius_px, which is that of lines
  float radius_px = 0.5f;
  glm::vec2 per_unit{1.0f};   // texels; of a tangent, or of a metre of a parallel camera
  glm::vec2 corner{0.0f};     // the tangents of the raster's origin
  float z_per_inverse_w = 0;  // z / w = a constant + this / w
  bool parallel = false;
  bool clamps = false;  // what lies in front of the near plane is drawn on it
};

// The primitives of one mesh, placed. A vertex p appears at (x, y, z) / w, each the product of a
// row with (p, 1). Triangles with a corner whose w is not positive are left out (near_clip.h cuts
// them).
struct RasterInstance {
  const glm::vec3* positions = nullptr;
  const std::uint32_t* indices = nullptr;  // three for each triangle, two for each line
  Primitive primitive = Primitive::triangles;
  RasterStrokes strokes;
  std::uint32_t triangles = 0;       // or points or lines
  std::uint32_t first_triangle = 0;  // primitive index of its first triangle in the SampleBuffer
  // If not null: the primitive index of each of its triangles instead.
  const std::uint32_t* numbers = nullptr;
  glm::vec4 row_x, row_y, row_z, row_w;
  // The visible faces; front is counter-clockwise in the raster.
  bool front = true, back = false;
  const RasterMask* mask = nullptr;  // null: no holes
  // Bounds of each kPiece of its triangles, or none: pieces that cannot be seen are left out.
  std::span<const Box> boxes;
  float min_w = 0;  // triangles with a corner that is not beyond it are left out
  // Covers only texels whose hash (shader::kPixelHash) lies in [share_from, share_to).
  float share_from = 0, share_to = 1;
};

// Rasterises into a visibility buffer.
class SampleRaster {
 public:
  static constexpr int kMaxSize = 4096;  // texels a side

  // The memory for pictures of up to `size` texels a side.
  [[nodiscard]] static std::size_t bytes(int size, int samples);

  // Starts an empty picture: depth 1 everywhere. `samples` is 1 or 4; staggered: 1.
  void begin(int width, int height, int samples, bool staggered = false);
  // Draws instances; of equal depths, the first one stays.
  void draw(std::span<const RasterInstance> instances);

  [[nodiscard]] const SampleBuffer& seen() const { return seen_; }
  // Of each instance of the last draw(). Depends on nothing but what was drawn since begin().
  [[nodiscard]] std::span<const MeshWork> work() const { return work_; }

  // The numbers of triangles that are set up together, and by one thread.
  static constexpr std::uint32_t kRound = 16384, kPiece = 1024;
  static constexpr std::uint32_t kMaxLanes = 16;  // of a vector

  // Triangles that can cover a sample, ready to be rasterised. A structure of arrays.
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
      // Of masked triangles only: 1 / w of each corner; whether the last two corners were exchanged
      // (1 or 0).
      per_w0,
      per_w1,
      per_w2,
      exchanged,
      kFields
    };
    std::vector<float> field[kFields];
    std::vector<std::uint32_t> index;     // in the instance
    std::vector<std::int32_t> low, high;  // the first and the last row of texels
    // Of a small triangle: the places in the SampleBuffer of samples that it changes, or kNone, and
    // its depths there; it needs no field. The first place of a larger one is kLarge.
    static constexpr int kSmallSamples = 4;
    static constexpr std::int32_t kNone = -1, kLarge = -2;
    std::vector<std::int32_t> sample[kSmallSamples];
    std::vector<float> sample_z[kSmallSamples];
  };

 private:
  struct Piece {
    std::uint32_t instance, first, count;  // triangles of the instance
    std::uint32_t place, kept;             // in Triangles
    std::int32_t low, high;                // their first and last row of texels
  };
  // Of a round, its last piece, and a vector after it.
  static constexpr std::size_t kCapacity = kRound + kPiece + kMaxLanes;

  // Rows that one thread fills at a time.
  static constexpr int kStrip = FarthestBlocks::kLarge;

  void draw_round(std::span<const RasterInstance> instances);

  SampleBuffer seen_;
  FarthestBlocks farthest_;
  std::vector<std::uint64_t> waiting_;  // of each strip: triangles filled since its last update
  std::vector<MeshWork> work_;
  Triangles triangles_;
  std::vector<Piece> pieces_;
};

}  // namespace rilievo
