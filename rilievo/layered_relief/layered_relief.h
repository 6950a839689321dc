// What is a layered relief? A layered depth image stored so that it can be warped fast (S4.3,
// S4.6).
//
// Source space: the texel position (u, v) in a parallel camera's raster, and the displacement d
// (metres, positive is deeper) from the source plane, which stands at eye_z == plane_z in the
// middle of the samples' depths; of a perspective camera d = -1 / eye_z (warp/relief_warp.h). A
// displacement is stored as a 16-bit code: d = first_d + code * d_step.
//
// A sample is 8 bytes, so that warping it is copying it. Each tile stores its samples four times,
// in the four occlusion-compatible orders. If the eye's foot on the source plane (the epipole) lies
// to the right of and below a tile, the tile's samples must be drawn from left to right and from
// top to bottom, those of one texel from the deepest to the nearest; each overwrites what it
// covers, and no depths are compared.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "rilievo/core/depth_image.h"
#include "rilievo/warp/relief_warp.h"

namespace rilievo {

// A sample, and also a texel of the warp's result, in which empty texels have kEmptyCode.
struct ReliefSample {
  std::uint32_t place;  // u in its tile | v in its tile << 8 | code of d << 16
  std::uint32_t
      color;  // sRGB, then premultiplied: r | g << 8 | b << 16 | a << 24; or an identifier

  [[nodiscard]] std::uint32_t u() const { return place & 0xff; }
  [[nodiscard]] std::uint32_t v() const { return place >> 8 & 0xff; }
  [[nodiscard]] std::uint32_t code() const { return place >> 16; }
  friend bool operator==(const ReliefSample&, const ReliefSample&) = default;
};
// The code of an empty texel, and the largest code of a displacement.
inline constexpr std::uint32_t kEmptyCode = 0xffff, kLargestCode = kEmptyCode - 1;

// The range of codes in a node of the quad-tree: a tile, or four smaller nodes.
struct ReliefNode {
  std::uint16_t nearest = kEmptyCode, farthest = 0;  // codes; nearest > farthest: no samples
  [[nodiscard]] bool empty() const { return nearest > farthest; }
};

// The order of a stream. Without either bit, u and v ascend.
enum ReliefOrder : unsigned { kDescendingU = 1, kDescendingV = 2 };

// A layered relief.
struct LayeredRelief {
  std::string name;
  Camera camera;       // parallel or perspective; the capture's
  double plane_z = 1;  // of a parallel one
  double first_d = 0, d_step = 0;

  int tile_size = 32;  // texels a side: a power of two, at most 256
  int tiles_x = 0, tiles_y = 0;
  int levels = 0;  // of the quad-tree, at least 1
  // The quad-tree. The children of node n are 4 n + 1 ... 4 n + 4, in the order of ReliefOrder's
  // bits (right: 1, lower: 2). Nodes of the last level are tiles; some lie outside the image.
  std::vector<ReliefNode> tree;
  // Samples first[t] ... first[t + 1] of each stream belong to tile t (row by row).
  std::vector<std::uint32_t> first;
  // In streams with ascending v, row v of tile t begins at sample
  // first[t] + rows[t * (tile_size + 1) + v].
  std::vector<std::uint32_t> rows;
  std::array<std::vector<ReliefSample>, 4> streams;  // by order; padded, so that blocks can be read
  // Source positions (u, v, d) whose convex hull contains every texel that a sample covers.
  std::vector<glm::dvec3> hull;
  // The largest displacement of a sample in depth, in metres, by merging and by rounding to a code.
  // Part of the error bound.
  double merged_d = 0;
  // Splats are so many times as large as the options of the pre-warp say (relief_splat_scale).
  double splat_scale = 1;

  [[nodiscard]] std::size_t samples() const { return first.empty() ? 0 : first.back(); }
  [[nodiscard]] bool perspective() const { return camera.projection == Projection::perspective; }
  [[nodiscard]] double d_of(double eye_z) const {
    return perspective() ? -1 / eye_z : eye_z - plane_z;
  }
  [[nodiscard]] double d(std::uint32_t code) const { return first_d + double(code) * d_step; }
  [[nodiscard]] double nearest_d() const { return first_d; }
  [[nodiscard]] double farthest_d() const { return first_d + double(kLargestCode) * d_step; }
  [[nodiscard]] ReliefFrame frame() const { return relief_frame(camera, plane_z); }
};

// What to merge.
struct LayeredReliefOptions {
  int tile_size = 32;
  // Samples of one line of sight within this distance become one; metres, of a perspective picture
  // in the unit of its depths.
  double merge = 0.0;
  // Translucent samples are gathered along the line of sight until their opacity reaches this.
  float least_alpha = 0.5f;
  // The number of slices from which the hull is computed; more give a tighter hull.
  int hull_slices = 8;
  // Samples carry their object's identifier instead of a colour.
  bool identifiers = false;
};

// Builds a relief. Requires a valid parallel or perspective picture; of a perspective one samples
// have a finite eye_z. Fails if it has no samples, or 2^32 or more.
[[nodiscard]] Result<LayeredRelief> build_layered_relief(const LayeredDepthImage& layers,
                                                         const LayeredReliefOptions& options = {});

// The memory of a relief, bytes.
[[nodiscard]] std::size_t bytes(const LayeredRelief& relief);

// Checks that each index is in range and each tile's depths lie within its node's.
[[nodiscard]] Result<> validate(const LayeredRelief& relief);

}  // namespace rilievo
