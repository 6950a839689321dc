#include "rilievo/frame/software/software_frames.h"

#include <utility>

#include "rilievo/core/expects.h"

namespace rilievo {

SoftwareFrames::SoftwareFrames(const Scene& scene, int samples, const Deformations* deformations)
    : SoftwareFrames(scene, samples, deformations, nullptr) {}

SoftwareFrames::SoftwareFrames(const Scene& scene, int samples,
                               std::unique_ptr<FrameVisibility> visibility)
    : SoftwareFrames(scene, samples, nullptr, std::move(visibility)) {}

SoftwareFrames::SoftwareFrames(const Scene& scene, int samples, const Deformations* deformations,
                               std::unique_ptr<FrameVisibility> visibility)
    : deformations_(deformations),
      bent_(deformations && !deformations->meshes.empty() ? std::make_unique<Scene>(scene)
                                                          : nullptr),
      placed_(bent_ ? *bent_ : scene),
      samples_(samples),
      target_(1, 1, samples),
      polygons_(placed_.scene(), std::move(visibility)),
      sky_tiles_(scene.sky),
      blended_tiles_(placed_.scene()) {
  for (std::uint32_t i = 0; i < scene.objects.size(); ++i)
    blends_ = blends_ || placed_.has_blended_parts(i);
}

void SoftwareFrames::place_sets(Output output) {
  drawers_.clear();
  drawers_.push_back(&polygons_);
  for (const FrameContent::Set& set : content_.sets) {
    if (set.instances.empty()) continue;
    set.drawable->set_samples(samples_);
    set.drawable->draw(camera_, set.instances, output);
    RILIEVO_EXPECTS(set.drawable->tiles() != nullptr);
    drawers_.push_back(set.drawable->tiles());
  }
}

void SoftwareFrames::place_blended() {
  blended_in_view_.clear();
  if (!blends_) return;
  placed_.cull(camera_, blended_in_view_);
  std::erase_if(blended_in_view_, [&](std::uint32_t object) {
    return !placed_.has_blended_parts(object) || shows_blended(object);
  });
  blended_tiles_.place(camera_, samples_, placed_, blended_in_view_);
  if (blended_tiles_.any()) drawers_.push_back(&blended_tiles_);
}

void SoftwareFrames::place_outlines() {
  for (const FrameContent::Set& set : content_.sets) {
    if (set.instances.empty()) continue;
    set.drawable->draw_outlines(camera_, set.instances);
    if (set.drawable->outline_tiles()) drawers_.push_back(set.drawable->outline_tiles());
  }
}

Result<> SoftwareFrames::draw(const Camera& camera, double time) {
  camera_ = camera;
  placed_.set_time(time);
  if (bent_ && time != bent_to_) {
    bend(*deformations_, time, *bent_);
    bent_to_ = time;
    placed_.update_bounds();
  }
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
  place_blended();
  if (outlines_) place_outlines();
  target_.draw(camera.z_far, drawers_);
  learn(polygons_.work());
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

Result<> SoftwareDirectFrames::choose(const Camera& camera, FrameContent& content, FrameStats&) {
  placed().cull(camera, content.polygons);
  return Done{};
}

}  // namespace rilievo
