#include "rilievo/method/auto_keyframes.h"

#include <algorithm>
#include <functional>
#include <iterator>

#include "rilievo/method/good_enough.h"

namespace rilievo {
namespace {

// So many parts of a keyframe are made for each frame that is shown, if the time suffices.
constexpr int kParts = 3;
// For an eye that stands there is no second keyframe.
constexpr int kMostFrames = 160;
// Steps after which those of long ago count for nothing.
constexpr int kSettles = 48;
// So many times SampledLoss looks ahead: as often as at a frame, since the larger loss counts,
// which of noise alone would be too large.
constexpr int kLooks = kAuditionLosses;
// A frame and what it makes of keyframes take so many times the usual time; and so much they make
// in a frame that takes that alone.
constexpr double kWithKeyframes = 1.6, kLeastForKeyframes = 0.15;
// Keyframes take so little of a usual frame: two dozen usual ones would be slower than a walk.
constexpr double kFarLess = 1 / 3.0;
// What takes less than this share of what a model says of keyframes is cheaper: the model was off
// by 0.44 to 1.3. And the frames in a row until that is believed.
constexpr double kSurelyLess = 0.7;
constexpr int kBelieved = 12;
// What later keyframes may leave of the loss of the first one alone: along four flights at a
// person's speed 0.2 to 0.6.
constexpr double kOfLater = 0.6;
// By how much less is filled between later keyframes than between the first two: 0.3 to 0.9 along
// five walks.
constexpr double kLessFilled = 0.5;
// What takes so many times as much, at most, may turn out to be cheaper; and the frames after a
// warm-up until a decision is made.
constexpr double kMayBeCheaper = 1.25;
constexpr int kDecides = 8;
// One pixel in so many, along each axis, says how far things are; and what is nearer than the far
// plane by that is one.
constexpr int kApart = 16;
constexpr double kSurface = 1.001;

// The loss of what is warped for that eye.
Result<std::optional<double>> loss_from(const Camera& camera, double time, KeyframeFrames& frames) {
  frames.forget_loss();
  if (Result<> done = frames.look_from(camera, time); !done) return done.error();
  return loss_of(frames, kLooks);
}

// Makes parts of keyframes beside the frames until that is `enough`. `anew`: those that `frames`
// has are of some time ago.
Result<> make_parts(SharedEye& eye, bool anew, KeyframeFrames& frames,
                    const std::function<bool()>& enough) {
  for (int frame = 0; frame < kMostFrames; ++frame) {
    const std::optional<SharedEye::Posted> posted = eye.next();
    if (!posted) return Done{};
    const std::vector<double> way = way_to_frame(posted->frames, kParts, anew);
    for (std::size_t i = 0; i < way.size(); ++i) {
      const Camera camera = posted->eye.after(way[i]);
      if (i + std::size_t(kParts) < way.size()) {
        frames.follow(camera, posted->time);
        continue;
      }
      if (Result<> done = frames.prepare(camera, posted->time, anew); !done) return done;
      anew = false;
      if (enough()) return Done{};
    }
  }
  return Done{};
}

}  // namespace

void SharedEye::post(const EyePrediction& eye, double time) {
  {
    const std::lock_guard lock(mutex_);
    const int missed = latest_ && !taken_ ? latest_->frames : 0;
    latest_ = {eye, time, missed + 1}, taken_ = false;
  }
  changed_.notify_all();
}

std::optional<SharedEye::Posted> SharedEye::next() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return ended_ || (latest_ && !taken_); });
  if (ended_) return std::nullopt;
  taken_ = true;
  return latest_;
}

std::optional<SharedEye::Posted> SharedEye::latest() {
  const std::lock_guard lock(mutex_);
  return latest_;
}

