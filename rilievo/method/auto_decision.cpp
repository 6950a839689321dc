#include "rilievo/method/auto_decision.h"

#include <algorithm>
#include <cmath>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

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
// What is in view has not changed while a rough model says that much of what it did.
constexpr double kAsMuch = 0.7;
// Else to return to what captures must be likely to take at most this share of what draws: its
// first frame takes several times as long, which a small gain never pays for.
constexpr double kWorthReturning = 0.85;
// And it is left for a gain of so much.
constexpr double kWorthLeaving = 0.1;
// So many times in a row it warms up again after jumps until something else may be tried.
constexpr int kMostWarmUps = 4;
constexpr int kWarmsUpLong = AutoTrials::kWarmsUpLong;

int gap_after(int fails, bool close) {
  return std::min(kMostGap, kGap << std::min(fails + (close ? kFailsOfClose : 0), 8));
}

int longest_warm_up(std::span<const AutoCandidate> candidates) {
  int most = 0;
  for (const AutoCandidate& one : candidates) most = std::max(most, one.warm_up);
  return most;
}

}  // namespace

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

bool AutoDecision::better(double ms, int candidate, double than_ms, int than) const {
  const int rank = candidates_[std::size_t(candidate)].rank,
            than_rank = candidates_[std::size_t(than)].rank;
  if (pace_ms_ > 0) {
    const bool keeps = ms < kKeepsPace * pace_ms_, than_keeps = than_ms < kKeepsPace * pace_ms_;
    if (keeps && than_keeps) return rank < than_rank;
  }
  // What is dear to return to is not left for nothing, nor for what may be chance.
  if (candidates_[std::size_t(than)].warm_up >= kWarmsUpLong)
    return ms < (1 - std::max(kWorthLeaving, needed_gain())) * than_ms;
  return ms < (rank < than_rank ? 1 : 1 - needed_gain()) * than_ms;
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
        cost.prior_ms > 0 && likely > kWorthReturning * free_ms())
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
    // Its first frames capture: they do not say what it will take.
    const double prior_ms = outlook[std::size_t(draws_)].prior_ms;
    if (prior_ms > 0) least = std::min(least, prior_ms);
    for (const AutoOutlook& other : outlook)
      if (&other != &one && other.ready && other.guess_ms > 0)
        least = std::min(least, other.guess_ms);
    return one.guess_ms <= kPlainlyWorth * least;
  };
  for (int i = 0; i < int(candidates_.size()); ++i)
    if (plain(i)) return i;
  return -1;
}

