#include "rilievo/method/surroundings.h"

#include <algorithm>
#include <utility>

#include "rilievo/core/expects.h"
#include "rilievo/core/stopwatch.h"

namespace rilievo {

Result<std::unique_ptr<SurroundingChooser>> SurroundingChooser::create(
    const PlacedScene& placed, CaptureSource& source, const Kind& kind,
    std::unique_ptr<DrawableFactory> factory, const SurroundingFramesOptions& options) {
  RILIEVO_EXPECTS(kind.stands_for == StandsFor::surroundings);
  std::unique_ptr<SurroundingChooser> frames(new SurroundingChooser);
  frames->factory_ = std::move(factory);
  frames->outlines_ = options.outlines;
  const Stopwatch watch;
  const std::vector<Object>& objects = placed.scene().objects;
  std::vector<std::uint32_t> still;
  for (std::uint32_t object = 0; object < objects.size(); ++object)
    if (!objects[object].moving) still.push_back(object);
  frames->baked_.assign(objects.size(), false);
  for (const std::uint32_t object : still) frames->baked_[object] = true;
  const auto progress = [&](int done, int total) {
    frames->captures_ = std::max(frames->captures_, done);
    if (options.progress) options.progress(done, total);
  };
  // No list at all where it would name everything: the source then culls for itself.
  if (still.size() == objects.size()) still.clear();
  Result<Baked> baked =
      kind.bake({source, std::move(still), options.eyes, options.eye_path}, options.bake, progress);
  if (!baked) return baked.error();
  for (const Fact& fact : baked->facts)
    if (options.note) options.note(std::string(kind.name) + ": " + fact.label + " " + fact.text);
  Result<std::unique_ptr<Drawable>> drawable =
      frames->factory_->make_drawable(std::move(baked->representation), options.draw);
  if (!drawable) return drawable.error();
  frames->drawable_ = std::move(*drawable);
  frames->error_ = frames->drawable_->error_model(0);
  frames->capture_ms_ = watch.ms();
  return {std::move(frames)};
}

void SurroundingChooser::add_sets(FrameContent& content) {
  content.sets.push_back({drawable_.get(), {}});
}

Result<> SurroundingChooser::choose(const Camera& camera, const PlacedScene& placed,
                                    FrameContent& content, FrameStats& stats) {
  camera_ = camera;
  content.outlines = outlines_;
  content.sets[0].instances.push_back({});
  visible_.clear();
  placed.cull(camera, visible_);
  for (const std::uint32_t object : visible_)
    if (!baked_[object]) content.polygons.push_back(object);
  stats.captures = std::exchange(captures_, 0);
  stats.capture_ms = std::exchange(capture_ms_, 0);
  stats.picture_bytes = drawable_->bytes();
  return Done{};
}

void SurroundingChooser::drawn(const FrameWork*, FrameStats& stats) {
  stats.bound_px = 0;
  widen_bounds(error_, {}, camera_, stats);
}

}  // namespace rilievo