void SharedEye::forget() {
  const std::lock_guard lock(mutex_);
  latest_.reset();
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

Result<> prepare_keyframes(SharedEye& eye, KeyframeFrames& frames) {
  return make_parts(eye, true, frames, [&] { return frames.prepared(); });
}

Result<> make_next_keyframe(SharedEye& eye, KeyframeFrames& frames) {
  const std::uint64_t made = frames.made_count();
  return make_parts(eye, false, frames,
                    [&] { return frames.made_count() > made || !frames.making(); });
}

void follow_way(const EyePrediction& eye, double time, KeyframeFrames& frames) {
  for (const double before : way_to_frame(1, 1, true))
    if (before < 0) frames.follow(eye.after(before), time);
}

double time_for_keyframes(double ms, double usual_ms, double polygons_ms, double keyframes_ms) {
  if (keyframes_ms < kFarLess * std::min(usual_ms, polygons_ms)) return KeyframeProducer::kAtOnce;
  return std::max(kWithKeyframes * usual_ms - ms, kLeastForKeyframes * usual_ms);
}

double UsualTime::add(double ms, double drawn_ms, bool warm) {
  least_ms_ = std::min(least_ms_, ms);
  return warm && drawn_ms > 0 ? drawn_ms : least_ms_;
}

bool KeyframesDoubt::add(double drawn_ms, double keyframes_ms) {
  frames_ = drawn_ms < kSurelyLess * keyframes_ms ? frames_ + 1 : 0;
  return frames_ >= kBelieved;
}

bool first_is_hopeless(double loss_db, std::optional<double> cache_loss_db, double allowed_db,
                       bool drew) {
  if (loss_db > kMostTimes * allowed_db) return true;
  return cache_loss_db && !good_beside_cache(kOfLater * loss_db, cache_loss_db, allowed_db, drew);
}

std::optional<double> least_loss(std::optional<double> a, std::optional<double> b) {
  return a && b ? std::min(a, b) : a ? a : b;
}

bool good_beside_cache(double loss_db, std::optional<double> cache_loss_db, double allowed_db,
                       bool drew) {
  const bool sure = drew || (cache_loss_db && *cache_loss_db > kCertainly * allowed_db);
  if (cache_loss_db) *cache_loss_db -= kAsGoodDb;
  return good_enough(loss_db, cache_loss_db, (sure ? 1 : kCertainly) * allowed_db);
}

double ms_when_settled(double ms, double fill_ms, bool young) {
  return young ? ms - kLessFilled * std::min(fill_ms, ms) : ms;
}

bool kept_after_trial(int frames, int warm_up, double keyframes_ms, double cache_ms) {
  return keyframes_ms > 0 && frames <= warm_up + kDecides &&
         keyframes_ms <= kMayBeCheaper * cache_ms;
}

Result<std::optional<double>> loss_ahead(const EyePrediction& eye, double time,
                                         KeyframeFrames& frames, int age) {
  const double ahead = 0.5 * std::max(frames.least_frames_for_one() - age, 0.0);
  return loss_from(eye.after(ahead), time, frames);
}

Camera eye_aside(const Camera& camera, const Image<float>& inverse_z, double pixels) {
  std::vector<float> seen;
  for (int y = kApart / 2; y < inverse_z.height(); y += kApart)
    for (int x = kApart / 2; x < inverse_z.width(); x += kApart)
      if (inverse_z(x, y) * camera.z_far > kSurface) seen.push_back(inverse_z(x, y));
  if (seen.empty()) return camera;
  const auto middle = seen.begin() + std::ptrdiff_t(seen.size() / 2);
  std::nth_element(seen.begin(), middle, seen.end());
  const double pixel = (camera.window.right - camera.window.left) / camera.width;
  Camera aside = camera;
  aside.world_from_eye[3] += pixels * pixel / double(*middle) * aside.world_from_eye[0];
  return aside;
}

Result<std::optional<double>> loss_aside(const Camera& camera, double time,
                                         const Image<float>& inverse_z, double pixels,
                                         KeyframeFrames& frames) {
  return loss_from(eye_aside(camera, inverse_z, pixels), time, frames);
}

std::optional<double> loss_of(KeyframeFrames& frames, int looks) {
  const std::optional<double> sampled = frames.sample_loss(looks);
  return sampled ? std::optional(without_own_noise(*sampled)) : std::nullopt;
}

Result<std::optional<double>> loss_ahead(SharedEye& eye, KeyframeFrames& frames) {
  const std::optional<SharedEye::Posted> latest = eye.latest();
  if (!latest) return std::optional<double>();
  return loss_ahead(latest->eye, latest->time, frames);
}

Audition audition_keyframes(const ShownFrame& shown, SharedEye& eye, KeyframeFrames& frames) {
  Audition found;
  FrameLoss of_cache(&frames.rays());
  found.cache_loss_db = cache_loss(shown, &of_cache);
  if (!begin_audition(shown, frames)) return found;
  const Result<double> ms = time_audition(shown, frames);
  if (!ms) return found;
  found.processor_ms = *ms;
  frames.forget_loss();
  for (int i = 0; i < kMostAuditions && !found.loss_db; ++i)
    found.loss_db = loss_of(frames, kAuditionLosses);
  const Result<std::optional<double>> ahead = loss_ahead(eye, frames);
  if (found.loss_db && ahead && *ahead) found.loss_db = std::max(*found.loss_db, **ahead);
  return found;
}

}  // namespace rilievo
