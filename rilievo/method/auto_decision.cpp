#include "rilievo/method/auto_decision.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "rilievo/core/expects.h"

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
// Frames from a trial to the next of the same method: after the first one that fails, and at most.
constexpr int kGap = 40, kMostGap = 640;
// What takes as much as what draws, within kClose, counts as having failed so many times more: both
// are known well, and to change over gains next to nothing.
constexpr int kFailsOfClose = 2;
// A jump makes what was measured older by so many frames.
constexpr int kJumpAges = 200;
// What is older than this is not known.
constexpr int kKnown = 150;
constexpr double kMuchMore = 1.3;
// What is left in the next frame of a change that counts as recent; and the most gain that many
// recent ones ask for.
constexpr double kStaysRecent = 0.99, kMostGain = 0.2;
// The frames of a trial after the warm-up; and of one that ends within kClose of the other's time.
constexpr int kTrial = 3, kCloseTrial = 10, kMostTrial = 64;
constexpr double kClose = 0.15;
// A trial of which a frame takes this much more ends at once; after a warm-up. So one that fails is
// two frames, and not more than a hundredth of a walk of some seconds.
constexpr double kHopeless = 1.25;
// Of what warms up for longer.
constexpr double kHopelessWarmingUp = 1.6;
// What promises much counts as at least as likely as this to be good enough.
constexpr double kLikely = 0.5;
// What warms up for so many frames is dear to return to.
constexpr int kWarmsUpLong = 5;
// So much more than later on its frames take while it warms up again.
constexpr double kWarmUpMore = 0.3;
// And one whose frames together take so many frames' time more.
constexpr double kMostMore = 5;
// What is prepared in the time of so many frames need not gain much.
constexpr double kLittle = 2;

// By how much all methods are taken to have become slower since one of them was measured, at most.
constexpr double kMostSlower = 1.25;

// A frame that takes so many times the median of the last ones counts as that: other programs slow
// some frames in a row down by much more.
constexpr double kMuchForMean = 1.3;
constexpr int kLeastForMedian = 3;
// What draws may take so much more for so many frames before anything is concluded.
constexpr int kUnsettled = 12;
// The share of a frame in what a method took at its best, where it takes more.
constexpr double kNewestCalm = 0.02;
// What took so many times what it plausibly takes, and was measured in fewer frames than these, is
// not believed for ever.
constexpr double kContradicts = 1.5;
constexpr int kSure = 60;
// A frame of a trial is counted as at most so many frames: more is the work of another program.
constexpr double kMostOfTrial = 2;
// So many slow frames in a row after a trial say that it was disturbed; it is repeated after some
// more, so many times at most.
constexpr int kSlowAfter = 2, kRepeat = 20, kMostRepeats = 2;
constexpr double kMuchOfWarmUp = 2;
// What was measured with kThreads threads (AVX-512, no GPU): direct-raster, direct-rays, keyframes.
constexpr int kThreads = 2;
constexpr double kDirectPixelMs = 18e-6, kDirectTriangleMs = 11e-6;
constexpr double kRaysPixelMs = 180e-6, kMaskedTimes = 4, kKeyframesPixelMs = 13e-6,
                 kKeyframesSkyMs = 8e-6;

double doubt(int age) { return std::min(kMostDoubt, kDoubt * std::sqrt(double(age))); }

int gap_after(int fails, bool close) {
  return std::min(kMostGap, kGap << std::min(fails + (close ? kFailsOfClose : 0), 8));
}

// The mean without the largest, which may be the work of another program, and of others that take
// much as of frames that are no trial.
double trial_mean(std::span<const double> ms) {
  std::array<double, kMostTrial> sorted;
  RILIEVO_EXPECTS(!ms.empty() && ms.size() <= sorted.size());
  const auto end = std::copy(ms.begin(), ms.end(), sorted.begin());
  std::sort(sorted.begin(), end);
  if (ms.size() == 1) return ms[0];
  const double most = kMuchForMean * sorted[ms.size() / 2];
  double sum = 0;
  for (auto one = sorted.begin(); one != end - 1; ++one) sum += std::min(*one, most);
  return sum / double(ms.size() - 1);
}

}  // namespace

