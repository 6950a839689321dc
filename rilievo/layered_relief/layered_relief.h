// The layered relief: a layered depth image, kept so that it can be warped fast (S4.3, S4.6).
//
// Source space: texel position (u, v) of a parallel camera's raster, and displacement d (metres,
// deeper is more) from the source plane, which stands at eye_z == plane_z in the middle of the
// samples' depths. A displacement is a code of 16 bits: d = first_d + code * d_step.
//
// A sample is 8 bytes, so that warping it is copying it. Samples lie tile by tile, each tile four
// times, in the four orders that are occlusion-compatible: with the eye's foot on the source plane
// (the epipole) to the right of and below a tile, its samples must be drawn from the left and from
// above, those of a texel from the deepest to the nearest, and each overwrites what it covers.
// There is no depth to be compared.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "rilievo/core/depth_image.h"
#include "rilievo/warp/relief_warp.h"

namespace rilievo {

// Its bytes are also a texel of the warp's result; a texel that nothing covers has kEmptyCode.
struct ReliefSample {
  std::uint32_t place;  // u in its tile | v in its tile << 8 | code of d << 16
  std::uint32_t color;  // sRGB, then premultiplied: r | g << 8 | b << 16 | a << 24

  [[nodiscard]] std::uint32_t u() const { return place & 0xff; }
  [[nodiscard]] std::uint32_t v() const { return place >> 8 & 0xff; }
  [[nodiscard]] std::uint32_t code() const { return place >> 16; }
  friend bool operator==(const ReliefSample&, const ReliefSample&) = default;
};
inline constexpr std::uint32_t kEmptyCode = 0xffff, kLargestCode = kEmptyCode - 1;

// Of a stretch of the source: a tile, or four smaller stretches.
struct ReliefNode {
  std::uint16_t nearest = kEmptyCode, farthest = 0;  // codes; nearest > farthest: no samples
  [[nodiscard]] bool empty() const { return nearest > farthest; }
};

// In which way a stream runs; both bits clear: u and v ascend.
enum ReliefOrder : unsigned { kDescendingU = 1, kDescendingV = 2 };

struct LayeredRelief {
  std::string name;
  Camera camera;  // parallel; of the capture
  double plane_z = 1;
  double first_d = 0, d_step = 0;

  int tile_size = 32;  // texels a side: a power of two, at most 256
  int tiles_x = 0, tiles_y = 0;
  int levels = 0;  // of the tree, at least 1
  // The quad-tree: children of node n are 4 n + 1 ... 4 n + 4, in the order of ReliefOrder's bits
  // (right: 1, lower: 2); the last level's nodes are tiles, some of them beyond the image.
  std::vector<ReliefNode> tree;
  // Of tile t (row by row): samples first[t] ... first[t + 1]) of each stream.
  std::vector<std::uint32_t> first;
  // Row v of tile t begins, where v ascends, at sample first[t] + rows[t * (tile_size + 1) + v].
  std::vector<std::uint32_t> rows;
  std::array<std::vector<ReliefSample>, 4> streams;  // by order; padded, to be read in blocks
  // Source positions (u, v, d) whose convex hull holds every texel that a sample covers.
  std::vector<glm::dvec3> hull;
  // What was given up to build it, for the error bound, metres: how far a sample may have been
  // moved in depth to merge it, and by the rounding of its code.
  double merged_d = 0;

  [[nodiscard]] std::size_t samples() const { return first.empty() ? 0 : first.back(); }
  [[nodiscard]] double d(std::uint32_t code) const { return first_d + double(code) * d_step; }
  [[nodiscard]] double nearest_d() const { return first_d; }
  [[nodiscard]] double farthest_d() const { return first_d + double(kLargestCode) * d_step; }
  [[nodiscard]] ReliefFrame frame() const { return relief_frame(camera, plane_z); }
};

struct LayeredReliefOptions {
  int tile_size = 32;
  // Samples of one line of sight that lie closer together become one; metres.
  double merge = 0.0;
  // Translucent samples are gathered along the line of sight until they hide as much as this.
  float least_alpha = 0.5f;
  // Slices of the hull: more are tighter.
  int hull_slices = 8;
};

// Requires a parallel picture that is valid. The error says why there is nothing to keep: no
// samples, or too many (2^32).
[[nodiscard]] Result<LayeredRelief> build_layered_relief(const LayeredDepthImage& layers,
                                                         const LayeredReliefOptions& options = {});

// Memory, in bytes.
[[nodiscard]] std::size_t bytes(const LayeredRelief& relief);

// Is every index in range, and every tile's depth within its node's?
[[nodiscard]] Result<> validate(const LayeredRelief& relief);

}  // namespace rilievo
