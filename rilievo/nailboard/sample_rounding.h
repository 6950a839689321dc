// How many of a pixel's samples does a texel's alpha cover?
#pragma once

namespace rilievo {

// With n samples and alpha a.
enum class SampleRounding {
  // At least n a: what Mesa makes of OpenGL's alpha to coverage. Captures of polygons lose texels
  // whose centre shows nothing, an eighth of a pixel along silhouettes, and this adds as much.
  up,
  // The nearest number to n a: for pictures whose alpha is coverage everywhere.
  nearest,
};

}  // namespace rilievo
