// What each method takes: what was measured, and what is believed of it.
#include <algorithm>
#include <cmath>

#include "rilievo/core/expects.h"
#include "rilievo/method/auto_decision.h"

namespace rilievo {
namespace {

// The share of a new frame in the mean, once there are enough.
constexpr double kNewest = 0.1, kNewestOfWarmUp = 0.4;
// A method that was never measured and of which no model is known may take this share of the one
// that draws.
constexpr double kHopeOfUnknown = 0.7;
// How much less than measured a method may take after n frames: kDoubt sqrt(n), at most kMostDoubt.
// A guess that nothing confirmed may be off by kGuessDoubt.
constexpr double kDoubt = 0.02, kMostDoubt = 0.75, kGuessDoubt = 0.25;
// By how much all methods are taken to have become slower since one of them was measured, at most.
constexpr double kMostSlower = 1.25;

// A frame that takes AutoTrials::kMuch times the median of so many of the last ones, at least,
// counts as that, unless such frames come back (dear_frames.h): other programs slow some frames in
// a row down by much more.
constexpr int kLeastForMedian = 3;
// By how much what a method took at its best grows with each frame in which it takes more. Not by a
// share of that frame: other programs make some take five times as much.
constexpr double kBestGrows = 0.015;
// Frames in a row of at most this share of the mean are not by chance.
constexpr double kNotByChance = 0.87;
constexpr int kLessInARow = 3;
// What contradicts what is plausible, so many times as much, and was measured in fewer frames than
// kSure, is not believed for ever. No more than what a trial may take: what is between the two
// would not be tried again.
constexpr double kContradicts = AutoDecision::kMaySpike;
// The same of a model that is too rough to say what changes.
constexpr double kContradictsPrior = 1.5;
constexpr int kSure = 60;

double doubt(int age) { return std::min(kMostDoubt, kDoubt * std::sqrt(double(age))); }

}  // namespace

double newest_share(double least, int frames) {
  return std::max(least, 1.0 / std::max(1, frames - 1));
}

// So many times slower has become what drew since this method was measured, and the model does not
// say why: this one has, too. Not faster: to change for what was slow before is tried first.
double AutoDecision::unexplained(int i) const {
  if (i == draws_) return 1;
  return std::clamp(slow_ / costs_[std::size_t(i)].slow, 1.0, kMostSlower);
}

// What it takes now, as far as is known; 0: nothing is.
double AutoDecision::expected(int i, const AutoOutlook& outlook) const {
  const Cost& cost = costs_[std::size_t(i)];
  if (cost.mean_ms == 0) return outlook.guess_ms;
  if (i == draws_ || cost.guess_ms == 0 || outlook.guess_ms == 0) return cost.mean_ms;
  // The model says how much has changed since.
  return cost.mean_ms * outlook.guess_ms / cost.guess_ms;
}

// The same; but what was measured beside other work is not believed where that is contradicted.
double AutoDecision::plausible(int i, const AutoOutlook& outlook) const {
  const Cost& cost = costs_[std::size_t(i)];
  const double ms = expected(i, outlook);
  if (i == draws_ || cost.mean_ms == 0) return ms;
  double least = ms;
  if (cost.calm > 0 && cost.calm_of_guess == (outlook.guess_ms > 0))
    least = std::min(least, cost.calm * (cost.calm_of_guess ? outlook.guess_ms : 1));
  if (cost.measured >= kSure) return kContradicts * least < ms ? least : ms;
  if (outlook.guess_ms > 0) least = std::min(least, outlook.guess_ms);
  const double prior_ms = outlook.guess_ms > 0 ? 0 : outlook.prior_ms;
  if (prior_ms > 0 && kContradictsPrior * prior_ms < ms) least = std::min(least, prior_ms);
  return kContradicts * least < ms ? least : ms;
}

// What it takes if it takes little.
double AutoDecision::hoped(int i, const AutoOutlook& outlook) const {
  const Cost& cost = costs_[std::size_t(i)];
  const double ms = plausible(i, outlook);
  if (ms == 0) return kHopeOfUnknown * costs_[std::size_t(draws_)].mean_ms;
  return ms * (1 - (cost.mean_ms == 0 ? kGuessDoubt : doubt(cost.age)));
}

// May it be compared with what draws? While that takes much more than it did at its best, and its
// model does not say why, other programs may have slowed down all that would draw: then only if it
// takes less than that did at its best.
bool AutoDecision::comparable(double ms, int i, std::span<const AutoOutlook> outlook) const {
  if (unsettled_ == 0) return true;
  const Cost& cost = costs_[std::size_t(draws_)];
  const double guess_ms = outlook[std::size_t(draws_)].guess_ms;
  const double calm_ms = cost.calm * (cost.calm_of_guess ? guess_ms : 1);
  return better(ms, i, calm_ms, draws_);
}

// What draws took that, over what its model says if it has one.
double AutoDecision::over_guess(double ms) const {
  const double guess_ms = guesses_[std::size_t(draws_)];
  return guess_ms > 0 ? ms / guess_ms : ms;
}

// What it took at its best, of late; and for how long it has taken much more.
void AutoDecision::note_calm(Cost& cost) {
  const double now = over_guess(cost.recent.median());
  const bool of_guess = guesses_[std::size_t(draws_)] > 0;
  if (cost.calm == 0 || cost.calm_of_guess != of_guess || now < cost.calm)
    cost.calm = now;
  else if (now <= AutoTrials::kMuch * cost.calm || unsettled_ >= kUnsettled)
    cost.calm = std::min(now, (1 + kBestGrows) * cost.calm);
  cost.calm_of_guess = of_guess;
  unsettled_ = now > AutoTrials::kMuch * cost.calm ? unsettled_ + 1 : 0;
}

// Frames that take far less than the mean, so many in a row, are what the method takes from now on:
// what slow frames have left in the mean would take a dozen more to be forgotten, in which a method
// that is no faster seems to be.
void AutoDecision::note_less(double& mean_ms, double ms) {
  less_ = ms < kNotByChance * mean_ms ? less_ + 1 : 0;
  less_ms_ = less_ == 1 ? ms : less_ms_ + ms;
  if (less_ < kLessInARow) return;
  mean_ms = less_ms_ / less_;
  less_ = 0;
}

void AutoDecision::add(double ms, bool disturbed) {
  RILIEVO_EXPECTS(drawn_ >= 0);
  if (trials_.goes_on()) {
    trials_.add(ms, free_ms());
    return;
  }
  trials_.add_other(ms);
  Cost& cost = costs_[std::size_t(draws_)];
  // What a frame takes beside other work is no more than it takes. After much of that the mean is
  // of long ago: it begins anew.
  if (disturbed && cost.frames >= AutoTrials::kFrames) ms = std::min(ms, cost.mean_ms);
  if (!disturbed && disturbed_ > kLongDisturbed) cost.frames = std::min(cost.frames, 1);
  disturbed_ = disturbed ? disturbed_ + 1 : 0;
  // The first frames of a method that warms up are not what it takes: they are forgotten soon.
  const int warm_up = candidates_[std::size_t(draws_)].warm_up;
  const bool warms_up = since_change_ <= warm_up;
  const double newest = newest_share(warms_up ? kNewestOfWarmUp : kNewest, ++cost.frames);
  cost.recent.add(ms);
  ++cost.measured, last_ms_ = ms;
  if (!warms_up && cost.recent.count() >= kLast) note_calm(cost);
  const double before_ms = cost.mean_ms, guess_ms = guesses_[std::size_t(draws_)];
  double usual_ms = before_ms - cost.dear.mean_ms();
  if (!warms_up && cost.recent.count() >= kLeastForMedian) {
    const double most_ms = AutoTrials::kMuch * cost.recent.median();
    cost.dear.add(ms, most_ms);
    ms = std::min(ms, most_ms);
  }
  usual_ms += (ms - usual_ms) * newest;
  if (cost.dear.come_back())
    less_ = 0;
  else
    note_less(usual_ms, ms);
  cost.mean_ms = usual_ms + cost.dear.mean_ms();
  if (cost.frames > kLast && !disturbed && guess_ms > 0 && cost.guess_ms > 0)
    slow_ *= cost.mean_ms / before_ms * cost.guess_ms / guess_ms;
  cost.age = 0;
  cost.guess_ms = guess_ms;
}

}  // namespace rilievo
