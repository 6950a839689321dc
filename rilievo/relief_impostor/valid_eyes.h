// From which eyes does an impostor stay valid? (S5.3, figure 3)
//
// The share of interpolated texels of what each eye of a square sees; a map of the eyes for which
// it is small. The square lies in the plane of the picture's right and forward directions, around
// its eye: a map as seen from above.
#pragma once

#include "rilievo/core/color.h"
#include "rilievo/core/image.h"
#include "rilievo/relief_impostor/impostor_warp.h"

namespace rilievo {

// Which eyes are tried.
struct ValidEyesOptions {
  int size = 65;           // eyes a side
  double extent = 1;       // half of the square's side, metres
  double max_share = 0.2;  // of interpolated texels; the paper's
  // Eyes of which only each so manyeth is tried, and others where their neighbours disagree; 1: all
  // are tried (brute force).
  int step = 8;
};

// The map.
struct ValidEyes {
  // 1 where valid; the first row is farthest forward.
  Image<std::uint8_t> valid;
  int tried = 0;  // eyes
};

// The eye of a texel of the map, world space.
[[nodiscard]] glm::dvec3 eye_of(const ImpostorPicture& picture, const ValidEyesOptions& options,
                                int x, int y);
// Islands smaller than `step` between eyes that agree are not found.
[[nodiscard]] ValidEyes valid_eyes(const ImpostorPicture& picture, const ValidEyesOptions& options);
// As a picture: valid eyes green, others grey, the picture's own eye white.
[[nodiscard]] Rgba8Image picture_of(const ValidEyes& eyes);

}  // namespace rilievo
