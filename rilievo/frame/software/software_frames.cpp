#include "rilievo/frame/software/software_frames.h"

#include <utility>

#include "rilievo/core/expects.h"

namespace rilievo {

SoftwareFrames::SoftwareFrames(SoftwareBackend& backend, std::unique_ptr<FrameChooser> chooser,
                               std::unique_ptr<FrameVisibility> visibility)
    : chooser_(std::move(chooser)),
      backend_(backend),
      placed_(backend.placed()),
      target_(1, 1, backend.samples()),
      polygons_(placed_.scene(), std::move(visibility)),
      sky_tiles_(placed_.scene().sky),
      blended_tiles_(placed_.scene()) {
  for (std::uint32_t i = 0; i < placed_.scene().objects.size(); ++i)
    blends_ = blends_ || placed_.has_blended_parts(i);
  chooser_->add_sets(content_);
}

void SoftwareFrames::place_sets(Output output) {
  drawers_.clear();
  drawers_.push_back(&polygons_);
  for (const FrameContent::Set& set : content_.sets) {
    if (set.instances.empty()) continue;
    set.drawable->set_samples(target_.samples());
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
    return !placed_.has_blended_parts(object) || chooser_->shows_blended(object);
  });
  blended_tiles_.place(camera_, target_.samples(), placed_, blended_in_view_);
  if (blended_tiles_.any()) drawers_.push_back(&blended_tiles_);
}

void SoftwareFrames::place_outlines() {
  for (const FrameContent::Set& set : content_.sets) {
    if (set.instances.empty()) continue;
    set.drawable->draw_outlines(camera_, set.instances);
    if (set.drawable->outline_tiles()) drawers_.push_back(set.drawable->outline_tiles());
  }
}

Result<> SoftwareFrames::draw_chosen() {
  if (Result<> chosen = chooser_->choose(camera_, placed_, content_, stats_); !chosen)
    return chosen;
  count_drawn(content_, stats_);
  if (target_.width() != camera_.width || target_.height() != camera_.height)
    target_ = SoftwareTarget(camera_.width, camera_.height, target_.samples());
  if (Result<> done =
          polygons_.place(camera_, target_.samples(), placed_, content_.polygons, content_.fading);
      !done)
    return done;
  place_sets(Output::color);
  drawers_.push_back(&polygons_.shading());
  if (content_.sky) {
    sky_tiles_.set(content_.sky_over(placed_.scene()));
    sky_tiles_.place(camera_);
    drawers_.push_back(&sky_tiles_);
  }
  place_blended();
  if (content_.outlines) place_outlines();
  target_.draw(camera_.z_far, drawers_);
  return Done{};
}

Result<> SoftwareFrames::draw(const Camera& camera, double time) {
  camera_ = camera;
  time_ = time;
  backend_.set_time(time);
  content_.clear();
  stats_.captures = 0, stats_.capture_ms = 0, stats_.gap_px = 0;
  stats_.bound_px.reset();
  Result<> done = draw_chosen();
  const FrameWork work{done ? polygons_.work() : std::span<const ObjectWork>()};
  chooser_->drawn(done ? &work : nullptr, stats_);
  return done;
}

Result<> SoftwareFrames::draw_objects() {
  backend_.set_time(time_);
  chooser_->prepare_objects();
  if (Result<> done = polygons_.place_objects(camera_, placed_, content_.polygons, content_.fading);
      !done)
    return done;
  place_sets(Output::object_id);
  target_.draw_objects(camera_.z_far, drawers_);
  return Done{};
}

}  // namespace rilievo
