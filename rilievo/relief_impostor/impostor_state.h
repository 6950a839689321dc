// What does a frame show of an object with a relief impostor, and what is ordered? (S5.1, S5.7)
//
// A pure function of what is there and how wrong it is. The frame never waits: whatever is late, it
// shows the best of what is there. Any thread; allocates nothing.
#pragma once

#include <limits>

namespace rilievo {

// What the frame draws.
enum class ImpostorShown {
  nothing,  // neither a picture that will do, nor triangles
  object,   // the object itself, by the frame's own renderer
  fresh,    // the last warp: no pixel would change by another one
  stale,    // the last warp, of an eye that has moved since
};

// What is there for one object, seen from the frame's eye.
struct ImpostorSituation {
  bool drawable = true;    // can the frame's renderer draw the object itself?
  bool picture = false;    // has the shader made one?
  bool final = false;      // ... of full resolution and all samples
  double stretch = 0;      // the picture's error for this eye (critical points, or the share of
                           // interpolated texels); infinite where it cannot be warped
  bool warped = false;     // is there a warp of the picture?
  double moved_px = 0;     // what the warp shows lies off by this much by now, pixels
  bool warping = false;    // is a warp ordered or being made?
  bool rendering = false;  // is a picture ordered or being made?
  double rendered_stretch = 0;  // its error for this eye, once it is done
  // The error of the picture that is there, for where the eye will be when another one could be.
  double later_stretch = 0;
  // What the picture shows has deformed since by this much at most, pixels.
  double deformed_px = 0;
  double shown_deformed_px = 0;  // ... and what the warp shows
  // A newer picture than that one, which serves this eye, shows nothing of the object.
  bool empty = false;
};

// When is what good enough?
struct ImpostorLimits {
  double still_px = 0.5;  // below, a new warp would show the same (S5.7)
  double stale_px = 8;    // an older warp is shown up to this, if there is an object to draw
  double refresh = 1.3;   // stretch beyond which a new picture is ordered
  double drop = 3;        // ... beyond which the picture is not shown, if there is an object
};

// The decision.
struct ImpostorStep {
  ImpostorShown shown = ImpostorShown::object;
  bool order_warp = false, order_render = false;
  bool cancel_render = false;  // what is being rendered is for an eye that nobody needs any more
  friend bool operator==(const ImpostorStep&, const ImpostorStep&) = default;
};

// Decides.
[[nodiscard]] ImpostorStep next_step(const ImpostorSituation& now, const ImpostorLimits& limits);

// How urgent the ordered work is: larger first; warps come before every picture (S5.1, S5.5).
// What has no picture at all comes before what has a bad one.
[[nodiscard]] double render_priority(const ImpostorSituation& now);

}  // namespace rilievo
