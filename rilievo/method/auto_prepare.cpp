#include <algorithm>
#include <utility>

#include "rilievo/frame/software/software_frames.h"
#include "rilievo/method/auto_frames.h"
#include "rilievo/method/good_enough.h"

namespace rilievo {
namespace {

// What is expected to take less than this share of what draws is prepared in a hurry: frames lose
// all the time that preparing takes, for a short time.
constexpr double kHurry = AutoDecision::kPlainlyWorth;
// What may be left of the loss of the first two keyframes when there is a third one.
constexpr double kOfNext = 0.75;

// Makes one more keyframe; what counts is what frames from that and the one before lose where the
// eye is now, as far as it is known.
Result<> look_at_next(SharedEye& eye, KeyframeFrames& frames, Audition& found) {
  if (Result<> made = make_next_keyframe(eye, frames); !made) return made;
  const Result<std::optional<double>> loss_db = loss_ahead(eye, frames);
  if (!loss_db) return loss_db.error();
  if (*loss_db) found.loss_db = *loss_db;
  return Done{};
}

}  // namespace

// What takes that time, beside what draws, or beside direct drawing until that is known?
bool AutoFrames::in_a_hurry(double guess_ms) const {
  const double least = decision_->drawn_ms() > 0
                           ? std::min(decision_->drawn_ms(), slowness_.value() * load_.direct_ms())
                           : slowness_.value() * load_.direct_ms();
  return guess_ms < kHurry * least;
}

Result<std::unique_ptr<KeyframeFrames>> AutoFrames::make_keyframes(const Scene& scene) const {
  KeyframeFramesOptions keyframes;
  keyframes.samples = backend_.samples();
  keyframes.polygons_where_cheaper = false;
  if (options_.gap_px > 0) keyframes.gap_px = options_.gap_px;
  keyframes.keyframes.samples = options_.keyframe_samples;
  if (options_.keyframe_ms > 0)
    keyframes.keyframes.keyframe_ms = options_.keyframe_ms;
  else
    take_usual_time(keyframes);
  return KeyframeFrames::create(scene, keyframes);
}

// After a frame of this camera. Keyframes that promise much are made in parts, by the frames that
// follow, on all cores.
void AutoFrames::prepare(int method, const Camera& camera, double time) {
  const bool again = method == kKeyframes && keyframes_;
  if (preparing_ >= 0 || failed_[method] || (frames_[method] && !again)) return;
  Result<SoftwareBackend*> software = backend_.software();
  if (!software) {
    failed_[method] = true;
    return;
  }
  preparing_ = method, stage_ = Preparing::made;
  shared_eye_.forget();
  prepared_ = false;
  made_.error_px = options_.error_px;
  // What was refused most likely is again: frames are not to lose by it twice.
  const bool refused = method == kKeyframes && loss_[kKeyframes].refusals > 0;
  const bool hurry =
      !refused && (in_a_hurry(outlook_[std::size_t(method)].guess_ms) || begins_with_keyframes_);
  made_.by_frames = method == kKeyframes && hurry;
  if (!beside_ || hurries_ != hurry) beside_.emplace(hurries_ = hurry);
  const Scene& scene = (*software)->scene();
  // What moves is not where the rays' scene has it. Keyframes have rays of their own.
  const bool measures = method == kLevels && meshes_triangles_ <= kMostForLoss && !moves_;
  const double pixels = double(width_) * height_;
  // Those that frames of before drew from are of elsewhere; one of the first frame is not.
  const bool anew = !made_.keyframes;
  beside_->run([this, method, anew, &scene, measures, pixels, camera, time,
                error_px = options_.error_px, width = width_, height = height_] {
    // The frame that copies a picture there must not touch new memory.
    made_.shown.color = Rgba8Image(width, height);
    if (measures && !losses_)
      if (Result<RayScene> rays = RayScene::create(scene))
        losses_ = std::make_unique<FrameLoss>(std::move(*rays));
    if (method == kRays) made_.rays = RayVisibility::create(scene);
    if (method == kLevels) made_.levels = prepare_levels(backend_, scene, pixels, error_px);
    if (method == kKeyframes) {
      if (!prepared_keyframes()) {
        if (auto made = make_keyframes(scene)) made_.keyframes = std::move(*made);
      }
      KeyframeFrames* frames = prepared_keyframes();
      made_.failed = !frames;
      if (frames && made_.by_frames && anew) frames->reserve(camera, time);
      if (frames && !made_.by_frames) made_.failed = !prepare_keyframes(shared_eye_, *frames);
    }
    prepared_ = true;
  });
}

// Beside a frame that took `ms`.
void AutoFrames::make_part(const Camera& camera, double time, double ms) {
  if (preparing_ < 0) return;
  if (eye_.jumped()) made_.jumped = true, made_.jumped_in = frame_;
  if (stage_ != Preparing::by_frames) return;
  // After a jump the cache captures as it does at first.
  const bool warm =
      frame_ - std::max(begun_in_, made_.jumped_in) > kCacheWarmsUp && decision_->drawn_ms() > 0;
  made_.given_up = warm && made_.doubt.add(decision_->drawn_ms(), outlook_[kKeyframes].guess_ms);
  if (made_.given_up) return;
  KeyframeFrames& frames = *prepared_keyframes();
  // After a jump they are of elsewhere.
  const bool jumped = std::exchange(made_.jumped, false);
  if (jumped) {
    made_.first_seen = made_.followed = false;
    made_.usual.forget(), made_.doubt = {}, made_.found = {};
  }
  const double usual_ms = made_.usual.add(ms, decision_->drawn_ms(), warm);
  if (!std::exchange(made_.followed, true)) follow_way(eye_, time, frames);
  const double part_ms =
      time_for_keyframes(ms, usual_ms, outlook_[kDirect].guess_ms, outlook_[kKeyframes].guess_ms);
  // All of one in this frame must be likely to be of use: where the first frame made one, it tells.
  if (!jumped && part_ms == KeyframeProducer::kAtOnce && frames.any() &&
      !std::exchange(made_.first_seen, true)) {
    look_at_first_keyframe(camera, time, frame_ - (begun_in_ + 1));
    return;
  }
  if (!frames.prepare(camera, time, jumped, part_ms)) {
    made_.failed = true, stage_ = Preparing::made;
  } else if (frames.prepared()) {
    stage_ = Preparing::shown;
  } else if (frames.any() && !std::exchange(made_.first_seen, true)) {
    look_at_first_keyframe(camera, time, 0);
  }
}

// Where the first one alone loses far too much, as the cache does not, a second one is of no use.
void AutoFrames::look_at_first_keyframe(const Camera& camera, double time, int age) {
  stage_ = Preparing::first_looked_at;
  keep_shown(camera, time, drawn_by_);
  prepared_ = false;
  beside_->run([this, eye = eye_, time, age] {
    KeyframeFrames& frames = *prepared_keyframes();
    const Result<std::optional<double>> loss_db = loss_ahead(eye, time, frames, age);
    made_.failed = !loss_db;
    if (loss_db) made_.found.loss_db = *loss_db;
    FrameLoss of_cache(&frames.rays());
    made_.found.cache_loss_db = cache_loss(made_.shown, &of_cache);
    prepared_ = true;
  });
}

// What is shown, for what is prepared to be compared with. False: no software drew it.
bool AutoFrames::keep_shown(const Camera& camera, double time, int drawn_by) {
  const SoftwareTarget* target = active_->software_target();
  ShownFrame& shown = made_.shown;
  shown.camera = camera, shown.time = time, shown.by_cache = target && drawn_by == kCache;
  if (!target) return false;
  shown.color = target->color();
  shown.before = as_large_as_shown(camera) ? shown_camera_ : camera;
  backend_.placed().cull(camera, shown.in_view);
  if (preparing_ == kKeyframes) leave_out_moving(backend_.placed(), shown);
  return true;
}

// What was shown, for what is prepared to be compared with.
void AutoFrames::show(const Camera& camera, double time, int drawn_by) {
  // The frame before a jump shows another place.
  if (preparing_ < 0 || stage_ != Preparing::shown || eye_.jumped()) return;
  if (keep_shown(camera, time, drawn_by)) look_at_prepared();
}

void AutoFrames::look_at_prepared() {
  // What the cache lost with another error, or elsewhere, is not compared.
  if (made_.jumped || made_.error_px != options_.error_px) made_.found = {};
  stage_ = Preparing::looked_at;
  // Keyframes of elsewhere are bad here, which says nothing of others.
  prepared_ = preparing_ == kKeyframes && made_.jumped;
  if (prepared_) return;
  made_.jumped = false;
  beside_->run([this, method = preparing_, error_px = options_.error_px, loss_db = options_.loss_db,
                known = keyframes_known(), by_frames = made_.by_frames] {
    const ShownFrame& shown = made_.shown;
    if (method == kRays) made_.found = audition_rays(shown, backend_.samples(), **made_.rays);
    if (method == kLevels)
      made_.found = audition_levels(shown, error_px, loss_db, losses_.get(), made_.levels);
    if (method == kKeyframes) {
      const std::optional<double> beside_first = made_.found.cache_loss_db;
      KeyframeFrames& frames = *prepared_keyframes();
      made_.found = audition_keyframes(shown, shared_eye_, frames);
      made_.found.cache_loss_db = least_loss(beside_first, made_.found.cache_loss_db);
      // Good ones that frames made draw at once. Of others it is the next one that tells: they were
      // left behind while they were looked at, or are farther apart than later ones.
      const auto good = [&](double share) {
        return made_.found.loss_db && good_beside_cache(share * *made_.found.loss_db,
                                                        made_.found.cache_loss_db, loss_db, known);
      };
      if (by_frames ? !good(1) && good(kOfNext) : good(1))
        made_.failed = !look_at_next(shared_eye_, frames, made_.found);
    }
    prepared_ = true;
  });
}

// Takes what was prepared.
Result<> AutoFrames::adopt() {
  if (preparing_ < 0 || !prepared_) return Done{};
  // What draws may have changed to what no software shows.
  if (stage_ == Preparing::shown && active_->software_target()) return Done{};
  if (stage_ == Preparing::by_frames && !made_.given_up) return Done{};
  beside_->wait();
  // The eye has jumped since the look began: what was found, and keyframes, are of elsewhere.
  if (made_.jumped) made_.found = {};
  const bool first_refused = stage_ == Preparing::first_looked_at && made_.found.loss_db &&
                             first_is_hopeless(*made_.found.loss_db, made_.found.cache_loss_db,
                                               options_.loss_db, keyframes_known());
  const bool goes_on = (stage_ == Preparing::made && made_.by_frames) ||
                       (stage_ == Preparing::first_looked_at && !first_refused);
  if (goes_on && !made_.failed) {
    stage_ = Preparing::by_frames;
    // Meanwhile the eye went on.
    made_.followed = false;
    return Done{};
  }
  const bool can_be_seen =
      active_->software_target() &&
      ((preparing_ == kRays && made_.rays) || (preparing_ == kLevels && made_.levels.frames) ||
       (preparing_ == kKeyframes && !made_.failed));
  if (stage_ == Preparing::made && can_be_seen) {
    stage_ = Preparing::shown;
    return Done{};
  }
  const int method = std::exchange(preparing_, -1);
  // Something may be prepared again before levels draw.
  if (losses_ && !looks_) looks_.emplace(&losses_->rays());
  Result<SoftwareBackend*> software = backend_.software();
  if (!software) return software.error();
  if (stage_ == Preparing::looked_at || first_refused) {
    loss_[method] = {
        .db = made_.found.loss_db, .seen_in = frame_, .refusals = loss_[method].refusals};
    if (made_.found.cache_loss_db) cache_loss_ = made_.found.cache_loss_db;
  }
  Result<std::unique_ptr<FrameSource>> frames{Error{}};
  if (method == kRays && made_.rays)
    frames = backend_.present(std::make_unique<SoftwareFrames>(
        **software, std::make_unique<DirectChooser>(), std::move(*made_.rays)));
  if (method == kLevels && finish_levels(backend_, options_.error_px, made_.levels)) {
    levels_ = std::move(made_.levels);
    follow_error(options_.error_px, levels_);
    frames = std::move(levels_.frames);
  }
  if (method == kKeyframes) {
    young_keyframes_ = kKeyframesDwell;
    keyframes_seen_ = frame_, keyframes_again_ = frame_ + kKeyframesAgain;
    if (made_.jumped) keyframes_seen_ -= kKeyframesLast + 1, keyframes_again_ = frame_;
    if (made_.failed)
      keyframes_ = nullptr, loss_[method] = {}, frames_[method].reset(), made_.keyframes.reset();
  }
  if (method == kKeyframes && made_.keyframes) {
    keyframes_ = made_.keyframes.get();
    frames = backend_.present(std::move(made_.keyframes));
    if (!frames) keyframes_ = nullptr, loss_[method] = {};
  }
  const double ms = made_.found.processor_ms / threads_;
  if (method == kLevels && levels_.levels && stage_ == Preparing::looked_at)
    measure_load(made_.shown.camera), looked_triangles_ = load_.level_triangles;
  const double guess_ms = method == kLevels ? slowness_.value() * load_.levels_ms()
                                            : outlook_[std::size_t(method)].guess_ms / off_[method];
  if (stage_ == Preparing::looked_at && ms > 0 && guess_ms > 0)
    off_[method] = std::clamp(ms / guess_ms, 1 / kMostOff, kMostOff);
  // Levels are polygons, too.
  if (method == kLevels && direct_frames_ == 0) off_[kDirect] = std::max(1.0, off_[kLevels]);
  // What was seen of levels was of another error.
  if (made_.error_px != options_.error_px) forget_loss(kLevels);
  made_ = {};
  // Memory, mostly: the other methods go on.
  if (frames) frames_[method] = std::move(*frames);
  failed_[method] = !frames_[method];
  return Done{};
}

}  // namespace rilievo
