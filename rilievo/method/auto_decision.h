// The choice of the method that draws the next frame.
//
// A pure decision from costs: the time of each method when it drew, its time by a model, and how
// good its frames are. The one that draws is measured in every frame; the others now and
// then, in a trial of a few frames.
//
// A trial must be able to pay. A measured or modelled time counts as the less certain the older it
// is. A method is tried only if it may then be cheaper, if it takes at most kMaySpike times the
// frame, and while all trials together stay below AutoTrials::kShare of all time. A method that
// must be prepared first must gain as much in kPaysWithin frames, times its chance to be good
// enough, and a good deal; but one that was never tried and that a model says to be cheaper by
// kMuchCheaper is prepared whatever its chance: beside the frames, that costs little. If a model
// says that it takes less than half the time of any other, it is prepared from the first frame on.
// Each trial that fails doubles the time to the next one of that method. So a walk on which nothing
// changes costs next to nothing, and where the costs change the next trial is soon.
//
// Other programs slow some frames down. So while what draws takes much more than it did at its
// best, and its model does not say why, nothing is tried but what takes less than that did. For a
// dozen such frames nothing is changed for, and nothing prepared; then neither but for what takes
// less, and what it did at its best begins to grow. What took much more than it
// took at its best, or of few frames than its model says, is tried again after its gap as if it
// took that.
//
// A method is changed for one that is cheaper by kGain, or as cheap and of a better quality. One
// that warms up for long, which is dear to return to, is left for a gain of a tenth alone. With a
// pace, of all that keep it the best in quality is taken. The same input gives the same decisions.
// Milliseconds a frame; time in frames.
#pragma once

#include <cstdint>
#include <span>
#include <string_view>
#include <vector>

#include "rilievo/core/recent_times.h"
#include "rilievo/method/auto_trials.h"
#include "rilievo/method/dear_frames.h"

namespace rilievo {

// A method that may draw.
struct AutoCandidate {
  std::string_view name;
  int rank = 0;       // of its quality; 0 is the best
  int warm_up = 0;    // frames that it draws until it takes what it will take from then on
  double chance = 1;  // that its frames will be good enough, before that is known
  // Frames that it draws before the next change, unless it takes much more than what it replaced.
  int dwell = 12;
};

// A method before a frame.
struct AutoOutlook {
  bool ready = false;       // it can draw
  bool preparable = false;  // not yet, but it could be prepared beside the frames
  bool good_enough = true;  // its frames are what was asked for, as far as is known
  double guess_ms = 0;      // what it would take, by a model; 0: unknown
  double prepare_ms = 0;    // what preparing it still takes of the frames beside, all together
  // What it would take by a model that is too rough to say how that changes; 0: unknown.
  double prior_ms = 0;
};

// Why a method draws.
enum class AutoReason {
  only,      // there is no other
  begins,    // by the guesses before the first frame
  cheapest,  // by what was measured
  best,      // the best in quality that keeps the pace
  trial,     // to find out what it takes
  leaves,    // the one before is not good enough, or cannot draw
};
[[nodiscard]] std::string_view describe(AutoReason reason);

struct AutoChoice {
  int draws = 0;      // index of the method
  int prepares = -1;  // index of one to be prepared beside the frames; -1: none
  AutoReason reason = AutoReason::begins;
  double expected_ms = 0;  // by the last frames; 0: unknown
  int rival = -1;          // the next best, as far as is known; -1: none
  double rival_ms = 0;
};

// The share of the last of so many frames in their mean, `least` of many. The first one touches
// memory that others do not, and may take several times as long: the second one replaces it.
[[nodiscard]] double newest_share(double least, int frames);

// Decides for one sequence of frames.
class AutoDecision {
 public:
  static constexpr double kGain = 0.05, kMaySpike = 1.25, kMuchCheaper = 0.15;
  static constexpr int kPaysWithin = 200;
  // And must be expected to take at most this share of what draws.
  static constexpr double kWorthPreparing = 0.7;
  // Or, before anything was measured, of what models say of all that can draw.
  static constexpr double kPlainlyWorth = 0.5;
  // The share of the pace that a method may take to be said to keep it.
  static constexpr double kKeepsPace = 0.85;

  // Begins with `first`. `pace_ms`: faster frames are no gain; 0: there is no pace.
  AutoDecision(std::span<const AutoCandidate> candidates, int first, double pace_ms = 0);

  // The next frame's, for an outlook of each candidate. `jumped`: the eye has, so that what was
  // measured says less. Requires that some candidate can draw.
  // `disturbed`: something else takes time meanwhile, so that no trial begins.
  [[nodiscard]] AutoChoice next(std::span<const AutoOutlook> outlook, bool jumped = false,
                                bool disturbed = false);
  // That frame took `ms`. `disturbed`: something else took time meanwhile, so that it says little.
  void add(double ms, bool disturbed = false);

