// How good the frames of keyframes and levels are.
#include <algorithm>

#include "rilievo/method/auto_frames.h"
#include "rilievo/method/good_enough.h"

namespace rilievo {
namespace {

// One frame in so many of keyframes, or of levels, is looked at, once it is known how good they
// are: seldom where they are certainly good; and what was not good enough is looked at again after
// so many frames, then twice as many, at most so many: somewhere else it may be.
constexpr int kLossFrames = 4, kLossFramesIfSure = 8, kLossFramesOfFirst = 2, kForgetsFirst = 16,
              kLossFramesOfLevels = 8, kLooksAgain = 80, kLooksAgainAtMost = 1280;
// So many times what is allowed keyframes may lose while it is not known what the cache loses.
constexpr double kUnseenCache = 1.5;
// Keyframes are made again for that, which takes some dozen frames a third more.
constexpr int kMakesAgain = 2 * kLooksAgain;
// The share of what is allowed that levels may lose: in some scenes they are measured to lose 1 dB
// less than they do beside true frames, and finer ones cost little.
constexpr double kOfLevels = 0.8;
// So many times as many pixels of each frame are looked at until the loss is known, since a trial
// is a few frames; and later of levels.
constexpr int kLossesOfTrial = 4, kLossesOfLevels = 2;
// Levels of less than this share of the triangles are coarser ones: what was seen of others says
// nothing.
constexpr double kSameLevels = 0.8;
// And so many times as many more before what draws is refused: a look may have met the few pixels
// that are wrong.
constexpr int kLossesToRefuse = 8;

}  // namespace

// Have they drawn, and were not refused since? What was must certainly be good to draw again: else
// it would come and go.
bool AutoFrames::keyframes_known() const {
  return decision_->mean_ms(kKeyframes) > 0 &&
         (loss_[kKeyframes].refusals == 0 || drawn_by_ == kKeyframes);
}

// Are keyframes, where they lose that?
bool AutoFrames::keyframes_good_enough(double loss_db) const {
  // There will be a second one, and the wait for it is short.
  if (first_alone_) return !first_is_hopeless(loss_db, std::nullopt, options_.loss_db, true);
  if (decision_->draws() != kKeyframes)
    return good_beside_cache(loss_db, cache_loss_, options_.loss_db, keyframes_known());
  // What draws is not left for the noise of a look, nor soon for a cache that nobody has seen: it
  // may lose as much, and takes longer.
  const double times = cache_loss_ ? 1 : kUnseenCache;
  return good_beside_cache(loss_db - kAsGoodDb, cache_loss_, times * options_.loss_db,
                           keyframes_known());
}

// Is a method whose loss is measured? What was not may be, some time later.
bool AutoFrames::good_enough(int method) {
  Loss& of = loss_[method];
  const bool drew = decision_->mean_ms(method) > 0;
  const auto good = [&] {
    if (!of.db) return true;
    if (method == kKeyframes) return keyframes_good_enough(*of.db);
    // Nobody has seen it yet: what was looked at is one frame.
    const double sure = !drew ? kCertainly : method == kLevels ? kOfLevels : 1;
    return rilievo::good_enough(*of.db, cache_loss_, sure * options_.loss_db);
  };
  const int first = method == kKeyframes ? kMakesAgain : kLooksAgain,
            again = std::min(first << std::min(of.refusals, 8), kLooksAgainAtMost);
  if (!good() && preparing_ < 0 && frame_ - of.seen_in > again) {
    ++of.refusals;
    forget_loss(method);
  }
  return good();
}

// Of the frame that was drawn last.
Result<> AutoFrames::measure_loss(const Camera& camera, double time, const AutoChoice& choice) {
  Loss& of = loss_[choice.draws];
  of.seen_in = frame_;
  if (choice.draws == kLevels) return measure_loss_of_levels(camera, time);
  const bool sure =
      of.db && rilievo::good_enough(*of.db, std::nullopt, kCertainly * options_.loss_db);
  // A first keyframe is left behind with each frame until there is another.
  const int frames = first_alone_ ? kLossFramesOfFirst : sure ? kLossFramesIfSure : kLossFrames;
  if (of.db && frame_ % frames != 0) return Done{};
  // So what was seen of it some frames ago says little; and is all that is known for some looks.
  const std::optional<double> before = first_alone_ ? of.db : std::nullopt;
  if (first_alone_ && frame_ % kForgetsFirst == 0) keyframes_->forget_loss();
  of.db = loss_of(*keyframes_, of.db ? 1 : kLossesOfTrial);
  if (!of.db) of.db = before;
  if (!good_enough(choice.draws)) of.db = loss_of(*keyframes_, kLossesToRefuse);
  const bool settled = !first_alone_ && young_keyframes_ == 0;
  if (of.db && settled && good_enough(choice.draws)) of.refusals = 0;
  return Done{};
}

// Levels that lose too much become finer: they may still take less than polygons.
Result<> AutoFrames::measure_loss_of_levels(const Camera& camera, double time) {
  Loss& of = loss_[kLevels];
  if (load_.level_triangles < kSameLevels * looked_triangles_) {
    looked_triangles_ = 0;
    forget_loss(kLevels);
  }
  looked_triangles_ = std::max(looked_triangles_, load_.level_triangles);
  for (const bool again : {false, true}) {
    const Result<std::optional<double>> db = look_at_levels(camera, time, again);
    if (!db) return db.error();
    if (!*db) return Done{};
    of.db = *db;
    if (good_enough(kLevels)) break;
  }
  const bool good = good_enough(kLevels);
  if (good) of.refusals = 0;
  const double excess_db = of.db.value_or(0) - kOfLevels * options_.loss_db;
  if (!good && make_finer(options_.error_px, excess_db, levels_)) forget_levels();
  return Done{};
}

// They draw with another error from the next frame on: what was seen of them says nothing, and they
// show something else.
void AutoFrames::forget_levels() {
  forget_loss(kLevels);
  refined_ = drawn_by_ == kLevels;
}

void AutoFrames::forget_loss(int method) {
  loss_[method].db.reset();
  if (method == kKeyframes && keyframes_) keyframes_->forget_loss();
  if (method == kLevels && looks_) looks_->forget();
  if (method == kLevels && pieces_) pieces_->forget();
}

// By rays, or by polygons in a scene that rays do not know. Often until it is known, since the one
// frame that was looked at before they drew says little of others. None: it is not known, or was
// not looked at. `again`: it was, and is not good enough.
Result<std::optional<double>> AutoFrames::look_at_levels(const Camera& camera, double time,
                                                         bool again) {
  const std::optional<double> unknown;
  const SoftwareTarget* target = active_->software_target();
  if (!target) return unknown;
  const bool seldom = !again && !eye_.jumped() && frame_ % kLossFramesOfLevels != 0;
  if (looks_) {
    const bool known = looks_->db().has_value();
    if (known && seldom) return unknown;
    in_view_.clear();
    backend_.placed().cull(camera, in_view_);
    const int times = again ? kLossesToRefuse : known ? kLossesOfLevels : kLossesOfTrial;
    looks_->add(camera, in_view_, target->color(), times);
    return looks_->db();
  }
  if (preparing_ >= 0 || meshes_triangles_ > kMostForLoss) return unknown;
  if (!pieces_) {
    Result<SoftwareBackend*> software = backend_.software();
    if (!software) return software.error();
    pieces_.emplace(**software);
  }
  if (pieces_->db() && seldom) return unknown;
  if (Result<> added = pieces_->add(camera, time, target->color()); !added) return added.error();
  return pieces_->db();
}

}  // namespace rilievo
