#include "rilievo/method/auto_decision.h"

#include <algorithm>
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
// What promises much counts as at least as likely as this to be good enough.
constexpr double kLikely = 0.5;
// What is prepared in the time of so many frames need not gain much.
constexpr double kLittle = 2;

// By how much all methods are taken to have become slower since one of them was measured, at most.
constexpr double kMostSlower = 1.25;

// A frame that takes AutoTrials::kMuch times the median of so many of the last ones, at least,
// counts as that, unless such frames come back (dear_frames.h): other programs slow some frames in
// a row down by much more.
constexpr int kLeastForMedian = 3;
// What draws may take so much more for so many frames before anything is concluded.
constexpr int kUnsettled = 12;
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
// What is in view has not changed while a rough model says that much of what it did.
constexpr double kAsMuch = 0.7;
// Frames beside other work, after which it is not known what they take without.
constexpr int kLongDisturbed = 12;
constexpr int kWarmsUpLong = AutoTrials::kWarmsUpLong;

double doubt(int age) { return std::min(kMostDoubt, kDoubt * std::sqrt(double(age))); }

int gap_after(int fails, bool close) {
  return std::min(kMostGap, kGap << std::min(fails + (close ? kFailsOfClose : 0), 8));
}

int longest_warm_up(std::span<const AutoCandidate> candidates) {
  int most = 0;
  for (const AutoCandidate& one : candidates) most = std::max(most, one.warm_up);
  return most;
}

}  // namespace

