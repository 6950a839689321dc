// How far from its true place can a warped pixel be, and how wide a strip can be missing?
//
// A pixel of a warped frame shows, of a keyframe, what lies within one texel of its place there and
// as deep as the pixel to kSameSurfaceDepth. With p the true place of such a surface in the frame:
//
//   across   a texel in either direction is m texels' widths in the frame, where m is how many
//            times larger it appears there: sqrt(2) m pixels
//   along    a surface that is deeper by a share s lies elsewhere on the keyframe's ray. Between
//            two eyes with baseline b it moves by at most  f |b| s w (1 + t)  pixels, with
//            w = 1 / eye_z in the frame, f the frame's pixels per tangent, and t the largest
//            tangent in the frame from its axis: along the ray both the place and its depth change
//
// What the frame's eye sees and neither keyframe saw was hidden behind an edge that each saw in
// front of it. Seen from the frame it lies at most as far from that edge as the edge has moved
// against the farthest things, f |b| w (1 + t). It is in a gap of each keyframe that looks there:
// of those that see all of the frame the narrowest bound counts; if there is none, the widest of
// all. Nothing is known of what lies outside of all keyframes' views, nearer than what they show.
#pragma once

#include <span>

#include "rilievo/keyframes/warp_keyframes.h"

namespace rilievo {

// Pixels of the frame.
struct KeyframeBound {
  double error_px = 0;  // of what is warped
  double gap_px = 0;    // the width of strips that show what is behind a surface instead of it
};

// A bound for warp_keyframes() of the same. Some microseconds for each thousand blocks.
[[nodiscard]] KeyframeBound bound_keyframes(std::span<const WarpedKeyframe> keyframes,
                                            const Camera& frame);

}  // namespace rilievo
