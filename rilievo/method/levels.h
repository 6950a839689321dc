// Levels of detail: a baseline, as most engines have it.
#pragma once

#include <memory>

#include "rilievo/frame/leveled_backend.h"

namespace rilievo {

// Chooses each object's coarsest level whose error appears at most so many pixels large.
class LevelChooser final : public FrameChooser {
 public:
  LevelChooser(std::unique_ptr<LeveledBackend> levels, double error_px)
      : levels_(std::move(levels)), error_px_(error_px) {}

  // From the next frame on.
  void set_error(double error_px) { error_px_ = error_px; }

  void add_sets(FrameContent&) override {}
  Result<> choose(const Camera& camera, const PlacedScene& placed, FrameContent& content,
                  FrameStats& stats) override;

 private:
  std::unique_ptr<LeveledBackend> levels_;
  double error_px_;
};

// How many triangles `objects`, as `placed`, have for the camera at such an error.
[[nodiscard]] double count_level_triangles(const Camera& camera,
                                           std::span<const std::uint32_t> objects,
                                           const PlacedScene& placed, double error_px,
                                           LeveledBackend& levels);

// Frames of `levels`. Fails where the backend of their scene cannot be made.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_level_frames(const Backend& backend,
                                                                     ObjectLevels levels,
                                                                     double error_px);

}  // namespace rilievo
