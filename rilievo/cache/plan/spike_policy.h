// Limits of a frame's cost, and of how late its pictures may be, so that an eye that jumps does not
// wait.
//
// After a cut nothing at hand shows what is seen, and drawing all of it takes long. The dearest
// objects of a limited frame are in one coarse picture by rays (Plan::fallback), whose cost does
// not depend on how many it shows; frames then become fine one after the other. With, by the
// CostModel,
//
//   floor    what any frame may cost                usual   what the last frames cost
//   spike    max(floor, max_spike * usual)          now     this frame without captures
//
// a frame is limited where now > allowed, and costs at most limit:
//
//   a jump of the eye      allowed = limit = jump_share * floor
//   after a limited frame  allowed = limit = max(last, min(1.3 last, spike), now / 2),
//                          where last = max(the last limit, floor): from the floor on it grows by a
//                          third
//   otherwise              allowed = spike, limit = max(floor, usual)
//
// A frame that is not limited has room for captures: up to `allowed`, and no more than
// max(0.4 floor, max_spike * usual).
#pragma once

#include <limits>

namespace rilievo {

// SpikePolicy::max_spike where someone looks on.
inline constexpr double kInteractiveSpike = 2;

// How much more than others a frame may cost, and how much later than it should a picture is
// replaced.
struct SpikePolicy {
  // 0: no limit on what a frame costs.
  double max_spike = 0;
  double floor = 360'000;  // in triangles
  // So that the first frame after a jump takes no longer than the floor where drawing takes half as
  // long again as the CostModel says.
  double jump_share = 0.65;
  // With captures beside the frames: the bounds of a picture whose successor is not done may exceed
  // their limits by this factor, at least 1. Beyond it, something else stands for the picture's
  // objects, mostly the coarse picture.
  double late = 2;
  // After frames that were drawn without the cache: the share of the lateness that pictures at hand
  // may have, of late - 1 or kMostLateInCatchUp - 1, whichever is less. The caller lowers it from 1
  // to 0 over some frames, so that the first of them does not capture all pictures that have become
  // due. A frame's captures then cost at most kCatchUpShare of what it costs without them, but one
  // is always made. 0: no catch-up.
  double catch_up = 0;
};

// What the captures of a frame may cost in a catch-up. With half of it they are too few, and the
// first frame after the catch-up is as dear as the first one would have been.
inline constexpr double kCatchUpShare = 0.8;
// The largest factor by which bounds may exceed their limits in a catch-up.
inline constexpr double kMostLateInCatchUp = 2;

// A frame before its captures are chosen. Costs in triangles.
struct FrameCosts {
  bool first = false;    // there was none before it
  bool jumped = false;   // FrameView's
  bool started = false;  // FrameView's
  double shift = 0;      // if it started: of what the last frame's pictures show, the mean, radians
  double now = 0;        // of drawing it from what is at hand, without captures
  double usual = 0;      // of the last frames; 0: there was none
  double last_limit = 0;  // on the last frame; 0: it had none
};

// The limit of a frame's cost.
struct FrameLimit {
  double limit = 0;     // 0: it is not limited
  bool jumped = false;  // the camera's motion says so, or what the frame costs and shows
  // The most that captures may add, if the frame is not limited.
  double capture_room = std::numeric_limits<double>::infinity();
  bool captures_wait = false;  // not even one is made
};

// By the table above.
[[nodiscard]] FrameLimit find_limit(const SpikePolicy& policy, const FrameCosts& costs);

// The most that captures may cost in a limited frame.
[[nodiscard]] double limited_capture_budget(const FrameLimit& limit);

// The smallest scale of the coarse picture, 1: a texel a pixel, and `whole_cost` what it would cost
// then. `usually`: the smallest but after a jump.
[[nodiscard]] double coarsest_fallback(const FrameLimit& limit, double whole_cost, double usually);

}  // namespace rilievo
