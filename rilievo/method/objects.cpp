#include "rilievo/method/objects.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rilievo/core/stopwatch.h"

namespace rilievo {

Result<std::unique_ptr<ObjectChooser>> ObjectChooser::create(
    const PlacedScene& placed, CaptureSource& source, const Kind& kind,
    std::unique_ptr<DrawableFactory> factory, const ObjectFramesOptions& options) {
  std::unique_ptr<ObjectChooser> frames(new ObjectChooser);
  frames->factory_ = std::move(factory);
  frames->max_texel_px_ = options.max_texel_px;
  frames->outlines_ = options.outlines;
  frames->baked_of_.assign(placed.scene().objects.size(), -1);

  const Stopwatch watch;
  ObjectDrawablesOptions bake = options.objects;
  bake.progress = [&](int done, int total) {
    frames->captures_ = std::max(frames->captures_, done);
    if (options.objects.progress) options.objects.progress(done, total);
  };
  Result<std::vector<ObjectDrawable>> made =
      bake_object_drawables(placed, source, kind, *frames->factory_, bake);
  if (!made) return made.error();
  for (ObjectDrawable& object : *made) {
    for (const std::uint32_t served : object.objects)
      frames->baked_of_[served] = int(frames->baked_.size());
    frames->bytes_ += object.drawable->bytes();
    const ErrorModel error = object.drawable->error_model(0);
    frames->baked_.push_back({std::move(object), error});
  }
  frames->capture_ms_ = watch.ms();
  return {std::move(frames)};
}

std::optional<Instance> ObjectChooser::instance_of(std::uint32_t object, const Camera& camera,
                                                   const PlacedScene& placed) const {
  const int i = baked_of_[object];
  if (i < 0) return std::nullopt;
  const Baked& baked = baked_[std::size_t(i)];
  const std::optional<glm::dmat4> motion = motion_of(baked.object, placed.poses()[object]);
  if (!motion || !std::isfinite(baked.error.bound_px(*motion, camera))) return std::nullopt;
  const double scale = glm::length(glm::dvec3((*motion)[0]));
  const glm::dvec3 center(*motion * glm::dvec4(baked.error.bounds.center(), 1));
  const double distance = glm::length(center - camera.position());
  if (scale * baked.error.texel > max_texel_px_ * texel_angle(camera) * distance)
    return std::nullopt;
  return Instance{*motion, 0, object + 1};
}

void ObjectChooser::add_sets(FrameContent& content) {
  for (const Baked& baked : baked_) content.sets.push_back({baked.object.drawable.get(), {}});
}

Result<> ObjectChooser::choose(const Camera& camera, const PlacedScene& placed,
                               FrameContent& content, FrameStats& stats) {
  content.outlines = outlines_;
  stats.bound_px = 0;
  visible_.clear();
  placed.cull(camera, visible_);
  for (const std::uint32_t object : visible_) {
    const std::optional<Instance> instance = instance_of(object, camera, placed);
    if (!instance) {
      content.polygons.push_back(object);
      continue;
    }
    const auto i = std::size_t(baked_of_[object]);
    content.sets[i].instances.push_back(*instance);
    widen_bounds(baked_[i].error, *instance, camera, stats);
  }
  stats.captures = std::exchange(captures_, 0);
  stats.capture_ms = std::exchange(capture_ms_, 0);
  stats.picture_bytes = bytes_;
  return Done{};
}

}  // namespace rilievo
