// What is a frame drawn from?
//
// Chosen anew for every frame: which objects are polygons, and which instances of which drawables
// stand for the others. Buffers are kept between frames, so that choosing does not allocate.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string_view>
#include <utility>
#include <vector>

#include "rilievo/kind/drawable.h"
#include "rilievo/render/cross_fade.h"

namespace rilievo {

struct FrameContent {
  struct Set {
    Drawable* drawable = nullptr;  // outlives the frame
    std::vector<Instance> instances;
  };
  std::vector<Set> sets;                // drawn in this order
  std::vector<std::uint32_t> polygons;  // indices into Scene::objects
  std::vector<CrossFade> fading;        // likewise; an object may have several ranges

  // Forgets the last frame's choice, not its sets.
  void clear() {
    for (Set& set : sets) set.instances.clear();
    polygons.clear();
    fading.clear();
  }
};

// What the last frame did.
struct FrameStats {
  int captures = 0;               // pictures captured in this frame
  double capture_ms = 0;          // their share of the frame, wall clock
  std::size_t picture_bytes = 0;  // memory that pictures hold now
  double bound_px = 0;            // largest error bound of what was drawn, pixels; 0: not known
  double gap_px = 0;              // largest bound of a strip that pictures lack; 0: none, not known
  int polygons = 0;               // objects drawn as polygons
  int groups = 0;                 // instances drawn that show several objects each
  // Instances drawn that show one object, by kind.
  std::vector<std::pair<std::string_view, int>> by_kind;

  [[nodiscard]] int count(std::string_view kind) const {
    for (const auto& [name, number] : by_kind)
      if (name == kind) return number;
    return 0;
  }
};

}  // namespace rilievo
