// Trials: a method draws some frames, to find out what it takes.
//
// A trial begins only where it can be afforded: all of them together may take kShare of all time,
// and two frames more. It ends once its frames say enough, and at once where they take so much that
// more of them are not worth it.
//
// AutoDecision (auto_decision.h) says which method is worth a trial, and what follows from what was
// found. Milliseconds a frame.
#pragma once

#include <optional>
#include <vector>

namespace rilievo {

// What would be tried.
struct TrialOutlook {
  int warm_up = 0;        // AutoCandidate::warm_up
  double likely_ms = 0;   // what it plausibly takes
  bool measured = false;  // it has drawn before
};

// The trials of one sequence of frames.
class AutoTrials {
 public:
  static constexpr double kShare = 0.015;
  // The frames of a trial after the warm-up; and of one that ends within kClose of the time of what
  // draws.
  static constexpr int kFrames = 3, kCloseFrames = 10;
  static constexpr double kClose = 0.15;
  // What warms up for so many frames is dear to return to.
  static constexpr int kWarmsUpLong = 5;
  // A frame that takes so many times the median of the last ones is the work of other programs.
  static constexpr double kMuch = 1.3;

  // `most_warm_up`: of all methods, so that no trial allocates.
  explicit AutoTrials(int most_warm_up);

  // May it be tried, where frames of `free_ms` are no loss and what draws takes `now_ms`? What is
  // likely to be no dearer is no expense, however much others were.
  [[nodiscard]] bool affords(const TrialOutlook& outlook, double free_ms, double now_ms) const;

  // `expected_ms`: what it plausibly takes; 0: unknown.
  void begin(int method, int warm_up, double expected_ms);
  [[nodiscard]] bool goes_on() const { return method_ >= 0; }
  // The one that is tried; -1: none.
  [[nodiscard]] int method() const { return method_; }
  // The next frame was drawn, by what is tried; or by what draws.
  void add(double ms, double free_ms);
  void add_other(double ms) { all_ms_ += ms; }
  // Do the frames say enough?
  [[nodiscard]] bool over(double free_ms, double now_ms) const;

  struct Found {
    double mean_ms = 0;  // without the warm-up
    int frames = 0;      // in that mean
    bool close = false;  // it was hard to tell from what draws
  };
  // Ends it. None: it has drawn nothing.
  [[nodiscard]] std::optional<Found> end();

 private:
  [[nodiscard]] bool hopeless(double free_ms) const;

  int method_ = -1, warm_up_ = 0;
  double expected_ms_ = 0;
  std::vector<double> ms_;
  double all_ms_ = 0, trials_ms_ = 0;  // of all frames; what all trials have cost
};

}  // namespace rilievo
