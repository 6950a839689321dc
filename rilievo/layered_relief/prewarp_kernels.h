// The inner loops of the pre-warp: samples into a tile of the result, and the tile into a picture.
//
// Internal to the folder. SIMD, chosen at run time; no multiplication is fused with an addition, so
// that every instruction set yields the same bytes.
//
// With code the depth code of a sample at (u, v) of the source, its position in the result is
//   x = (scale u + x_code code + x_0) / (w_code code + w_0),   y likewise,
// in texels from the result's upper left corner: never negative for what the relief holds.
#pragma once

#include <cstdint>
#include <span>

#include "rilievo/layered_relief/layered_relief.h"

namespace rilievo {

struct PrewarpCoefficients {
  float scale = 1, x_code = 0, x_0 = 0, y_code = 0, y_0 = 0, w_code = 0, w_0 = 1;
  // Splats reach from u + low to u + high; nearest samples sit at u + 0.5, which x_0 holds.
  float low = 0, high = 1;
};

// How many texels a splat of a run may cover along an axis.
enum class SplatReach { nearest, one, two, many };

// A stretch of a stream that may reach the destination tile.
struct PrewarpRun {
  const ReliefSample* samples = nullptr;  // readable 64 samples beyond its end
  std::uint32_t count = 0;
  float u = 0, v = 0;                  // of the source tile's corner
  std::uint32_t u_from = 0, u_to = 0;  // of the source tile's columns only these
  bool all_columns = true;
  SplatReach reach = SplatReach::nearest;
};

struct PrewarpTile {
  ReliefSample* texels = nullptr;  // (height + 1) * pitch: the last row is for what misses the tile
  int x = 0, y = 0;                // in the result
  int width = 0, height = 0, pitch = 0;
};

// Empties the tile, then draws the runs over each other. How many of the samples covered something
// in it?
std::size_t prewarp_tile(const PrewarpCoefficients& coefficients, std::span<const PrewarpRun> runs,
                         const PrewarpTile& tile);

// Delta of a code: (delta_code code + delta_0) / (z_code code + z_0), rounded; 0xffff and no colour
// where the tile is empty.
struct ResolveCoefficients {
  float delta_code = 0, delta_0 = 0, z_code = 0, z_0 = 1;
};

// Texels [x, x + width) x [y, y + height) of the tile into planes, of which `color` and `delta`
// are the first texels to be written.
void resolve_tile(const ResolveCoefficients& coefficients, const PrewarpTile& tile, int x, int y,
                  int width, int height, std::uint32_t* color, std::uint16_t* delta,
                  std::size_t plane_pitch);

}  // namespace rilievo