double newest_share(double least, int frames) {
  return std::max(least, 1.0 / std::max(1, frames - 1));
}

double FrameLoad::by_threads(double ms) const { return ms * kThreads / threads; }
double FrameLoad::pixels_ms() const { return by_threads(kDirectPixelMs * pixels); }
double FrameLoad::direct_ms() const {
  return pixels_ms() + by_threads(kDirectTriangleMs * triangles);
}
double FrameLoad::levels_ms() const {
  return pixels_ms() + by_threads(kDirectTriangleMs * level_triangles);
}
double FrameLoad::rays_ms() const {
  return (masked ? kMaskedTimes : 1) * by_threads(kRaysPixelMs * pixels);
}
double FrameLoad::keyframes_ms() const {
  const double things = std::min(covered, pixels);
  return by_threads(kKeyframesPixelMs * things + kKeyframesSkyMs * (pixels - things));
}

std::string_view describe(AutoReason reason) {
  switch (reason) {
    case AutoReason::only:
      return "the scene fits the frame";
    case AutoReason::begins:
      return "by the size of the scene";
    case AutoReason::cheapest:
      return "the cheapest";
    case AutoReason::best:
      return "the best that keeps the pace";
    case AutoReason::trial:
      return "a trial";
    case AutoReason::leaves:
      return "what drew before is not good enough";
  }
  return {};
}

AutoDecision::AutoDecision(std::span<const AutoCandidate> candidates, int first, double pace_ms)
    : candidates_(candidates.begin(), candidates.end()),
      costs_(candidates.size()),
      pace_ms_(pace_ms),
      draws_(first),
      guesses_(candidates.size()) {
  RILIEVO_EXPECTS(first >= 0 && first < int(candidates.size()));
  // So that no trial allocates.
  int most = 0;
  for (const AutoCandidate& one : candidates_) most = std::max(most, one.warm_up);
  trial_ms_.reserve(std::size_t(most + kCloseTrial));
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
  const double model = outlook.guess_ms > 0 ? outlook.guess_ms : outlook.prior_ms;
  double least = ms;
  if (cost.calm > 0 && cost.calm_of_guess == (outlook.guess_ms > 0))
    least = std::min(least, cost.calm * (cost.calm_of_guess ? outlook.guess_ms : 1));
  if (cost.measured < kSure && model > 0) least = std::min(least, model);
  return kContradicts * least < ms ? least : ms;
}

// What it takes if it takes little.
double AutoDecision::hoped(int i, const AutoOutlook& outlook) const {
  const Cost& cost = costs_[std::size_t(i)];
  const double ms = plausible(i, outlook);
  if (ms == 0) return kHopeOfUnknown * costs_[std::size_t(draws_)].mean_ms;
  return ms * (1 - (cost.mean_ms == 0 ? kGuessDoubt : doubt(cost.age)));
}

bool AutoDecision::better(double ms, int candidate, double than_ms, int than) const {
  const int rank = candidates_[std::size_t(candidate)].rank,
            than_rank = candidates_[std::size_t(than)].rank;
  if (pace_ms_ > 0) {
    const bool keeps = ms < kKeepsPace * pace_ms_, than_keeps = than_ms < kKeepsPace * pace_ms_;
    if (keeps && than_keeps) return rank < than_rank;
  }
  // What is dear to return to is not left for nothing.
  const bool stays = candidates_[std::size_t(than)].warm_up >= kWarmsUpLong;
  return ms < (rank < than_rank && !stays ? 1 : 1 - needed_gain()) * than_ms;
}

// Each change costs a trial and a fade: what changed often must gain more.
double AutoDecision::needed_gain() const {
  return std::min(kGain * std::max(1.0, recent_changes_), kMostGain);
}

