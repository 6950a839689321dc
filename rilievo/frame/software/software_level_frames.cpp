#include "rilievo/frame/software/software_level_frames.h"

#include <utility>

namespace rilievo {

std::unique_ptr<SoftwareLevelFrames> SoftwareLevelFrames::create(ObjectLevels levels, int samples,
                                                                 double error_px) {
  return std::unique_ptr<SoftwareLevelFrames>(new SoftwareLevelFrames(
      std::make_unique<ObjectLevels>(std::move(levels)), samples, error_px));
}

Result<> SoftwareLevelFrames::choose(const Camera& camera, FrameContent& content,
                                     FrameStats& stats) {
  placed().cull(camera, content.polygons);
  stats.bound_px = choose_levels(camera, content.polygons, placed().poses(), placed().bounds(),
                                 error_px_, *levels_);
  return Done{};
}

}  // namespace rilievo
