// How are placed slices of layered impostors drawn into one tile? Internal to
// `layered_impostor/software`.
//
// The ray of a pixel (x, y) of the frame, in the picture's eye space, is o + t d with t the frame's
// eye_z and d affine in x and y. It crosses the slice, at z = -S, where
//
//   w := 1 / t = -d.z / (S + o.z)
//
// and there the texel (u, v) of the picture's window (l, r, b, t) and size W x H is
//
//   u w = ((o.x w + d.x) / S - l w) W / (r - l)
//   v w = (t w - (o.y w + d.y) / S) H / (t - b)
//
// All three are affine in x and y.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>

#include "rilievo/core/depth_image.h"
#include "rilievo/render/software/frame_tile.h"

namespace rilievo {

// A picture as slices show it.
struct SlicedPicture {
  Image<std::uint32_t> color;  // as tiles hold it, opaque
  // The depths between which a slice shows a texel, those of slice_codes(): the first in the lower
  // half.
  Image<std::uint32_t> codes;
  Image<std::uint32_t> object;  // empty if all show one
};

// A slice's quad in a frame. Values that are affine in the pixel have the factors of x, y and 1.
struct PlacedSlice {
  glm::dvec3 u{0.0}, v{0.0}, w{0.0};
  double inverse_scale = 1;
  double most_w = 0;  // at the near plane
  const SlicedPicture* picture = nullptr;
  glm::vec4 texels{0.0f};
  int front = 0, back = 0;  // it shows codes with front <= second and first < back
  float from = 0, to = 1;   // and pixels whose hash is within
  std::uint32_t object = kNoObject;
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // pixels
};

// Draws what a tile shows of a quad. SIMD.
void draw_slice(const PlacedSlice& placed, FrameTile& tile);

}  // namespace rilievo
