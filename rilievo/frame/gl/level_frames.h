// How is a scene drawn by levels of detail? A baseline: what most engines do.
//
// object_levels.h chooses them. frame/software/software_level_frames.h draws them without OpenGL.
#pragma once

#include <memory>

#include "rilievo/frame/gl/scene_frames.h"
#include "rilievo/frame/object_levels.h"

namespace rilievo {

// A frame source with levels of detail, by OpenGL.
class LevelFrames final : public SceneFrames {
 public:
  // Fails where OpenGL does.
  [[nodiscard]] static Result<std::unique_ptr<LevelFrames>> create(ObjectLevels levels,
                                                                   double error_px);
  ~LevelFrames() override;

 private:
  // The scene and its renderer.
  struct Levels;
  LevelFrames(std::unique_ptr<Levels> levels, double error_px);
  Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) override;

  std::unique_ptr<Levels> levels_;
  double error_px_;
};

}  // namespace rilievo
