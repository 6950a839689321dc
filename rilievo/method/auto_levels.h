// Levels of detail for `auto`: prepared beside the frames, and measured before anyone sees them.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "rilievo/keyframes/software/sampled_loss.h"
#include "rilievo/method/levels.h"
#include "rilievo/render/rays/ray_scene.h"

namespace rilievo {

// How much less like the truth frames are than direct drawing, as rays measure it.
class LevelsLoss {
 public:
  explicit LevelsLoss(RayScene rays) : rays_(std::move(rays)), loss_(rays_) {}

  // Looks at some pixels of a frame of `objects`, `times` as many as SampledLoss does.
  void add(const Camera& camera, std::span<const std::uint32_t> objects, const Rgba8Image& color,
           int times);
  void forget() { loss_.forget(); }
  // dB; none: too little was seen.
  [[nodiscard]] std::optional<double> db() const;

 private:
  RayScene rays_;
  SampledLoss loss_;
  Image<std::uint32_t> shown_;
};

// Frames of levels, with what they are drawn from.
struct AutoLevels {
  LeveledBackend* levels = nullptr;  // of the frames, as the chooser
  LevelChooser* chooser = nullptr;
  std::unique_ptr<FrameSource> frames;  // null: of a backend that must make them on its own thread
  double error_px = 0;
  std::unique_ptr<LevelsLoss> loss;  // null: it is not known how good they are
  std::optional<ObjectLevels> made;  // what the frames are made of, until there are frames
};

// The view that levels are prepared for.
struct AutoLevelsOptions {
  Camera camera;
  double time = 0;
  std::vector<std::uint32_t> in_view;  // objects
  double error_px = 1;
  double loss_db = 4;         // of frames that are good enough
  bool measure_loss = false;  // nothing moves, and memory suffices for a tree of all triangles
};

// Makes levels of the scene, on any thread. Draws a first frame of a software backend: this
// touches all of a target's memory, and tells how good the levels are. Their error, which
// simplification only estimates, is error_px where that is good enough, else half of it.
[[nodiscard]] AutoLevels prepare_levels(const Backend& backend, const Scene& scene,
                                        const AutoLevelsOptions& options);

// Makes the frames, if prepare_levels() did not. Fails where their backend cannot be made.
[[nodiscard]] Result<> finish_levels(const Backend& backend, double error_px, AutoLevels& levels);

}  // namespace rilievo
