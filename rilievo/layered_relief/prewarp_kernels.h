// What are the inner loops of the pre-warp? Samples into a tile, and the tile into a picture.
//
// Internal to the folder. SIMD, chosen at run time. No multiplication is fused with an addition, so
// that all instruction sets give the same bytes.
//
// With `code` the depth code of a sample at (u, v) of the source, its position in the result is
//   x = (scale u + x_code code + x_0) / (w_code code + w_0),   y likewise,
// in texels from the centre of the result's upper left texel. Within 2^21 of it.
#pragma once

#include <cstdint>
#include <span>

#include "rilievo/layered_relief/layered_relief.h"

namespace rilievo {

// The coefficients of this formula for one eye.
struct PrewarpCoefficients {
  float scale = 1, x_code = 0, x_0 = 0, y_code = 0, y_0 = 0, w_code = 0, w_0 = 1;
  float least_code = 0;  // nearer samples are left out: they are behind the eye, or too near
};

// The largest number of texels that a splat of a run can cover along an axis; few: four.
enum class SplatReach { nearest, one, few, many };

// A range of a stream that can reach the destination tile.
struct PrewarpRun {
  const ReliefSample* samples = nullptr;  // 64 samples beyond its end must be readable
  std::uint32_t count = 0;
  float u = 0, v = 0;                  // of the source tile's corner
  std::uint32_t u_from = 0, u_to = 0;  // use only these columns of the source tile
  bool all_columns = true;
  SplatReach reach = SplatReach::nearest;
  // Splats extend so far from their texels' centres, at u + 0.5. (Nearest samples are those
  // centres, which x_0 has.)
  float half_x = 0.5f, half_y = 0.5f;
};

// A tile of the result.
struct PrewarpTile {
  ReliefSample* texels = nullptr;
  std::int32_t missed = 0;  // index of a texel outside the tile, which receives misses
  int x = 0, y = 0;         // in the result
  int width = 0, height = 0, pitch = 0;
};

// Draws the runs in order into a tile. Returns the number of samples that covered a
// texel.
std::size_t prewarp_tile(const PrewarpCoefficients& coefficients, std::span<const PrewarpRun> runs,
                         const PrewarpTile& tile);

// Delta of a code: (delta_code code + delta_0) / (z_code code + z_0), rounded; 0xffff, without
// colour, for empty texels.
struct ResolveCoefficients {
  float delta_code = 0, delta_0 = 0, z_code = 0, z_0 = 1;
};

// Copies a tile into planes, and empties it while the memory is at hand; `color` and `delta` are
// the first texels to write.
void resolve_tile(const ResolveCoefficients& coefficients, const PrewarpTile& tile,
                  std::uint32_t* color, std::uint16_t* delta, std::size_t plane_pitch);

}  // namespace rilievo
