#include "rilievo/method/auto_keyframes.h"

#include <iterator>
#include <utility>

#include "rilievo/method/good_enough.h"

namespace rilievo {
namespace {

// So many parts of a keyframe are made for each frame that is shown, if the time suffices.
constexpr int kParts = 3;
// For an eye that stands there is no second keyframe.
constexpr int kMostFrames = 160;
// Places on the way from the first keyframe to the second one: in the middle both are the farthest.
constexpr double kMiddle = 0.5, kLookedAt[] = {0.25, kMiddle};
// So many times SampledLoss looks at what the first one shows alone.
constexpr int kLooksAtFirst = 8;

}  // namespace

void SharedEye::post(const EyePrediction& eye, double time) {
  {
    const std::lock_guard lock(mutex_);
    posted_ = {eye, time};
  }
  changed_.notify_all();
}

std::optional<SharedEye::Posted> SharedEye::next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return ended_ || posted_; });
  if (ended_) return std::nullopt;
  return std::exchange(posted_, std::nullopt);
}

void SharedEye::forget() {
  const std::lock_guard lock(mutex_);
  posted_.reset();
}

void SharedEye::end() {
  {
    const std::lock_guard lock(mutex_);
    ended_ = true;
  }
  changed_.notify_all();
}

Result<> prepare_keyframes(SharedEye& eye, KeyframeFrames& frames, int goes_on) {
  for (int frame = 0; frame < goes_on; ++frame) {
    const std::optional<SharedEye::Posted> posted = eye.next();
    if (!posted) return Done{};
    if (Result<> done = frames.prepare(posted->eye.after(0), posted->time, false); !done)
      return done;
  }
  if (goes_on > 0) return Done{};
  // What makes keyframes takes each part for a frame: the eye goes on by a part of its step.
  bool anew = true;
  for (int frame = 0; frame < kMostFrames && (anew || !frames.prepared()); ++frame) {
    const std::optional<SharedEye::Posted> posted = eye.next();
    if (!posted) return Done{};
    for (int part = 1; part <= kParts && (anew || !frames.prepared()); ++part) {
      const Camera camera = posted->eye.after(double(part - kParts) / kParts);
      if (Result<> done = frames.prepare(camera, posted->time, anew); !done) return done;
      anew = false;
    }
  }
  return Done{};
}

Result<BegunKeyframes> begin_keyframes(const EyePrediction& eye, double time, double most_db,
                                       KeyframeFrames& frames) {
  BegunKeyframes begun;
  const auto look = [&](double at, int times) -> Result<> {
    if (Result<> done = frames.look_from(eye.after(at), time); !done) return done;
    for (int i = 0; i < times; ++i) begun.loss_db = loss_of(frames);
    return Done{};
  };
  frames.forget_loss();
  if (Result<> done = look(kMiddle * frames.frames_for_one(), kLooksAtFirst); !done)
    return done.error();
  if (begun.loss_db && *begun.loss_db > most_db) return begun;
  const Result<double> ahead = frames.prepare_second(eye, time);
  if (!ahead) return ahead.error();
  begun.frames = *ahead;
  frames.forget_loss();
  for (const double share : kLookedAt)
    if (Result<> done = look(share * *ahead, kAuditionLosses / int(std::size(kLookedAt))); !done)
      return done.error();
  return begun;
}

std::optional<double> loss_of(KeyframeFrames& frames) {
  const std::optional<double> sampled = frames.sample_loss();
  return sampled ? std::optional(without_own_noise(*sampled)) : std::nullopt;
}

Audition audition_keyframes(const ShownFrame& shown, FrameLoss* loss, KeyframeFrames& frames) {
  Audition found;
  found.cache_loss_db = cache_loss(shown, loss);
  if (!begin_audition(shown, frames)) return found;
  const Result<double> ms = time_audition(shown, frames);
  if (!ms) return found;
  found.processor_ms = *ms;
  frames.forget_loss();
  for (int i = 0; i < kMostAuditions * kAuditionLosses; ++i) {
    found.loss_db = loss_of(frames);
    if (found.loss_db && i + 1 >= kAuditionLosses) break;
  }
  return found;
}

}  // namespace rilievo