// Is nothing known yet of what it takes?
bool AutoDecision::warms_up_first() const {
  const Cost& cost = costs_[std::size_t(draws_)];
  return cost.fails == 0 && cost.measured <= candidates_[std::size_t(draws_)].warm_up;
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
  costs_[std::size_t(to)].forget_recent();
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

// May what was tried draw on? What is dear to return to must be worth that: its first frames take
// several times as long, and another change would follow. But not for what few frames say.
bool AutoDecision::may_replace(const AutoTrials::Found& found, int tried, double drawing_ms) const {
  if (better(found.mean_ms, tried, drawing_ms, draws_)) return true;
  const bool returns = candidates_[std::size_t(draws_)].warm_up >= kWarmsUpLong &&
                       found.frames >= AutoTrials::kFrames;
  return returns && pace_ms_ == 0 && !tried_in_warm_up_ && found.mean_ms < drawing_ms;
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
  if (now.ready && now.good_enough && may_replace(*found, tried, drawing_ms) &&
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

// A frame has gone by, and after a jump what was learned is of another place.
void AutoDecision::begin_frame(std::span<const AutoOutlook> outlook, bool jumped) {
  for (int i = 0; i < int(candidates_.size()); ++i) {
    guesses_[std::size_t(i)] = outlook[std::size_t(i)].guess_ms;
    priors_[std::size_t(i)] = outlook[std::size_t(i)].prior_ms;
    Cost& cost = costs_[std::size_t(i)];
    if (i != draws_) cost.age += jumped ? kJumpAges : 1;
    if (!jumped) continue;
    cost.fails = 0, cost.prior_ms = 0;
    cost.frames = std::min(cost.frames, 2);
    cost.forget_recent();
  }
  if (jumped) less_ = 0;
  ++since_change_;
  recent_changes_ = jumped ? 0 : kStaysRecent * recent_changes_;
  // The frames of a warm-up are forgotten when it is over. After a jump there is another, but an
  // eye that jumps all the time does not put off for ever what may be better.
  const int warm_up = candidates_[std::size_t(draws_)].warm_up;
  if (jumped && warm_up >= kWarmsUpLong && ++warm_ups_ <= kMostWarmUps) since_change_ = 1;
  if (warm_up >= kWarmsUpLong && since_change_ == warm_up + 1)
    costs_[std::size_t(draws_)].frames = 0, costs_[std::size_t(draws_)].dear.forget();
  if (prepares_ >= 0 && !outlook[std::size_t(prepares_)].preparable) prepares_ = -1;
}

// Has a trial come to its end, and failed?
bool AutoDecision::fails_trial(std::span<const AutoOutlook> outlook, bool jumped) {
  if (!trials_.goes_on()) return false;
  const AutoOutlook& tried = outlook[std::size_t(trials_.method())];
  if (!jumped && tried.ready && tried.good_enough &&
      !trials_.over(free_ms(), costs_[std::size_t(draws_)].mean_ms))
    return false;
  const int draws = draws_;
  end_trial(outlook);
  return draws_ == draws;
}

// What cannot draw, or not well enough, is left for the cheapest that can; rank decides where
// nothing is known.
void AutoDecision::leave_what_may_not_draw(std::span<const AutoOutlook> outlook) {
  const AutoOutlook& drawing = outlook[std::size_t(draws_)];
  if (drawing.ready && drawing.good_enough) return;
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

// Where it is known what draws takes: a change, or a trial, or something to be prepared.
void AutoDecision::compare(std::span<const AutoOutlook> outlook, bool disturbed) {
  const int best = best_known(outlook);
  const double now = costs_[std::size_t(draws_)].mean_ms,
               best_ms = costs_[std::size_t(best)].mean_ms;
  const bool warm = !warms_up();
  if (warm) warm_ups_ = 0;
  const bool stayed =
      since_change_ > candidates_[std::size_t(draws_)].dwell || (warm && now > kMuchMore * best_ms);
  if (settled() && best != draws_ && stayed) {
    change(best);
    reason_ =
        pace_ms_ > 0 && best_ms < kKeepsPace * pace_ms_ ? AutoReason::best : AutoReason::cheapest;
  } else if (warm) {
    if (settled()) prepares_ = worth_trying(outlook, false);
    if (!disturbed && last_ms_ <= AutoTrials::kMuch * now)
      begin_trial(worth_trying(outlook, true), outlook);
  } else if (!disturbed) {
    begin_trial(plainly_worth_trying(outlook), outlook);
  }
}

// While what draws warms up. What a method takes that warms up again, after a trial that failed, is
// known: nothing has to wait for that.
void AutoDecision::prepare_in_warm_up(std::span<const AutoOutlook> outlook, bool failed) {
  if (!warms_up()) return;
  if (failed && settled())
    prepares_ = worth_trying(outlook, false);
  else if (!trials_.goes_on() && warms_up_first())
    prepares_ = plainly_worth_preparing(outlook);
}

AutoChoice AutoDecision::next(std::span<const AutoOutlook> outlook, bool jumped, bool disturbed) {
  RILIEVO_EXPECTS(outlook.size() == candidates_.size());
  begin_frame(outlook, jumped);
  const bool failed = fails_trial(outlook, jumped);
  if (!trials_.goes_on()) {
    leave_what_may_not_draw(outlook);
    // What was prepared for long waits for some frames without.
    const bool known = disturbed || disturbed_ <= kLongDisturbed;
    if (known && costs_[std::size_t(draws_)].frames >= AutoTrials::kFrames)
      compare(outlook, disturbed);
    else
      prepares_ = -1;
    prepare_in_warm_up(outlook, failed && !jumped);
  }
  drawn_ = trials_.goes_on() ? trials_.method() : draws_;
  return explain(outlook);
}

// What draws the frame, why, and beside what else.
AutoChoice AutoDecision::explain(std::span<const AutoOutlook> outlook) const {
  AutoChoice choice;
  choice.draws = drawn_;
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

}  // namespace rilievo
