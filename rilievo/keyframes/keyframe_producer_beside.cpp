// Keyframes of sources that take long, on a thread of their own.
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "rilievo/keyframes/keyframe_producer.h"
#include "rilievo/keyframes/same_view.h"

namespace rilievo {
namespace {

// How many frames ahead an eye is predicted at most, for a source that takes long.
constexpr int kMostAhead = 60;
// While the eye moves such a source has about so many ms for a keyframe; its texels for each pixel
// of the frame, in each direction: at least, and of the first one, which tells what they take.
constexpr double kBesideMs = 700, kLeastTexels = 0.125, kFirstTexels = 0.25;

}  // namespace

// Of the next one: for each pixel, in each direction. An eye that stands gets a whole one after
// what is soon there: it may go on before.
double KeyframeProducer::texels_beside(const Camera& eye) const {
  if (texel_ms_ == 0) return kFirstTexels;
  const bool any_here = std::ranges::any_of(
      ready_, [&](const Keyframe& key) { return !key.coarse && same_pose(key.camera, eye); });
  if (stands_at(eye) && any_here) return 1;
  const Camera whole = plain(eye);
  const double whole_ms = texel_ms_ * whole.width * whole.height;
  return std::clamp(std::sqrt(kBesideMs / whole_ms), kLeastTexels, 1.0);
}

Result<> KeyframeProducer::end_beside() {
  ordered_ = false;
  if (failed_) {
    const Error error = *std::exchange(failed_, std::nullopt);
    keep_memory(maker_.give_up());
    if (error.reason.find(kCaptureStopped) == std::string::npos) return error;
    after_stop_ = true;
    return Done{};
  }
  complete_ = true, ++done_.completed;
  // A program that was told to stop may have gone on, and the next one has waited for that.
  if (std::exchange(after_stop_, false) && texel_ms_ > 0) return Done{};
  frames_for_one_ = std::max(waited_, 1);
  texel_ms_ = beside_ms_ / (double(maker_.camera().width) * maker_.camera().height);
  return Done{};
}

Result<> KeyframeProducer::work_beside() {
  if (in_flight_.load(std::memory_order_acquire)) {
    ++waited_;
    // A whole one, of an eye that stood, comes too late for one that has gone on.
    if (sharp_beside_ && !same_view(plain(frame_), ordered_view_)) stop_.request_stop();
    return Done{};
  }
  if (ordered_) return end_beside();
  const Camera eye = prediction_.after(std::min(2 * frames_for_one_, kMostAhead));
  if (!prediction_.speed_known() || has_one_of(eye)) return Done{};
  const double texels = texels_beside(eye);
  begin(eye, texels);
  sharp_beside_ = texels == 1 && stands_at(eye);
  ordered_view_ = plain(eye);
  stop_ = {};
  control_.stop = stop_.get_token();
  waited_ = 0, ordered_ = true;
  in_flight_.store(true, std::memory_order_release);
  background_->run([this] {
    const Stopwatch watch;
    if (Result<> made = maker_.step(source_, maker_.columns_left(), &control_); !made)
      failed_ = made.error();
    beside_ms_ = watch.ms();
    in_flight_.store(false, std::memory_order_release);
  });
  return Done{};
}

}  // namespace rilievo
