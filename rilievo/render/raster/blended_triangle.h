// The triangles of blended_tiles.h in the frame: which samples does one cover? Internal to
// render/raster.
//
// Corners are rounded to 1/256 of a pixel, as OpenGL does: edge functions are then whole numbers,
// and of two triangles that share an edge exactly one covers a sample on it.
#pragma once

#include <cstdint>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/render/raster/sample_raster.h"

namespace rilievo {

// In the frame; y points down.
struct BlendedTriangle {
  static constexpr int kUnit = 256;  // of a pixel

  std::int64_t x[3], y[3];         // kUnit a pixel, counter-clockwise where y points up
  double inverse_z, per_x, per_y;  // at the frame's upper left corner; of a pixel
  std::uint32_t number;            // as in PlacedMesh
  int x0, y0, x1, y1;              // pixels that it can cover: x0 <= x < x1
};

// Pixels x0 <= x < x1 and y0 <= y < y1.
struct PixelRange {
  int x0, y0, x1, y1;
};

// At most so large is 1 / eye_z of the triangle's plane there.
[[nodiscard]] float nearest_in(const BlendedTriangle& t, const PixelRange& range);

// Its edges: most pixels of a long triangle's bounds lie beside it, most of a large one's within.
class TriangleEdges {
 public:
  explicit TriangleEdges(const BlendedTriangle& t);

  // Does all of it lie beyond an edge?
  [[nodiscard]] bool beside(const PixelRange& range) const;
  // The samples of a pixel, 1 or 4, that it covers, as bits.
  [[nodiscard]] unsigned samples_in(int x, int y, int samples) const;

 private:
  // > 0 left of it; 0 on it, if it is the triangle's.
  struct Edge {
    std::int64_t at, per_x, per_y;

    [[nodiscard]] std::int64_t operator()(std::int64_t x, std::int64_t y) const {
      return at + per_x * x + per_y * y;
    }
  };
  Edge edges_[3];
};

// Appends one triangle, or the pieces of it that are not too far beside the frame, if they can be
// seen there. `indices`: of its corners.
void place_blended(const Camera& camera, int samples, const RasterInstance& in,
                   std::uint32_t number, const std::uint32_t* indices,
                   std::vector<BlendedTriangle>& placed);

}  // namespace rilievo
