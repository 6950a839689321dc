// Planes of 16-bit numbers, such as inverse depths, compressed without loss for browsers.
//
// Inverse depth is affine in the raster over a plane of the scene, so that a texel follows from its
// neighbours to the west (W), north (N) and north-west (NW). What is stored is a zlib stream
// (RFC 1950, "deflate" to browsers) of
//   1 byte          the predictor: 0 none, 1 W + N - NW (plane), 2 the median of W, N, W + N - NW
//   n bytes         the low bytes of the differences from the prediction, row by row
//   n bytes         their high bytes
// A difference is taken modulo 65536 and, as a signed number d, stored as 2 d, or -2 d - 1 if d is
// negative. Outside the plane neighbours are 0.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/core/image.h"
#include "rilievo/core/result.h"

namespace rilievo {

// Compresses a plane with the predictor that makes it smallest.
[[nodiscard]] std::vector<std::uint8_t> encode_plane16(const Image<std::uint16_t>& plane);
// The same with the median and little search: for what is sent at once. Some percent larger.
[[nodiscard]] std::vector<std::uint8_t> encode_plane16_quickly(const Image<std::uint16_t>& plane);

// The plane of `width` times `height` numbers. Fails for damaged bytes and those of another size.
[[nodiscard]] Result<Image<std::uint16_t>> decode_plane16(std::span<const std::uint8_t> bytes,
                                                          int width, int height);

}  // namespace rilievo