double newest_share(double least, int frames) {
  return std::max(least, 1.0 / std::max(1, frames - 1));
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
      trials_(longest_warm_up(candidates)),
      guesses_(candidates.size()),
      priors_(candidates.size()) {
  RILIEVO_EXPECTS(first >= 0 && first < int(candidates.size()));
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
  if (kContradicts * least < ms) return least;
  const double prior_ms = outlook.guess_ms > 0 ? 0 : outlook.prior_ms;
  return prior_ms > 0 && kContradictsPrior * prior_ms < ms ? prior_ms : ms;
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

int AutoDecision::best_known(std::span<const AutoOutlook> outlook) const {
  int best = draws_;
  double best_ms = costs_[std::size_t(draws_)].mean_ms;
  for (int i = 0; i < int(candidates_.size()); ++i) {
    const Cost& cost = costs_[std::size_t(i)];
    const AutoOutlook& one = outlook[std::size_t(i)];
    if (i == draws_ || !one.ready || !one.good_enough || cost.mean_ms == 0 || cost.age > kKnown)
      continue;
    if (!comparable(plausible(i, one), i, outlook)) continue;
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
    if (ready && !comparable(plausible(i, one), i, outlook)) continue;
    const double hope = hoped(i, one), likely = std::max(plausible(i, one), hope);
    const AutoCandidate& candidate = candidates_[std::size_t(i)];
    if (!better(hope, i, now, draws_)) continue;
    // A model knows what has changed since; without one the method may have become cheaper.
    if (one.guess_ms > 0 && likely > kMaySpike * free_ms()) continue;
    // But what captures when it returns is a frame of several times the time: something in view
    // must have changed for that.
    if (candidate.warm_up >= kWarmsUpLong && one.prior_ms > kAsMuch * cost.prior_ms &&
        cost.prior_ms > 0 && !better(likely, i, free_ms(), draws_))
      continue;
    if (!trials_.affords({candidate.warm_up, likely, cost.mean_ms > 0}, free_ms(), now)) continue;
    const double gains = now - (hope + likely) / 2, pays = kPaysWithin * candidate.chance * gains;
    const bool promises =
        cost.mean_ms == 0 && one.guess_ms > 0 && one.guess_ms <= (1 - kMuchCheaper) * now;
    const double worth = one.prepare_ms > kLittle * now ? kWorthPreparing : 1;
    if (!one.ready && !promises && (hope > worth * now || one.prepare_ms > pays)) continue;
    // What must be prepared takes its time, in which nothing else can be.
    const double chance = ready      ? 1
                          : promises ? std::max(candidate.chance, kLikely)
                                     : candidate.chance;
    // What can draw is tried for what it may have become since.
    const double gain = ready ? now - hope : chance * gains;
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

// While the first method warms up, too: what never drew, and takes less than half of that and of
// all that can draw.
int AutoDecision::plainly_worth_trying(std::span<const AutoOutlook> outlook) const {
  const auto plain = [&](int i) {
    const AutoOutlook& one = outlook[std::size_t(i)];
    if (i == draws_ || !one.ready || !one.good_enough || one.guess_ms == 0) return false;
    if (costs_[std::size_t(i)].mean_ms > 0 || reason_ != AutoReason::begins) return false;
    double least = costs_[std::size_t(draws_)].mean_ms;
    for (const AutoOutlook& other : outlook)
      if (&other != &one && other.ready && other.guess_ms > 0)
        least = std::min(least, other.guess_ms);
    return one.guess_ms <= kPlainlyWorth * least;
  };
  for (int i = 0; i < int(candidates_.size()); ++i)
    if (plain(i)) return i;
  return -1;
}

// Does what draws take more than it will?
bool AutoDecision::warms_up() const {
  return since_change_ <= candidates_[std::size_t(draws_)].warm_up;
}

void AutoDecision::change(int to) {
  Cost& left = costs_[std::size_t(draws_)];
  left.age = 0, left.slow = slow_;
  left.guess_ms = guesses_[std::size_t(draws_)];
  left.prior_ms = priors_[std::size_t(draws_)];
  // Methods that take the same must not take turns.
  const bool close =
      std::abs(costs_[std::size_t(to)].mean_ms / left.mean_ms - 1) <= AutoTrials::kClose;
  left.gap = gap_after(left.fails, close);
  ++left.fails;
  draws_ = to;
  costs_[std::size_t(to)].recent.forget(), costs_[std::size_t(to)].dear.forget();
  since_change_ = 0;
  unsettled_ = less_ = 0, last_ms_ = 0;
  ++recent_changes_;
}

// Of none if that is -1.
void AutoDecision::begin_trial(int of, std::span<const AutoOutlook> outlook) {
  if (of < 0) return;
  tried_in_warm_up_ = warms_up();
  // What is prepared would disturb it; and frames before it and after it are no row.
  prepares_ = -1, less_ = 0;
  trials_.begin(of, candidates_[std::size_t(of)].warm_up, plausible(of, outlook[std::size_t(of)]));
}

// What was tried draws from now on, or its trial has failed.
void AutoDecision::end_trial(std::span<const AutoOutlook> outlook) {
  const int tried = trials_.method();
  const std::optional<AutoTrials::Found> found = trials_.end();
  if (!found) return;
  const AutoOutlook& now = outlook[std::size_t(tried)];
  Cost& cost = costs_[std::size_t(tried)];
  const Cost& drawing = costs_[std::size_t(draws_)];
  cost.mean_ms = found->mean_ms;
  cost.guess_ms = now.guess_ms;
  cost.prior_ms = now.prior_ms;
  cost.frames = found->frames, cost.age = 0, cost.slow = slow_;
  cost.measured += cost.frames;
  cost.recent.set(cost.mean_ms, cost.frames), cost.dear.forget();
  const double drawing_ms = (tried_in_warm_up_ ? kPlainlyWorth : 1) * drawing.mean_ms;
  if (now.ready && now.good_enough && better(cost.mean_ms, tried, drawing_ms, draws_) &&
      comparable(cost.mean_ms, tried, outlook)) {
    change(tried);
    reason_ = AutoReason::cheapest;
    return;
  }
  // It warms up again.
  if (candidates_[std::size_t(draws_)].warm_up >= kWarmsUpLong) since_change_ = 0;
  cost.gap = gap_after(cost.fails, found->close);
  ++cost.fails;
}

AutoChoice AutoDecision::next(std::span<const AutoOutlook> outlook, bool jumped, bool disturbed) {
  RILIEVO_EXPECTS(outlook.size() == candidates_.size());
  for (int i = 0; i < int(candidates_.size()); ++i) {
    guesses_[std::size_t(i)] = outlook[std::size_t(i)].guess_ms;
    priors_[std::size_t(i)] = outlook[std::size_t(i)].prior_ms;
    Cost& cost = costs_[std::size_t(i)];
    if (i != draws_) cost.age += jumped ? kJumpAges : 1;
    if (!jumped) continue;
    // What was learned is of another place.
    cost.fails = 0, cost.prior_ms = 0;
    cost.frames = std::min(cost.frames, 2);
    cost.recent.forget(), cost.dear.forget();
  }
  if (jumped) less_ = 0;
  ++since_change_;
  recent_changes_ = jumped ? 0 : kStaysRecent * recent_changes_;
  // The frames of a warm-up are forgotten when it is over.
  const int warm_up = candidates_[std::size_t(draws_)].warm_up;
  if (warm_up >= kWarmsUpLong && since_change_ == warm_up + 1)
    costs_[std::size_t(draws_)].frames = 0, costs_[std::size_t(draws_)].dear.forget();

  if (prepares_ >= 0 && !outlook[std::size_t(prepares_)].preparable) prepares_ = -1;
  bool failed = false;
  if (trials_.goes_on()) {
    const AutoOutlook& tried = outlook[std::size_t(trials_.method())];
    if (jumped || !tried.ready || !tried.good_enough ||
        trials_.over(free_ms(), costs_[std::size_t(draws_)].mean_ms)) {
      const int draws = draws_;
      end_trial(outlook);
      failed = draws_ == draws;
    }
  }
  if (!trials_.goes_on()) {
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
    // What was prepared waits for some frames without.
    const bool known = disturbed || disturbed_ <= kLongDisturbed;
    if (!known || costs_[std::size_t(draws_)].frames < AutoTrials::kFrames) prepares_ = -1;
    if (known && costs_[std::size_t(draws_)].frames >= AutoTrials::kFrames) {
      const int best = best_known(outlook);
      const double now = costs_[std::size_t(draws_)].mean_ms;
      const bool warm = !warms_up();
      if (settled && best != draws_ &&
          (since_change_ > candidates_[std::size_t(draws_)].dwell ||
           (warm && now > kMuchMore * costs_[std::size_t(best)].mean_ms))) {
        change(best);
        reason_ = pace_ms_ > 0 && costs_[std::size_t(best)].mean_ms < kKeepsPace * pace_ms_
                      ? AutoReason::best
                      : AutoReason::cheapest;
      } else if (warm) {
        if (settled) prepares_ = worth_trying(outlook, false);
        if (!disturbed && last_ms_ <= AutoTrials::kMuch * now)
          begin_trial(worth_trying(outlook, true), outlook);
      } else if (!disturbed) {
        begin_trial(plainly_worth_trying(outlook), outlook);
      }
    }
    // What a method takes that warms up again is known: nothing has to wait for that.
    if (failed && warms_up() && !jumped && settled)
      prepares_ = worth_trying(outlook, false);
    else if (warms_up() && !trials_.goes_on() && costs_[std::size_t(draws_)].fails == 0)
      prepares_ = plainly_worth_preparing(outlook);
  }

  AutoChoice choice;
  choice.draws = drawn_ = trials_.goes_on() ? trials_.method() : draws_;
  choice.prepares = prepares_;
  choice.reason = candidates_.size() == 1 ? AutoReason::only
                  : trials_.goes_on()     ? AutoReason::trial
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
