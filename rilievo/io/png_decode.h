// How is a PNG file decoded? By libpng. Internal to loading; throws LoadError.
//
// Memory is bounded before libpng starts: the first 26 bytes hold the picture's size and format, a
// size that the compressed bytes cannot hold is refused, and libpng works row by row with at most
// 4 MiB of its own. Only the chunks that make the picture are read; gamma, profiles and texts are
// skipped.
#pragma once

#include <cstdint>

#include "rilievo/core/color.h"
#include "rilievo/io/load_context.h"

namespace rilievo {

// Do the bytes begin with PNG's signature?
[[nodiscard]] bool is_png(Bytes encoded);

// Decodes any PNG to 8-bit RGBA, into the picture that `make(width, height)` returns; `make` may
// refuse by throwing.
[[nodiscard]] Rgba8Image decode_png(Bytes encoded, MemoryBudget& budget,
                                    Rgba8Image (*make)(int width, int height, MemoryBudget&));

// The values of a 16-bit grey PNG; throws for any other picture.
[[nodiscard]] Image<std::uint16_t> decode_png_grey16(Bytes encoded, MemoryBudget& budget,
                                                     Image<std::uint16_t> (*make)(int width,
                                                                                  int height,
                                                                                  MemoryBudget&));

}  // namespace rilievo
