// What does a new eye see of a relief impostor, as a flat picture on the impostor's plane? (S5.2)
//
// The impostor's picture is perspective, as the shader made it: from its own eye, nothing moves. A
// sample at raster position p with depth z lies, seen from an eye at height h above the plane, at
//
//   p' = e + (p - c) / beta + B ((c - e) - (p - c) alpha / beta),    B = h / (its depth from there)
//
// of the plane, with e and c the feet of the new and the old eye on the plane, beta = h0 / h of
// their heights, and alpha = 1 - beta. Each axis needs B and its own coordinate alone: two
// one-dimensional passes, rows first. The paper's parallel picture is the limit h0 -> infinity,
// p' = e + B (p - e), with B = 1 / (1 + k3 d).
//
// In the first pass, what lies behind other surfaces of its row is lost even where the second would
// have moved it from behind them. Holes are interpolated between the surfaces beside them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "rilievo/nailboard/prewarped.h"
#include "rilievo/relief_impostor/warp_passes.h"

namespace rilievo {

// A picture is not warped for an eye that magnifies any of it more than this along an axis.
constexpr double kMaxImpostorMagnification = 8;

// The size of the result, and where it is made.
struct ImpostorWarpOptions {
  // Texels of the result per texel of the picture, at the plane. Halved until at most max_size
  // texels a side.
  double resolution = 1;
  int max_size = 1024;
  // On all cores; otherwise on the calling thread alone. The result is the same.
  bool parallel = true;
  // A rectangle of the picture's raster (left, top, right, bottom) that the result has room for,
  // too, if it fits into max_size: for merge_warps().
  std::optional<glm::dvec4> room = {};
};

// The formula above in raster positions of the picture, for one axis: p' = (a0 + a1 p) + B (b0 + b1
// p).
struct PlaneAxis {
  double a0 = 0, a1 = 1, b0 = 0, b1 = 0;
  [[nodiscard]] double moved(double p, double nearness) const {
    return a0 + a1 * p + nearness * (b0 + b1 * p);
  }
};

// The warp of a picture for an eye.
struct PlaneWarp {
  PlaneAxis x, y;
  double alpha = 0, beta = 1;
  double height = 1;  // of the eye above the plane, metres
  // B of a sample at `depth` (eye_z of the picture) over plane_z. Not positive behind the eye.
  [[nodiscard]] double nearness(double depth) const { return 1 / (alpha + beta * depth); }
};

// None if the eye is not in front of the plane.
[[nodiscard]] std::optional<PlaneWarp> plane_warp(const PictureGeometry& picture,
                                                  const glm::dvec3& eye);

// How far the warp moves any point of the picture's window, at any depth of its slab, beyond where
// it was on the plane, in texels: less than half of a pixel changes nothing that is seen (S5.7).
// Infinite where it cannot be warped.
[[nodiscard]] double largest_move(const PictureGeometry& picture, const PlaneWarp& warp);

// Buffers that are kept from warp to warp: the second warp of a size allocates nothing.
struct ImpostorWarpScratch {
  std::vector<std::uint32_t> between, table;
  std::vector<std::byte> bytes;
  std::vector<WarpedTexels> counts;
  // Of the last warp, by texel of its result: 1 where it is interpolated, 2 where torn; or both.
  std::vector<std::uint16_t> flags;
};

// Warps the picture. None if it is empty, or if `eye` sees any of it from behind its plane, or too
// near. `result` has 16 bits of Delta.
[[nodiscard]] std::optional<WarpedTexels> warp_impostor(const ImpostorPicture& picture,
                                                        const glm::dvec3& eye,
                                                        const ImpostorWarpOptions& options,
                                                        ImpostorWarpScratch& scratch,
                                                        Prewarped& result);

}  // namespace rilievo
