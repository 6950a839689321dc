#include "rilievo/frame/gl/direct_frames.h"

namespace rilievo {

Result<> DirectFrames::draw(const Camera& camera, double time) {
  camera_ = camera;
  time_ = time;
  renderer_.set_time(time);
  visible_.clear();
  renderer_.cull(camera, visible_);
  renderer_.draw_opaque(camera, visible_, OutputEncoding::srgb);
  renderer_.draw_sky(camera, OutputEncoding::srgb);
  renderer_.draw_blended(camera, visible_, OutputEncoding::srgb);
  figures_ = {};
  figures_.polygons = int(visible_.size());
  return Done{};
}

Result<> DirectFrames::draw_objects() {
  renderer_.set_time(time_);
  renderer_.draw_objects(camera_, visible_);
  return Done{};
}

}  // namespace rilievo
