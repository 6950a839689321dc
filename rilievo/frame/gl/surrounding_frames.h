// How is a scene drawn from a baked representation of its static parts, seen from within?
//
// Moving objects are drawn as polygons into the same z-buffer.
#pragma once

#include <memory>
#include <vector>

#include "rilievo/frame/gl/scene_frames.h"
#include "rilievo/kind/kind.h"

namespace rilievo {

// What to bake.
struct SurroundingFramesOptions {
  OptionValues bake, draw;  // of the kind
  Box eyes = {};            // the region of the eyes; empty: unknown
  Progress progress;
};

// A frame source for baked surroundings.
class SurroundingFrames final : public SceneFrames {
 public:
  // Bakes at the renderer's time. Requires a kind that stands for surroundings. `renderer` must
  // outlive the source. Fails where a bake fails.
  [[nodiscard]] static Result<std::unique_ptr<SurroundingFrames>> create(
      SceneRenderer& renderer, const Kind& kind, std::unique_ptr<DrawableFactory> factory,
      const SurroundingFramesOptions& options);

 private:
  explicit SurroundingFrames(SceneRenderer& renderer) : SceneFrames(renderer) {}
  Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) override;

  std::unique_ptr<DrawableFactory> factory_;
  std::unique_ptr<Drawable> drawable_;
  std::vector<bool> baked_;  // by object
  std::vector<std::uint32_t> visible_;
  int captures_ = 0;  // since the last frame
  double capture_ms_ = 0;
};

}  // namespace rilievo
