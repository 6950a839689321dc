// Other coders of 16-bit planes, to compare with: what they take, and what they cost.
#pragma once

#include <cstdint>
#include <vector>

#include "rilievo/core/image.h"

namespace rilievo::bench {

// RVL [Wilson 2017, "Fast lossless depth image compression"]: runs of zeros, and differences of
// the rest as numbers of 3 bits with a flag.
[[nodiscard]] std::vector<std::uint32_t> encode_rvl(const Image<std::uint16_t>& plane);
[[nodiscard]] Image<std::uint16_t> decode_rvl(const std::vector<std::uint32_t>& words, int width,
                                              int height);
// Of a 16-bit PNG with Paeth's filter: its compressed rows.
[[nodiscard]] std::vector<std::uint8_t> encode_png_rows(const Image<std::uint16_t>& plane);
// The plane as it is, by zlib.
[[nodiscard]] std::vector<std::uint8_t> encode_deflate(const Image<std::uint16_t>& plane);

}  // namespace rilievo::bench
