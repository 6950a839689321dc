#include "rilievo/frame/cpu/software_frames.h"

#include "rilievo/core/expects.h"

namespace rilievo {

bool SoftwareFrames::draws_all_of(const Scene& scene) {
  const PlacedScene placed(scene);
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i)
    if (placed.has_blended_parts(i)) return false;
  return true;
}

SoftwareFrames::SoftwareFrames(const Scene& scene, int samples)
    : placed_(scene),
      samples_(samples),
      target_(1, 1, samples),
      polygons_(scene),
      sky_tiles_(scene.sky) {}

void SoftwareFrames::place_sets(Output output) {
  RILIEVO_EXPECTS_EQ(set_drawers_.size(), content_.sets.size());
  drawers_.clear();
  drawers_.push_back(&polygons_);
  for (std::size_t i = 0; i < set_drawers_.size(); ++i) {
    FrameContent::Set& set = content_.sets[i];
    if (set.instances.empty()) continue;
    set.drawable->draw(camera_, set.instances, output);
    drawers_.push_back(set_drawers_[i]);
  }
}

Result<> SoftwareFrames::draw(const Camera& camera, double time) {
  camera_ = camera;
  placed_.set_time(time);
  content_.clear();
  stats_.captures = 0, stats_.capture_ms = 0, stats_.bound_px = stats_.gap_px = 0;
  if (Result<> chosen = choose(camera, content_, stats_); !chosen) return chosen;
  count_drawn(content_, stats_);
  if (target_.width() != camera.width || target_.height() != camera.height)
    target_ = SoftwareTarget(camera.width, camera.height, samples_);
  if (Result<> done =
          polygons_.place(camera, samples_, placed_, content_.polygons, content_.fading);
      !done)
    return done;
  place_sets(Output::color);
  drawers_.push_back(&polygons_.shading());
  if (sky_) {
    sky_tiles_.place(camera);
    drawers_.push_back(&sky_tiles_);
  }
  target_.draw(camera.z_far, drawers_);
  return Done{};
}

Result<> SoftwareFrames::draw_objects() {
  prepare_objects();
  if (Result<> done = polygons_.place_objects(camera_, placed_, content_.polygons, content_.fading);
      !done)
    return done;
  place_sets(Output::object_id);
  target_.draw_objects(camera_.z_far, drawers_);
  return Done{};
}

void SoftwareFrames::append_errors(int step, std::vector<float>& errors_px) const {
  for (const FrameContent::Set& set : content_.sets)
    if (!set.instances.empty())
      set.drawable->append_errors(camera_, set.instances, step, errors_px);
}

Result<> SoftwareDirectFrames::choose(const Camera& camera, FrameContent& content, FrameStats&) {
  placed().cull(camera, content.polygons);
  return Done{};
}

}  // namespace rilievo
