// PNG by libpng. Internal to loading; throws LoadFault.
//
// What a file costs is known before libpng sees it: the size and the bits of a texel stand in the
// first 26 bytes, a size that the compressed bytes cannot hold is refused, and libpng works row by
// row with at most 4 MiB of its own. Of the chunks only those that make the picture are read:
// gamma, profiles and texts are passed over, whatever is in them.
#pragma once

#include <cstdint>

#include "rilievo/core/color.h"
#include "rilievo/io/load_context.h"

namespace rilievo {

// Does it begin as a PNG file?
[[nodiscard]] bool is_png(Bytes encoded);

// Any PNG picture: grey, palette and 16 bits become RGBA with 8. Calls `make(width, height)` for
// the picture to fill, which may refuse.
[[nodiscard]] Rgba8Image decode_png(Bytes encoded, MemoryBudget& budget,
                                    Rgba8Image (*make)(int width, int height, MemoryBudget&));

// The numbers of 16-bit grey as they are; any other picture is refused.
[[nodiscard]] Image<std::uint16_t> decode_png_grey16(Bytes encoded, MemoryBudget& budget,
                                                     Image<std::uint16_t> (*make)(int width,
                                                                                  int height,
                                                                                  MemoryBudget&));

}  // namespace rilievo