  [[nodiscard]] double mean_ms(int candidate) const {
    return costs_[std::size_t(candidate)].mean_ms;
  }
  // The method's that draws, without trials; 0: not known yet.
  [[nodiscard]] double drawn_ms() const { return mean_ms(draws_); }
  // The method that draws, apart from trials.
  [[nodiscard]] int draws() const { return draws_; }
  void set_pace(double ms) { pace_ms_ = ms; }

 private:
  // Frames whose median says what is much.
  static constexpr int kLast = 9;
  // What draws may take much more for so many frames before anything is concluded.
  static constexpr int kUnsettled = 12;
  // Frames beside other work, after which it is not known what they take without.
  static constexpr int kLongDisturbed = 12;

  struct Cost {
    double mean_ms = 0;         // of the last frames that it drew; 0: none yet
    double slow = 1;            // slow_ when that was measured
    RecentTimes<kLast> recent;  // what they took since a jump or a change to the method
    DearFrames dear;            // what some of those add to the mean
    double guess_ms = 0;        // the model's, when that was measured
    double prior_ms = 0;        // AutoOutlook::prior_ms then
    int frames = 0;             // in the mean
    int age = 0;                // frames since
    int gap = 0;                // the least age for the next trial
    int fails = 0;              // trials in a row
    int measured = 0;           // frames, in all
    // The median of what the last ones took at its best, of late; over the model's if it has one.
    double calm = 0;
    bool calm_of_guess = false;

    void forget_recent() { recent.forget(), dear.forget(); }
  };
  [[nodiscard]] double expected(int i, const AutoOutlook& outlook) const;
  [[nodiscard]] double unexplained(int i) const;
  [[nodiscard]] double plausible(int i, const AutoOutlook& outlook) const;
  [[nodiscard]] double hoped(int i, const AutoOutlook& outlook) const;
  [[nodiscard]] bool better(double ms, int candidate, double than_ms, int than) const;
  [[nodiscard]] double needed_gain() const;
  [[nodiscard]] double free_ms() const;
  [[nodiscard]] int best_known(std::span<const AutoOutlook> outlook) const;
  [[nodiscard]] int worth_trying(std::span<const AutoOutlook> outlook, bool ready) const;
  [[nodiscard]] int plainly_worth_preparing(std::span<const AutoOutlook> outlook) const;
  [[nodiscard]] int plainly_worth_trying(std::span<const AutoOutlook> outlook) const;
  [[nodiscard]] bool warms_up() const;
  [[nodiscard]] bool warms_up_first() const;
  // Does what draws take what it should, or has it taken more for long?
  [[nodiscard]] bool settled() const { return unsettled_ == 0 || unsettled_ > kUnsettled; }
  void begin_frame(std::span<const AutoOutlook> outlook, bool jumped);
  [[nodiscard]] bool fails_trial(std::span<const AutoOutlook> outlook, bool jumped);
  void leave_what_may_not_draw(std::span<const AutoOutlook> outlook);
  void compare(std::span<const AutoOutlook> outlook, bool disturbed);
  void prepare_in_warm_up(std::span<const AutoOutlook> outlook, bool failed);
  [[nodiscard]] AutoChoice explain(std::span<const AutoOutlook> outlook) const;
  void change(int to);
  void begin_trial(int of, std::span<const AutoOutlook> outlook);
  [[nodiscard]] bool may_replace(const AutoTrials::Found& found, int tried,
                                 double drawing_ms) const;
  void end_trial(std::span<const AutoOutlook> outlook);
  [[nodiscard]] bool comparable(double ms, int i, std::span<const AutoOutlook> outlook) const;
  [[nodiscard]] double over_guess(double ms) const;
  void note_calm(Cost& cost);
  void note_less(double& mean_ms, double ms);

  std::vector<AutoCandidate> candidates_;
  std::vector<Cost> costs_;
  double pace_ms_;
  int draws_, prepares_ = -1, drawn_ = -1;
  AutoReason reason_ = AutoReason::begins;
  int since_change_ = 0;
  int warm_ups_ = 0;           // after jumps, since methods were compared
  double recent_changes_ = 0;  // each counts less with each frame
  // How much more what draws takes than its model explains, over all frames: the machine is slower,
  // or in view is what is dear for all methods.
  double slow_ = 1;
  AutoTrials trials_;
  bool tried_in_warm_up_ = false;  // the last trial began while what draws warmed up
  int unsettled_ = 0;              // frames for which what draws has taken much more than it did
  int less_ = 0;                   // frames in a row of what draws that took far less than the mean
  double less_ms_ = 0;             // all of those
  double last_ms_ = 0;             // of what draws
  int disturbed_ = 0;              // frames in a row
  std::vector<double> guesses_, priors_;  // of this frame
};

}  // namespace rilievo