// What a frame may take at no loss.
double AutoDecision::free_ms() const {
  return std::max(costs_[std::size_t(draws_)].mean_ms, kKeepsPace * pace_ms_);
}

bool AutoDecision::affordable(double ms) const {
  // The time of two frames is free.
  return trials_ms_ + ms <= 2 * costs_[std::size_t(draws_)].mean_ms + kTrialShare * all_ms_;
}

int AutoDecision::best_known(std::span<const AutoOutlook> outlook) const {
  int best = draws_;
  double best_ms = costs_[std::size_t(draws_)].mean_ms;
  for (int i = 0; i < int(candidates_.size()); ++i) {
    const Cost& cost = costs_[std::size_t(i)];
    const AutoOutlook& one = outlook[std::size_t(i)];
    if (i == draws_ || !one.ready || !one.good_enough || cost.mean_ms == 0 || cost.age > kKnown)
      continue;
    const double ms = unexplained(i) * expected(i, one);
    if (!better(ms, i, best_ms, best)) continue;
    best = i, best_ms = ms;
  }
  return best;
}

// Of those that can draw, or of those that can be prepared.
int AutoDecision::worth_trying(std::span<const AutoOutlook> outlook, bool ready) const {
  const double now = costs_[std::size_t(draws_)].mean_ms;
  int best = -1;
  double most = 0;
  for (int i = 0; i < int(candidates_.size()); ++i) {
    const Cost& cost = costs_[std::size_t(i)];
    const AutoOutlook& one = outlook[std::size_t(i)];
    if (i == draws_ || !(ready ? one.ready : one.preparable) || !one.good_enough) continue;
    if (cost.fails > 0 && cost.age < cost.gap) continue;
    const double hope = hoped(i, one), likely = std::max(plausible(i, one), hope);
    const AutoCandidate& candidate = candidates_[std::size_t(i)];
    if (!better(hope, i, now, draws_)) continue;
    // A model knows what has changed since; without one the method may have become cheaper.
    if (one.guess_ms > 0 && likely > kMaySpike * free_ms()) continue;
    const int frames = candidate.warm_up + kTrial;
    // What is likely to be no dearer is no expense, however much others were; but to return to what
    // warms up for long is one.
    double expense = std::max(0.0, likely - free_ms()) * frames;
    if (cost.mean_ms > 0 && candidate.warm_up >= kWarmsUpLong)
      expense += kWarmUpMore * likely * candidate.warm_up;
    // What is hoped for against what was measured is tried once for nothing.
    const double measured = std::min(expected(i, one), kMostOfTrial * free_ms());
    if (cost.fails >= 2 && measured > kContradicts * likely)
      expense += kSlowAfter * std::max(0.0, measured - free_ms());
    if (expense > 0 && !affordable(expense)) continue;
    const double pays = kPaysWithin * candidate.chance * (now - (hope + likely) / 2);
    const bool promises =
        cost.mean_ms == 0 && one.guess_ms > 0 && one.guess_ms <= (1 - kMuchCheaper) * now;
    const double worth = one.prepare_ms > kLittle * now ? kWorthPreparing : 1;
    if (!one.ready && !promises && (hope > worth * now || one.prepare_ms > pays)) continue;
    // What must be prepared takes its time, in which nothing else can be.
    const double chance = ready      ? 1
                          : promises ? std::max(candidate.chance, kLikely)
                                     : candidate.chance;
    const double gain = chance * (now - hope);
    if (best >= 0 && gain <= most) continue;
    best = i, most = gain;
  }
  return best;
}

