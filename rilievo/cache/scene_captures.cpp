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

// Their size is a part of the bound (nailboard/error.h).
void SceneCache::count_strokes(std::span<const std::uint32_t> objects, Capture& capture) const {
  capture.geometry.strokes = placed_.stroke_size(objects);
  capture.picture.geometry.strokes = capture.geometry.strokes;
}

void SceneCache::order_captures() {
  if (plan_.captures.empty()) return;
  if (!beside_) beside_ = std::make_unique<CapturesBeside>(*store_->rasterizer(), options_.samples);
  for (Capture& capture : plan_.captures) {
    objects_of(capture.entity, ordered_objects_);
    count_strokes(ordered_objects_, capture);
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

void SceneCache::capture(std::size_t index, const std::vector<std::uint32_t>& objects) {
  const Capture& capture = plan_.captures[index];
  const Camera& eye = capture.geometry.capture;
  if (capture.entity < hierarchy_.nodes.size()) show_levels(objects, capture.picture.level_error);
  store_->capture(stored(capture.slot), eye, objects);
  if (!std::isfinite(gap_limit_px(policy_))) return;
  gaps_[index] = capture.once ? unknown_gaps(eye) : store_->gaps(eye, objects);
}

void SceneCache::carry_out_captures(const Camera& camera, FrameStats& stats) {
  if (plan_.captures.empty()) return;
  finish_captures();  // of a budget that is over: they use the rasteriser
  const Stopwatch watch;
  double cost = 0, priced = 0, priced_ms = 0;
  gaps_.assign(plan_.captures.size(), {});
  for (std::size_t i = 0; i < plan_.captures.size(); ++i) {
    Capture& capture = plan_.captures[i];
    const Camera& eye = capture.geometry.capture;
    if (!store_->allocate(stored(capture.slot), eye.width, eye.height)) {
      refuse_capture(plan_, i, hierarchy_, moving_);
      continue;
    }
    hold(capture);
    count_strokes(held_[capture.slot].objects, capture);
    ++stats.captures;
    const double before_ms = watch.ms();
    this->capture(i, held_[capture.slot].objects);
    cost += capture.cost;
    if (capture.once) continue;  // without gaps it costs less
    priced_ms += watch.ms() - before_ms;
    priced += capture.cost;
  }
  clock_.capture.learn(priced, priced_ms);
  for (std::size_t i = 0; i < plan_.captures.size(); ++i)
    if (const Capture& capture = plan_.captures[i]; capture.picture.held)
      if (const auto range = store_->delta_range(stored(capture.slot)))
        if (!narrow_capture(plan_, i, camera, *range, policy_, gaps_[i])) {
          refuse_capture(plan_, i, hierarchy_, moving_);
          release(capture.slot);
        }
  store_->finish();
  stats.capture_ms = watch.ms();
  if (cost > 0 && stats.capture_ms > 0) {
    const double now = cost / stats.capture_ms;
    // The first measurement includes the driver's warm-up; later ones smooth it away.
    cost_per_ms_ = cost_per_ms_ > 0 ? 0.8 * cost_per_ms_ + 0.2 * now : now;
  }
}

void SceneCache::capture_fallback(FrameStats& stats) {
  if (fallback_.held) store_->free(kFallbackSlot);
  fallback_.held = false;
  Fallback& fallback = plan_.fallback;
  if (fallback.objects.empty()) return;
  const Stopwatch watch;
  fallback_.camera = fallback.geometry.capture;
  const Camera& eye = fallback_.camera;
  fallback_.objects.clear();
  for (const std::uint32_t object : fallback.objects)
    fallback_.objects.push_back(static_objects_[object]);
  const RasterPicture* picture =
      coarse_->capture(eye, float(1 / fallback.texel_px), fallback_.objects);
  if (!picture || !store_->allocate(kFallbackSlot, eye.width, eye.height)) {
    for (const std::uint32_t object : fallback.objects) plan_.polygons.push_back({object, 0, 1});
    fallback.objects.clear();
    return;
  }
  fallback_.held = true;
  fallback_.objects_captured = false;
  store_->write(kFallbackSlot, *picture, store_->written_bits());
  if (const auto range = store_->delta_range(kFallbackSlot)) narrow_slab(fallback.geometry, *range);
  clock_.fallback.learn(unlimited_.cost.fallback_texel * eye.width * eye.height, watch.ms());
  ++stats.captures;
  stats.capture_ms += watch.ms();
}

void SceneCache::finish_captures() {
  if (beside_) beside_->finish();
}

}  // namespace rilievo
