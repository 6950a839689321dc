// How does a tile become a part of a frame? Internal: not a stable interface.
#pragma once

#include <cstddef>
#include <cstdint>

#include "rilievo/render/software/frame_tile.h"

namespace rilievo {

// Averages the samples of each pixel, rounded to the nearest byte, and copies them and the first
// sample's inverse_z into the frame, whose rows are `stride` pixels apart. Pixels outside the frame
// are left out. The tile's first samples become the averages. SIMD.
void resolve_tile(FrameTile& tile, std::uint32_t* content, float* inverse_z, std::size_t stride);

}  // namespace rilievo
