// The content of a frame: everything that is drawn, and from what.
//
// For each frame: which objects are drawn as polygons, and which instances of which
// drawables stand for the others. Buffers are kept between frames, so that choosing does not
// allocate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "rilievo/kind/drawable.h"
#include "rilievo/render/cross_fade.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// The contents of one frame.
struct FrameContent {
  // A drawable and its instances.
  struct Set {
    Drawable* drawable = nullptr;  // outlives the frame
    std::vector<Instance> instances;
  };
  std::vector<Set> sets;                // drawn in this order
  std::vector<std::uint32_t> polygons;  // indices into Scene::objects
  std::vector<CrossFade> fading;  // polygons with a cross-fade range; an object can have several
  bool outlines = false;          // draw outlines around pictures (S1.8)
  bool sky = true;                // draw the sky behind everything

  // The sky of a frame: of the first drawn set that knows one if the scene is empty, so that a
  // baked file is seen under its own; else the scene's.
  [[nodiscard]] const Sky& sky_over(const Scene& scene) const;

  // Removes all instances and polygons but keeps the sets.
  void clear() {
    outlines = false, sky = true;
    for (Set& set : sets) set.instances.clear();
    polygons.clear();
    fading.clear();
  }
};

// Which of several methods drew a frame, and why. Names that last as long as the program.
struct FrameDecision {
  std::string_view method, reason;  // empty: there was nothing to decide
  double expected_ms = 0;           // what the method takes, by the frames before; 0: unknown
  std::string_view rival;           // the next best, as far as is known; empty: none
  double rival_ms = 0;

  // One sentence: "cache (the cheapest: 21.3 ms, direct 30.1 ms)".
  [[nodiscard]] std::string sentence() const;
};

// Statistics of the last frame.
struct FrameStats {
  int captures = 0;               // pictures captured in this frame
  double capture_ms = 0;          // wall-clock time that this frame spent on captures
  std::size_t picture_bytes = 0;  // memory of pictures now
  // The largest error bound of anything drawn, pixels. 0: the frame is exact. Absent: something in
  // it has no bound, or is seen from where its bound does not hold.
  std::optional<double> bound_px;
  double gap_px = 0;  // the largest bound of the width of gaps, pixels; 0: none, or unknown
  int polygons = 0;   // objects drawn as polygons
  int groups = 0;     // instances drawn that show several objects each
  // Keyframes: the shares of the pixels that rays fill because no keyframe shows them, and that
  // show polygons; and the number of coarse keyframes that stand for late ones.
  double filled_share = 0, live_share = 0;
  int late = 0;
  FrameDecision decision;
  // Instances drawn that show one object each, by kind:
  std::vector<std::pair<std::string_view, int>> by_kind;

  // The number of instances of a kind.
  [[nodiscard]] int count(std::string_view kind) const {
    for (const auto& [name, number] : by_kind)
      if (name == kind) return number;
    return 0;
  }
};

// Sets the numbers of what is drawn: polygons, groups and by_kind.
void count_drawn(const FrameContent& content, FrameStats& stats);

// Widens the bounds of a frame to those of an instance that it draws, whose error `error` is. The
// first call needs stats.bound_px = 0; an instance without a bound makes it absent.
void widen_bounds(const ErrorModel& error, const Instance& instance, const Camera& frame,
                  FrameStats& stats);

}  // namespace rilievo
