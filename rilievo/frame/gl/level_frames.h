// How is a scene drawn by levels of detail? A baseline: what most engines do.
//
// Each object by the coarsest of its levels (scene/levels.h) whose error appears at most
// `error_px` pixels large at the nearest point of its bounds.
#pragma once

#include <memory>

#include "rilievo/frame/gl/scene_frames.h"
#include "rilievo/scene/levels.h"

namespace rilievo {

// A frame source with levels of detail, by OpenGL.
class LevelFrames final : public SceneFrames {
 public:
  // Makes the levels of `scene`, with a copy of it.
  [[nodiscard]] static Result<std::unique_ptr<LevelFrames>> create(const Scene& scene,
                                                                   double error_px);
  ~LevelFrames() override;

 private:
  // The scene and its renderer; where objects get their levels.
  struct Levels;
  LevelFrames(std::unique_ptr<Levels> levels, double error_px);
  Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) override;

  std::unique_ptr<Levels> levels_;
  double error_px_;
};

}  // namespace rilievo
