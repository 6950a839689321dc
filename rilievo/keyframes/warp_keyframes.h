// Warps two or three keyframes to a frame's eye, and merges them.
//
// First forward in depth: each texel of each keyframe goes where the frame's eye sees its surface,
// as a square as large as it appears there, and the nearest stays. Then backward in colour: each
// pixel's surface is looked up in every keyframe. The four texels around the place count as far as
// they show the same surface (S3.7), and a keyframe counts the more, the nearer its eye is and the
// smaller its texels appear. What no keyframe shows is a hole.
//
// A texel has the colour of one surface (conventions.md), so that edges are made smooth here. Where
// one of a pixel's neighbours is nearer, or else farther, both surfaces are looked up at the pixel:
// the share of the four texels that show the one in front is what it covers, and the rest shows the
// one behind. Where texels have quarters, the four of them around the place count instead, each of
// which shows its texel's surface or what is in front of it or behind, and counts with its sides.
// The share is half on the border of two texels, wherever that is in the pixel, and falls from 1 to
// 0 within a texel: about as a box filter. So are cracks closed between the squares of a surface
// that came nearer, of which a keyframe shows all.
//
// Raster coordinates and 1 / eye_z go from one camera to another by a matrix: with a point at
// raster (x, y) and w = 1 / eye_z, eye E and the ray R(x, y) through it, affine in x and y,
//
//   E + R(x, y) / w      in the other camera, times w:      (X, Y, Z) = A (x, y, 1) + b w
//   x' = X / Z,  y' = Y / Z,  w' = w / Z
//
// where w = 0, the sky, is no special case. A strip of rows is warped by one thread, so that its
// depths stay in its core's cache. SIMD; the same bytes with any number of threads and any
// instruction set. A steady frame allocates nothing.
#pragma once

#include <cstdint>
#include <span>

#include "rilievo/core/image.h"
#include "rilievo/keyframes/keyframe.h"

namespace rilievo {

// Raster coordinates and 1 / eye_z of one camera in another: rows of (A | b) as above.
struct RasterMap {
  float x[4], y[4], z[4];
};
[[nodiscard]] RasterMap raster_map(const Camera& to, const Camera& from);
// The same of places (x, y, z, 1) and of directions (x, y, z, 0): world axes, from `origin` on.
[[nodiscard]] RasterMap raster_map(const Camera& to, const glm::dvec3& origin);

// A keyframe and how much it counts.
struct WarpedKeyframe {
  const Keyframe* keyframe = nullptr;
  float weight = 1;    // positive
  bool spare = false;  // counts only where no other one shows all of a pixel's surface
};

// A frame that was warped. All images have the frame's size.
struct WarpedFrame {
  static constexpr int kStrip = 32;     // rows
  Image<std::uint32_t> color;           // as Keyframe's; 0: a hole. kCoveredPixel, kPlainSky
  Image<float> inverse_z;               // 1 / eye_z; 0: sky or a hole
  Image<std::uint32_t> holes_in_strip;  // one row: the number of holes of each strip

  [[nodiscard]] static int strips(int height) { return (height + kStrip - 1) / kStrip; }
  // Does not allocate if it was as large before.
  void resize(int width, int height);
  [[nodiscard]] bool hole(int x, int y) const { return color(x, y) == 0; }
  [[nodiscard]] std::size_t holes() const;
};

// Depths that differ by a smaller share belong to one surface: at a grazing angle a texel's depth
// is off by more than its size.
inline constexpr float kSameSurfaceDepth = 0.03f;
// Weights of the four texels around a place are whole numbers that make up this, or a little less.
// So many of them must show the pixel's surface; with more than so many all of it is shown.
inline constexpr int kTexelWeights = 256, kLeastShown = 64, kAllShown = 250;
// A quarter of a surface's texel that shows another surface has a colour, too, which counts less:
// its weight is shifted by so many bits. Away from edges it does not do alone, and of the sky it
// does not count: it would be a dot of something nearer, which is elsewhere in the frame.
inline constexpr int kOtherQuarterShift = 3;
// Not where a texel is so many pixels wide, or more: there a pixel may lie among such quarters
// alone.
inline constexpr float kMostMixed = 2;
// Half of the side of a texel's square, in texels: a little more than half, against cracks.
inline constexpr float kHalfSquare = 0.55f;
// Texels of a slanted surface move apart by more than their squares grow, and leave cracks. They
// are closed where the parallax, how far a place is from where it would be at infinite distance, is
// more than kCrackParallax pixels along an axis: a texel and its neighbour to the right, or below,
// of the same surface, with a depth that differs by more than kLeastSlant, at most kWidestCrack
// pixels apart, are joined by a band as wide as the texel's square, along which 1 / eye_z goes from
// one to the other. At a smaller parallax a step of kSameSurfaceDepth leaves two pixels where
// texels do not grow, which walks at a person's speed do not show; one of kLeastSlant leaves half a
// pixel at a parallax of 500.
inline constexpr float kCrackParallax = 64, kLeastSlant = 0.001f, kWidestCrack = 8;
// A surface whose texels have grown by more, because the eye came so much nearer to it, is not
// shown by them: it is a hole, unless another keyframe shows it.
inline constexpr float kMostMagnified = 4;
// Such texels still hide what is behind them. Their squares grow to so many times a texel's size.
inline constexpr float kLargestSquare = 64;

// The colour of a pixel, of depth 0, that is not warped because something else covers it.
inline constexpr std::uint32_t kCoveredPixel = 0x01000000u;
// And of one, of depth 0, that shows the sky and is left to whoever draws that.
inline constexpr std::uint32_t kPlainSky = 0x02000000u;

// The surfaces that will be drawn over a warped frame.
struct WarpCover {
  const Image<float>* inverse_z = nullptr;  // 1 / eye_z of what covers all of a pixel; 0: nothing
  // Of the nearest thing that keyframes show: nothing else is in front of what is nearer.
  float nearest = 0;
};

// Warps and merges. Nothing nearer than the frame's z_near is shown. What is behind `cover` (of the
// frame's size; null: nothing) is left out. It is a hole where no keyframe sees so far and there
// may be something in front of the cover. `leaves_sky`: where keyframes show nothing but the sky it
// is not looked up, and pixels are kPlainSky. Requires at least one keyframe.
void warp_keyframes(std::span<const WarpedKeyframe> keyframes, const Camera& frame,
                    WarpedFrame& out, const WarpCover* cover = nullptr, bool leaves_sky = false);

// The objects of the frame's pixels, as it was warped; kNoObject in holes.
void warp_objects(std::span<const WarpedKeyframe> keyframes, const Camera& frame,
                  const WarpedFrame& warped, Image<std::uint32_t>& objects);

}  // namespace rilievo
