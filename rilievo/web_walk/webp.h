// WebP files in memory, for colours that browsers decode.
//
// Lossy WebP halves the resolution of chroma, so that its error has a floor, some 45 dB in pictures
// of many colours; below that, pictures are stored without loss but for the lowest bits ("near
// lossless").
#pragma once

#include <cstdint>
#include <vector>

#include "rilievo/core/color.h"
#include "rilievo/core/result.h"

namespace rilievo {

// How exact a WebP file must be.
struct WebpOptions {
  // The least PSNR of R, G and B against the picture, dB, measured on the decoded file. The file of
  // the lowest quality that reaches it is taken.
  double least_psnr_db = 42;
  // With alpha, exactly. Colours then count by it: PSNR is that of colours over black.
  bool alpha = false;
};

// A file, and how exact it is.
struct WebpFile {
  std::vector<std::uint8_t> bytes;
  double psnr_db = 0;  // infinite without an error
  int quality = 0;     // 0 to 100; 101: near lossless
};

// Encodes a picture, whose colours are not multiplied by alpha. Fails for an empty picture and one
// above 16383 texels a side, which the format cannot hold. The bytes depend on the picture and the
// options alone.
[[nodiscard]] Result<WebpFile> encode_webp(const Rgba8Image& picture, const WebpOptions& options);

}  // namespace rilievo
