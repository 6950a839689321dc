// The size of the points and lines that a picture shows, for bounds of its error.
//
// A point is a disc that faces the eye, and a line is some pixels wide. A picture keeps both as its
// own eye and texels had them, so that another eye sees discs aslant and lines as wide as texels.
#pragma once

#include <algorithm>
#include <cmath>

namespace rilievo {

// The largest of the points and lines of a picture.
struct StrokeSize {
  double disc_radius = 0;  // of the largest disc, metres
  double texels = 0;       // the width of what is so many texels wide, at most
  // Are there points or lines?
  [[nodiscard]] bool any() const { return disc_radius > 0 || texels > 0; }
  void add(const StrokeSize& other) {
    disc_radius = std::max(disc_radius, other.disc_radius);
    texels = std::max(texels, other.texels);
  }
  friend bool operator==(const StrokeSize&, const StrokeSize&) = default;
};

// How far a place of a disc is from where the disc shows the same colour once it faces another eye,
// metres. That eye is `moved` metres from the one that the disc was captured for, which is at least
// `nearest` metres from the disc: the disc turns by at most asin(moved / nearest). However far it
// turns, the disc's centre is no farther away than its edge, and has the same colour.
[[nodiscard]] inline double disc_shift(double disc_radius, double moved, double nearest) {
  if (moved >= nearest) return disc_radius;
  return std::min(disc_radius, 2 * disc_radius * std::sin(0.5 * std::asin(moved / nearest)));
}

// How far the edge of a strip of `texels` reaches beyond one of as many pixels, in pixels. The way
// from a texel's centre to its corner is `half_texel_px` at most.
[[nodiscard]] inline double strip_shift_px(double texels, double half_texel_px) {
  return texels * std::max(0.0, half_texel_px - 0.5);
}
// The same seen from anywhere, with texels that may be however small. What lies beside the middle
// of a line may be seen along the line, beyond its end; and a strip of small texels is too narrow.
[[nodiscard]] inline double strip_difference_px(double texels, double half_texel_px) {
  return texels * std::max(0.5, half_texel_px);
}

}  // namespace rilievo
