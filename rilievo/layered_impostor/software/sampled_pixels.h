// The pixels of a tile of which each sample is looked at. Internal to `layered_impostor/software`.
//
// They lie along silhouettes, or follow from those: what is thinner than a pixel may pass between
// the centres of many pixels in a row, each beside one whose samples show it. Pixels are followed
// within their tile, and within the first one's depths.
#pragma once

#include <array>
#include <cstddef>

#include "rilievo/layered_impostor/software/silhouette_pixels.h"
#include "rilievo/render/software/frame_tile.h"

namespace rilievo {

// Each pixel once, in the order in which they are added.
class SampledPixels {
 public:
  // Where along its rays a pixel shows something.
  struct Pixel {
    int x = 0, y = 0;
    double begin = 0, end = 0;
  };

  void clear() { taken_ = {}, count_ = next_ = 0; }
  void add(const Pixel& pixel) {
    if (taken_.has(pixel.x, pixel.y)) return;
    taken_.set(pixel.x, pixel.y);
    pixels_[count_++] = pixel;
  }
  // Adds, of a pixel whose centre shows nothing, the neighbours on the sides where those of its
  // samples are that show something (a bit each), if they were `asked` for and are not `shown`.
  void add_beside(const Pixel& pixel, unsigned samples, const TileBits& asked,
                  const TileBits& shown) {
    const auto add_at = [&](int x, int y) {
      if (x < 0 || y < 0 || x > 63 || y > 63 || !asked.has(x, y) || shown.has(x, y)) return;
      add({x, y, pixel.begin, pixel.end});
    };
    for (int s = 0; s < 4; ++s) {
      if (!(samples >> s & 1)) continue;
      add_at(pixel.x + (FrameTile::kSampleX[s] < 0.5f ? -1 : 1), pixel.y);
      add_at(pixel.x, pixel.y + (FrameTile::kSampleY[s] < 0.5f ? -1 : 1));
    }
  }
  [[nodiscard]] bool has(int x, int y) const { return taken_.has(x, y); }
  // The next one; null if there is none. Stays where it is when others are added.
  [[nodiscard]] const Pixel* next() { return next_ < count_ ? &pixels_[next_++] : nullptr; }

 private:
  TileBits taken_;
  std::array<Pixel, std::size_t(FrameTile::kSize* FrameTile::kSize)> pixels_;
  std::size_t count_ = 0, next_ = 0;
};

}  // namespace rilievo