// While what draws warms up, so that its time says little yet.
int AutoDecision::plainly_worth_preparing(std::span<const AutoOutlook> outlook) const {
  double least = 0;  // of what can draw
  for (const AutoOutlook& one : outlook)
    if (one.ready && one.guess_ms > 0 && (least == 0 || one.guess_ms < least)) least = one.guess_ms;
  int best = -1;
  double most = 0;
  for (int i = 0; i < int(candidates_.size()); ++i) {
    const AutoOutlook& one = outlook[std::size_t(i)];
    if (!one.preparable || !one.good_enough || one.guess_ms == 0) continue;
    if (one.guess_ms > kPlainlyWorth * least) continue;
    if (one.prepare_ms > kPaysWithin * (least - one.guess_ms)) continue;
    // What is likely before what takes a little less and is refused as often as not.
    const double gain = candidates_[std::size_t(i)].chance * (least - one.guess_ms);
    if (best < 0 || gain > most) best = i, most = gain;
  }
  return best;
}

void AutoDecision::change(int to) {
  Cost& left = costs_[std::size_t(draws_)];
  left.age = 0, left.slow = slow_;
  left.guess_ms = guesses_[std::size_t(draws_)];
  // Methods that take the same must not take turns.
  const bool close = std::abs(costs_[std::size_t(to)].mean_ms / left.mean_ms - 1) <= kClose;
  left.gap = gap_after(left.fails, close);
  ++left.fails;
  draws_ = to;
  costs_[std::size_t(to)].recent.forget();
  since_change_ = 0;
  unsettled_ = 0, last_ms_ = 0, failed_.tried = -1;
  ++recent_changes_;
}

bool AutoDecision::trial_over() const {
  const int warm_up = candidates_[std::size_t(trial_)].warm_up;
  const int drawn = int(trial_ms_.size()) - warm_up;
  const bool long_warm_up = warm_up >= kWarmsUpLong;
  const double now = costs_[std::size_t(draws_)].mean_ms;
  const double hopeless = (long_warm_up ? kHopelessWarmingUp : kHopeless) * free_ms();
  if (trial_ms_.empty()) return false;
  // The first frames of what must warm up say little; of what need not, one says enough, unless it
  // was expected to be no dearer: that may be the work of another program.
  const int measured = int(trial_ms_.size()) - (long_warm_up ? warm_up / 2 : warm_up);
  const bool unlikely = trial_expected_ms_ > 0 && trial_expected_ms_ <= free_ms();
  const int needed = long_warm_up || unlikely ? 2 : 1;
  if (measured >= (long_warm_up ? 1 : needed) &&
      std::all_of(trial_ms_.end() - needed, trial_ms_.end(),
                  [&](double ms) { return ms > hopeless; }))
    return true;
  double more = 0;
  for (const double ms : trial_ms_) more += ms - free_ms();
  if (more > kMostMore * free_ms()) return true;
  if (drawn < kTrial) return false;
  const double mean = trial_mean(std::span(trial_ms_).subspan(std::size_t(warm_up)));
  return drawn >= kCloseTrial || std::abs(mean / now - 1) > kClose;
}

void AutoDecision::end_trial(std::span<const AutoOutlook> outlook) {
  if (trial_ms_.empty()) {
    trial_ = -1;
    return;
  }
  const AutoCandidate& tried = candidates_[std::size_t(trial_)];
  Cost& cost = costs_[std::size_t(trial_)];
  failed_ = {trial_, cost, trial_cost_ms_, costs_[std::size_t(draws_)].calm, 0};
  const int drawn = int(trial_ms_.size());
  const int from = drawn > tried.warm_up ? tried.warm_up : std::max(0, drawn - 2);
  cost.mean_ms = trial_mean(std::span(trial_ms_).subspan(std::size_t(from)));
  cost.guess_ms = outlook[std::size_t(trial_)].guess_ms;
  cost.frames = drawn - from, cost.age = 0, cost.slow = slow_;
  cost.measured += cost.frames;
  cost.recent.set(cost.mean_ms, cost.frames);
  const double now = costs_[std::size_t(draws_)].mean_ms;
  const bool wins = outlook[std::size_t(trial_)].ready &&
                    outlook[std::size_t(trial_)].good_enough &&
                    better(cost.mean_ms, trial_, now, draws_);
  const int to = trial_;
  trial_ = -1;
  trial_ms_.clear();
  if (!wins) {
    // It warms up again.
    if (candidates_[std::size_t(draws_)].warm_up >= kWarmsUpLong) since_change_ = 0;
    cost.gap = gap_after(cost.fails, drawn - tried.warm_up >= kCloseTrial);
    ++cost.fails;
    return;
  }
  change(to);
  reason_ = AutoReason::cheapest;
}

