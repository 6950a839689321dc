#include "rilievo/cache/plan/spike_policy.h"

#include <algorithm>
#include <cmath>

namespace rilievo {
namespace {

// By how much the limit grows from frame to frame.
constexpr double kLimitGrowth = 1.3;
// Of what a frame would cost without a limit, at least so much is allowed but after a jump: where
// all frames are slow, they need not become fine as slowly as where others are fast.
constexpr double kLeastShare = 0.5;
// Where nothing jumped, captures do not make a frame cost more than this share of the floor, or
// max_spike times what is usual; in the second frame they cost no more than this.
constexpr double kWalkFloor = 0.4, kCaptureFloor = 0.2;
// An eye that stood has jumped if its first step shifts what it saw by more, radians.
constexpr double kFirstShift = 0.25;
// Of a limited frame, this much may be for captures; after a jump a coarse picture of nearly
// everything takes most of it.
constexpr double kLimitedShare = 0.5, kJumpedShare = 0.25;
// After a jump the coarse picture takes no more than this share of what the frame may cost, down to
// texels of four pixels, which still show what is where.
constexpr double kFallbackShare = 0.8, kCoarsestAfterJump = 0.25;

}  // namespace

FrameLimit find_limit(const SpikePolicy& policy, const FrameCosts& costs) {
  FrameLimit found;
  found.jumped = costs.jumped;
  if (!(policy.max_spike > 0)) return found;
  // What is captured for an eye that stands is of little use to one that walks, and only the second
  // frame tells which it is.
  found.captures_wait = costs.first;
  // The first frame may take its time: nothing that moves is interrupted. The second one does not
  // capture all that it left.
  if (!(costs.usual > 0) && !costs.jumped) {
    if (!costs.first) found.capture_room = kCaptureFloor * policy.floor;
    return found;
  }
  const double walk = policy.max_spike * costs.usual;
  const double spike = std::max(policy.floor, walk);
  double limit = std::max(policy.floor, costs.usual), allowed = spike;
  // Of an eye's first step, what it costs and what shifts tell whether it was a jump.
  found.jumped =
      costs.jumped || (costs.started && (costs.now > spike || costs.shift > kFirstShift));
  if (found.jumped) {
    allowed = limit = policy.jump_share * policy.floor;
  } else if (costs.last_limit > 0) {
    const double last = std::max(costs.last_limit, policy.floor);
    allowed = limit =
        std::max({last, std::min(kLimitGrowth * last, spike), kLeastShare * costs.now});
  }
  if (costs.now > allowed)
    found.limit = limit;
  else
    found.capture_room =
        std::max(0.0, std::min(allowed, std::max(kWalkFloor * policy.floor, walk)) - costs.now);
  return found;
}

double limited_capture_budget(const FrameLimit& limit) {
  return (limit.jumped ? kJumpedShare : kLimitedShare) * limit.limit;
}

double coarsest_fallback(const FrameLimit& limit, double whole_cost, double usually) {
  if (!limit.jumped) return usually;
  return std::clamp(std::sqrt(kFallbackShare * limit.limit / whole_cost), kCoarsestAfterJump,
                    usually);
}

}  // namespace rilievo
