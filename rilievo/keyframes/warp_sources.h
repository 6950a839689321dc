// What warping a frame needs of each keyframe. Internal: not a stable interface.
#pragma once

#include <algorithm>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "rilievo/keyframes/warp_keyframes.h"

namespace rilievo {

// What warping one keyframe needs.
struct WarpSource {
  const Keyframe* keyframe = nullptr;
  RasterMap to_frame, from_frame;
  float weight = 1;
  bool spare = false;          // these come last
  float pixels_per_texel = 1;  // of what has the same depth in both
};

// The side of the largest square of a texel, pixels.
inline float largest_square(const WarpSource& source) {
  return kLargestSquare * std::max(1.0f, source.pixels_per_texel);
}

// What each keyframe needs, the spare ones last. Requires at least one keyframe.
void find_warp_sources(std::span<const WarpedKeyframe> keyframes, const Camera& frame,
                       std::vector<WarpSource>& sources);

// The keyframe of an eye that stands, if there is one: the frame's pixels are its texels, which all
// have quarters. `left`, `top`: of the frame in it.
struct SamePixels {
  std::size_t source;
  int left, top;
};
[[nodiscard]] std::optional<SamePixels> find_same_pixels(std::span<const WarpSource> sources,
                                                         const Camera& frame);

// Of each kPlainSkyColumns columns of rows [first, first + rows) of a frame of this width: does a
// keyframe show nothing but the sky there? Writes one number for each to `plain`.
inline constexpr int kPlainSkyColumns = 64;
[[nodiscard]] inline int plain_sky_cells(int width) {
  return (width + kPlainSkyColumns - 1) / kPlainSkyColumns;
}
void find_plain_sky(std::span<const WarpSource> sources, int first, int rows, int width,
                    std::uint8_t* plain);

}  // namespace rilievo