AutoChoice AutoDecision::next(std::span<const AutoOutlook> outlook, bool jumped, bool disturbed) {
  RILIEVO_EXPECTS(outlook.size() == candidates_.size());
  for (int i = 0; i < int(candidates_.size()); ++i) {
    guesses_[std::size_t(i)] = outlook[std::size_t(i)].guess_ms;
    Cost& cost = costs_[std::size_t(i)];
    if (i != draws_) cost.age += jumped ? kJumpAges : 1;
    if (!jumped) continue;
    // What was learned is of another place.
    cost.fails = cost.repeats = 0;
    cost.frames = std::min(cost.frames, 2);
    cost.recent.forget();
  }
  if (jumped) failed_.tried = -1;
  ++since_change_;
  recent_changes_ = jumped ? 0 : kStaysRecent * recent_changes_;
  // The frames of a warm-up are forgotten when it is over.
  const int warm_up = candidates_[std::size_t(draws_)].warm_up;
  if (warm_up >= kWarmsUpLong && since_change_ == warm_up + 1)
    costs_[std::size_t(draws_)].frames = 0;

  if (prepares_ >= 0 && !outlook[std::size_t(prepares_)].preparable) prepares_ = -1;
  if (trial_ >= 0) {
    const AutoOutlook& tried = outlook[std::size_t(trial_)];
    if (jumped || !tried.ready || !tried.good_enough || trial_over()) end_trial(outlook);
  }
  if (trial_ < 0) {
    const AutoOutlook& drawing = outlook[std::size_t(draws_)];
    if (!drawing.ready || !drawing.good_enough) {
      // To the cheapest that can draw; rank decides where nothing is known.
      int to = -1;
      for (int i = 0; i < int(candidates_.size()); ++i) {
        const AutoOutlook& one = outlook[std::size_t(i)];
        if (i == draws_ || !one.ready || !one.good_enough) continue;
        if (to < 0 ||
            (expected(i, one) > 0 && expected(i, one) < expected(to, outlook[std::size_t(to)])))
          to = i;
      }
      if (to >= 0) change(to), reason_ = AutoReason::leaves;
    }
    const bool settled = unsettled_ == 0 || unsettled_ > kUnsettled;
    if (costs_[std::size_t(draws_)].frames >= kTrial && settled) {
      const int best = best_known(outlook);
      const double now = costs_[std::size_t(draws_)].mean_ms;
      const bool warm = since_change_ > candidates_[std::size_t(draws_)].warm_up;
      if (best != draws_ && (since_change_ > candidates_[std::size_t(draws_)].dwell ||
                             (warm && now > kMuchMore * costs_[std::size_t(best)].mean_ms))) {
        change(best);
        reason_ = pace_ms_ > 0 && costs_[std::size_t(best)].mean_ms < kKeepsPace * pace_ms_
                      ? AutoReason::best
                      : AutoReason::cheapest;
      } else if (since_change_ > candidates_[std::size_t(draws_)].warm_up) {
        const bool slow = last_ms_ > kMuchForMean * now;
        const int tries = disturbed || slow ? -1 : worth_trying(outlook, true);
        // What is prepared would disturb the trial.
        prepares_ = tries >= 0 ? -1 : worth_trying(outlook, false);
        if (tries >= 0) {
          trial_ = tries, trial_ms_.clear(), trial_cost_ms_ = 0;
          trial_expected_ms_ = plausible(tries, outlook[std::size_t(tries)]);
        }
      }
    }
    if (since_change_ <= candidates_[std::size_t(draws_)].warm_up &&
        costs_[std::size_t(draws_)].fails == 0)
      prepares_ = plainly_worth_preparing(outlook);
  }

  AutoChoice choice;
  choice.draws = drawn_ = trial_ >= 0 ? trial_ : draws_;
  choice.prepares = prepares_;
  choice.reason = candidates_.size() == 1 ? AutoReason::only
                  : trial_ >= 0           ? AutoReason::trial
                                          : reason_;
  choice.expected_ms = costs_[std::size_t(choice.draws)].mean_ms;
  for (int i = 0; i < int(candidates_.size()); ++i) {
    const double ms = expected(i, outlook[std::size_t(i)]);
    if (!outlook[std::size_t(i)].ready || !outlook[std::size_t(i)].good_enough) continue;
    if (i == choice.draws || ms == 0 || (choice.rival >= 0 && ms >= choice.rival_ms)) continue;
    choice.rival = i, choice.rival_ms = ms;
  }
  return choice;
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
  else if (now <= kMuchForMean * cost.calm || unsettled_ >= kUnsettled)
    cost.calm += (now - cost.calm) * kNewestCalm;
  cost.calm_of_guess = of_guess;
  unsettled_ = now > kMuchForMean * cost.calm ? unsettled_ + 1 : 0;
}

