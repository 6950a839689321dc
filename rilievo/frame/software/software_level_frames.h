// How is a scene drawn by levels of detail without OpenGL? A baseline, by our rasteriser.
//
// object_levels.h chooses them; frame/gl/level_frames.h draws them with OpenGL.
#pragma once

#include <memory>

#include "rilievo/frame/object_levels.h"
#include "rilievo/frame/software/software_frames.h"

namespace rilievo {

// A frame source with levels of detail, by the rasteriser.
class SoftwareLevelFrames final : public SoftwareFrames {
 public:
  // `samples` of a pixel: 1 or 4.
  [[nodiscard]] static std::unique_ptr<SoftwareLevelFrames> create(ObjectLevels levels, int samples,
                                                                   double error_px);

 private:
  SoftwareLevelFrames(std::unique_ptr<ObjectLevels> levels, int samples, double error_px)
      : SoftwareFrames(levels->leveled.scene, samples),
        levels_(std::move(levels)),
        error_px_(error_px) {}
  Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) override;

  std::unique_ptr<ObjectLevels> levels_;  // stays where it is: frames are drawn from its scene
  double error_px_;
};

}  // namespace rilievo
