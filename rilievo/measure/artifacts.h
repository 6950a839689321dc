// Faults that an eye finds at once and that a mean over the frame hides: outlines drawn a second
// time, isolated wrong pixels, shimmer.
//
// Frames are 8-bit sRGB; alpha is ignored. Each figure allows a frame what the true frame has
// within a reach of some pixels, so that an edge that stands a pixel off is no fault of this kind:
// other measures count it. Sums are exact integers: the results do not depend on the number of
// threads.
#pragma once

#include "rilievo/core/color.h"
#include "rilievo/core/image.h"

namespace rilievo {

// How far away the true frame may have the same, pixels: of a square of 2 kArtifactReach + 1 a
// side.
inline constexpr int kArtifactReach = 2;
// By how many steps of 255 a channel must exceed the true frame's. A step of 24 is plainly seen on
// a plain wall, and antialiasing with four samples instead of infinitely many seldom makes one.
inline constexpr int kArtifactStep = 24;

// Two shares of a frame's pixels, 0 to 1.
struct Artifacts {
  // Pixels at an edge that the true frame does not have within reach.
  double ghost = 0;
  // Pixels off their neighbours as none of the true frame within reach is.
  double speckle = 0;
};

// The edge at each pixel: Sobel's slope along x or y, whichever is larger, of the channel where it
// is largest; a straight step of h has an edge of h on both of its sides. Frames continue beyond
// their borders with their outermost pixels, as for isolation().
[[nodiscard]] Image<std::uint8_t> edges(const Rgba8Image& frame);
// How far each pixel is from the median of its eight neighbours: from the nearer one of the two
// values in the middle, and 0 between them, of the channel where it is farthest.
[[nodiscard]] Image<std::uint8_t> isolation(const Rgba8Image& frame);

// Counts the faults of `frame`. Requires frames of one size, of at least one pixel.
[[nodiscard]] Artifacts count_artifacts(const Rgba8Image& truth, const Rgba8Image& frame);

// How much more the method's frame changed since the one before it than the true frame did: the
// mean over all pixels of what the change of a channel, where it is largest, exceeds the largest
// change of the true frame within reach by; 0 to 1. Requires four frames of one size, of at least
// one pixel.
[[nodiscard]] double flicker(const Rgba8Image& true_before, const Rgba8Image& truth,
                             const Rgba8Image& before, const Rgba8Image& frame);

}  // namespace rilievo
