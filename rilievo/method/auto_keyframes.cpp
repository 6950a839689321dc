#include "rilievo/method/auto_keyframes.h"

#include <algorithm>
#include <iterator>
#include <utility>

#include "rilievo/method/good_enough.h"

namespace rilievo {
namespace {

// So many parts of a keyframe are made for each frame that is shown, if the time suffices.
constexpr int kParts = 3;
// For an eye that stands there is no second keyframe.
constexpr int kMostFrames = 160;
// Steps after which those of long ago count for nothing.
constexpr int kSettles = 48;
// Places on the way from the first keyframe to the second one: in the middle both are the farthest;
// by then one that is made beside the frames is there. So many times SampledLoss looks at each.
constexpr double kLookedAt[] = {0.5, 0.25};
constexpr int kLooks = 8;

}  // namespace

void SharedEye::post(const EyePrediction& eye, double time) {
  {
    const std::lock_guard lock(mutex_);
    posted_ = {eye, time, posted_ ? posted_->frames + 1 : 1};
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

std::vector<double> way_to_frame(int frames, int parts, bool anew) {
  const double step = std::min(anew ? 1 : frames, parts) / double(parts);
  std::vector<double> way;
  for (int i = parts + (anew ? kSettles : std::max(frames - parts, 0)) - 1; i >= 0; --i)
    way.push_back(-i * step);
  return way;
}

Result<> prepare_keyframes(SharedEye& eye, KeyframeFrames& frames, int goes_on) {
  const int most = goes_on > 0 ? goes_on : kMostFrames, parts = goes_on > 0 ? 1 : kParts;
  bool anew = goes_on == 0;
  for (int frame = 0; frame < most && (anew || goes_on > 0 || !frames.prepared()); ++frame) {
    const std::optional<SharedEye::Posted> posted = eye.next();
    if (!posted) return Done{};
    const std::vector<double> way = way_to_frame(posted->frames, parts, anew);
    for (std::size_t i = 0; i < way.size(); ++i) {
      const Camera camera = posted->eye.after(way[i]);
      if (i + std::size_t(parts) < way.size()) {
        frames.follow(camera, posted->time);
        continue;
      }
      if (Result<> done = frames.prepare(camera, posted->time, anew); !done) return done;
      anew = false;
      if (goes_on == 0 && frames.prepared()) break;
    }
  }
  return Done{};
}

Result<BegunKeyframes> begin_keyframes(const EyePrediction& eye, double time,
                                       const AloneLoss& may_lose, KeyframeFrames& frames) {
  BegunKeyframes begun;
  for (const bool two : {false, true}) {
    frames.forget_loss();
    for (const double share : kLookedAt) {
      const Camera there = eye.after(share * frames.frames_for_one());
      if (Result<> done = frames.look_from(there, time); !done) return done.error();
      for (int i = 0; i < kLooks; ++i) begun.loss_db = loss_of(frames);
      if (!two && begun.loss_db && *begun.loss_db > may_lose.most) return begun;
    }
    begun.begun = true;
    if (two) break;
    if (begun.loss_db && *begun.loss_db <= may_lose.alone) {
      frames.hurry();
      begun.alone = true;
      break;
    }
    if (Result<> made = frames.prepare_second(eye, time); !made) return made.error();
  }
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
