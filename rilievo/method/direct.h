// Direct drawing: every object as polygons. The true frame, and the baseline.
#pragma once

#include "rilievo/frame/frame_chooser.h"

namespace rilievo {

// Chooses polygons for everything in view.
class DirectChooser final : public FrameChooser {
 public:
  void add_sets(FrameContent&) override {}
  Result<> choose(const Camera& camera, const PlacedScene& placed, FrameContent& content,
                  FrameStats& stats) override {
    stats.bound_px = 0;
    placed.cull(camera, content.polygons);
    return Done{};
  }
};

}  // namespace rilievo