// After a trial that failed: if what draws takes much more, too, something else took the time.
void AutoDecision::doubt_failed(double ms) {
  // What warms up again takes more anyway.
  const bool warms_up = candidates_[std::size_t(draws_)].warm_up >= kWarmsUpLong;
  const double much = warms_up ? kMuchOfWarmUp : kMuchForMean;
  Cost& cost = costs_[std::size_t(failed_.tried)];
  if (failed_.usual == 0 || over_guess(ms) <= much * failed_.usual ||
      cost.repeats >= kMostRepeats) {
    failed_.tried = -1;
    return;
  }
  if (++failed_.slow < kSlowAfter) return;
  const int age = cost.age;
  cost = failed_.before;
  cost.age += age;
  cost.gap = cost.age + kRepeat, cost.fails = std::max(cost.fails, 1);
  ++cost.repeats;
  trials_ms_ -= failed_.ms;
  failed_.tried = -1;
}

void AutoDecision::add(double ms, bool disturbed) {
  RILIEVO_EXPECTS(drawn_ >= 0);
  all_ms_ += ms;
  if (trial_ >= 0) {
    trial_ms_.push_back(ms);
    const double more_ms = std::max(0.0, std::min(ms, kMostOfTrial * free_ms()) - free_ms());
    trials_ms_ += more_ms, trial_cost_ms_ += more_ms;
    return;
  }
  if (failed_.tried >= 0) doubt_failed(ms);
  Cost& cost = costs_[std::size_t(draws_)];
  // What a frame takes beside other work is no more than it takes.
  if (disturbed && cost.frames >= kTrial) ms = std::min(ms, cost.mean_ms);
  // The first frames of a method that warms up are not what it takes: they are forgotten soon.
  const int warm_up = candidates_[std::size_t(draws_)].warm_up;
  const bool warms_up = since_change_ <= warm_up;
  const double newest = newest_share(warms_up ? kNewestOfWarmUp : kNewest, ++cost.frames);
  cost.recent.add(ms);
  ++cost.measured, last_ms_ = ms;
  if (!warms_up && cost.recent.count() >= kLast) note_calm(cost);
  const double before_ms = cost.mean_ms, guess_ms = guesses_[std::size_t(draws_)];
  if (!warms_up && cost.recent.count() >= kLeastForMedian)
    ms = std::min(ms, kMuchForMean * cost.recent.median());
  cost.mean_ms += (ms - cost.mean_ms) * newest;
  if (cost.frames > kLast && !disturbed && guess_ms > 0 && cost.guess_ms > 0)
    slow_ *= cost.mean_ms / before_ms * cost.guess_ms / guess_ms;
  cost.age = 0;
  cost.guess_ms = guess_ms;
}

}  // namespace rilievo
