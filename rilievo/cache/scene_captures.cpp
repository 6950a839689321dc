// What is captured for a frame, and what has been captured beside the last ones: the part of
// SceneCache that carries out plans.
#include <cmath>

#include "rilievo/cache/scene_cache.h"
#include "rilievo/core/stopwatch.h"

namespace rilievo {

void SceneCache::release(std::uint32_t slot) {
  if (slot >= held_.size() || !held_[slot].held) return;
  store_->free(stored(slot));
  held_[slot].held = false;
}

void SceneCache::hold(const Capture& capture) {
  if (capture.slot >= held_.size()) held_.resize(capture.slot + 1);
  Held& held = held_[capture.slot];
  held.held = true;
  held.objects_captured = false;
  held.camera = capture.geometry.capture;
  objects_of(capture.entity, held.objects);
}

void SceneCache::order_captures() {
  for (const std::uint32_t slot : plan_.evictions) release(slot);
  if (plan_.captures.empty()) return;
  if (!beside_) beside_ = std::make_unique<CapturesBeside>(*store_->rasterizer(), options_.samples);
  for (const Capture& planned : plan_.captures) {
    Capture capture = planned;
    objects_of(capture.entity, ordered_objects_);
    capture.geometry.strokes = capture.picture.geometry.strokes =
        placed_.stroke_size(ordered_objects_);
    if (capture.entity < hierarchy_.nodes.size())
      show_levels(ordered_objects_, capture.picture.level_error);
    beside_->order(capture, ordered_objects_, std::isfinite(gap_limit_px(policy_)));
  }
}

// Takes what has been captured beside the last frames.
void SceneCache::adopt_captures(const Camera& camera, FrameStats& stats) {
  if (!beside_) return;
  const Stopwatch watch;
  while (OrderedCapture* made = beside_->take()) {
    Capture& capture = made->capture;
    clock_.capture.learn(capture.cost, made->ms);
    if (!is_wanted(capture, state_)) continue;
    const std::uint32_t slot = stored(capture.slot);
    if (!store_->allocate(slot, made->picture.width, made->picture.height)) {
      cancel_order(capture, state_);
      continue;
    }
    store_->write(slot, made->picture, capture.geometry.delta_bits);
    gone_.clear();
    if (!adopt_capture(capture, camera, hierarchy_, moving_, store_->delta_range(slot), made->gaps,
                       policy_, state_, gone_)) {
      store_->free(slot);
      continue;
    }
    for (const std::uint32_t old : gone_) release(old);
    hold(capture);
    ++stats.captures;
  }
  if (stats.captures > 0) stats.capture_ms = watch.ms();
}

void SceneCache::make(std::span<const std::uint32_t> evictions, std::span<const Capture> captures,
                      std::span<MadeCapture> made) {
  for (const std::uint32_t slot : evictions) release(slot);
  if (captures.empty()) return;
  finish_captures();  // of a budget that is over: they use the rasteriser
  const Stopwatch watch;
  double cost = 0, priced = 0, priced_ms = 0;
  for (std::size_t i = 0; i < captures.size(); ++i) {
    const Capture& capture = captures[i];
    const Camera& eye = capture.geometry.capture;
    const std::uint32_t slot = stored(capture.slot);
    if (!store_->allocate(slot, eye.width, eye.height)) continue;
    made[i].made = true;
    hold(capture);
    const std::vector<std::uint32_t>& objects = held_[capture.slot].objects;
    made[i].strokes = placed_.stroke_size(objects);
    ++stats_->captures;
    const double before_ms = watch.ms();
    if (capture.entity < hierarchy_.nodes.size()) show_levels(objects, capture.picture.level_error);
    store_->capture(slot, eye, objects);
    if (std::isfinite(gap_limit_px(policy_)))
      made[i].gaps = capture.once ? unknown_gaps(eye) : store_->gaps(eye, objects);
    cost += capture.cost;
    if (capture.once) continue;  // without gaps it costs less
    priced_ms += watch.ms() - before_ms;
    priced += capture.cost;
  }
  clock_.capture.learn(priced, priced_ms);
  for (std::size_t i = 0; i < captures.size(); ++i)
    if (made[i].made) made[i].range = store_->delta_range(stored(captures[i].slot));
  store_->finish();
  stats_->capture_ms = watch.ms();
  if (cost > 0 && stats_->capture_ms > 0) {
    const double now = cost / stats_->capture_ms;
    // The first measurement includes the driver's warm-up; later ones smooth it away.
    cost_per_ms_ = cost_per_ms_ > 0 ? 0.8 * cost_per_ms_ + 0.2 * now : now;
  }
}

MadeCapture SceneCache::make(const Fallback& fallback) {
  const Stopwatch watch;
  fallback_.camera = fallback.geometry.capture;
  const Camera& eye = fallback_.camera;
  fallback_.objects.clear();
  for (const std::uint32_t object : fallback.objects)
    fallback_.objects.push_back(static_objects_[object]);
  const RasterPicture* picture =
      coarse_->capture(eye, float(1 / fallback.texel_px), fallback_.objects);
  if (!picture || !store_->allocate(kFallbackSlot, eye.width, eye.height)) return {};
  fallback_.held = true;
  fallback_.objects_captured = false;
  store_->write(kFallbackSlot, *picture, store_->written_bits());
  clock_.fallback.learn(unlimited_.cost.fallback_texel * eye.width * eye.height, watch.ms());
  ++stats_->captures;
  stats_->capture_ms += watch.ms();
  return {.made = true, .range = store_->delta_range(kFallbackSlot), .gaps = {}, .strokes = {}};
}

void SceneCache::finish_captures() {
  if (beside_) beside_->finish();
}

}  // namespace rilievo
