// Walks along which a decision draws simulated methods.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <random>
#include <vector>

#include "rilievo/method/auto_decision.h"

namespace rilievo {

// A method whose cost is known: what a frame takes, and what a model says of it.
struct Simulated {
  AutoCandidate candidate;
  std::function<double(int frame)> ms;
  double guess = 0;        // times what it takes; 0: no model
  double cold = 1;         // times as much in the frames of its warm-up
  int prepared_after = 0;  // frames of preparing
  bool good = true;
  double prior = 0;  // AutoOutlook::prior_ms
};

// How many times as long as without other programs a frame takes: that frame of the walk, which is
// the n-th one that the method draws.
using Slower = std::function<double(int frame, int method, int nth)>;

struct Walk {
  double auto_ms = 0, trials_ms = 0;
  std::vector<double> frames;
  std::vector<double> each_ms;  // by method, had it drawn all frames
  std::vector<int> drawn;       // frames by each method
  int changes = 0, worst_trial = 0;
};

// Draws `frames` frames by the decision; what is measured is up to `noise` more, now and then much.
inline Walk walk(const std::vector<Simulated>& methods, int first, int frames, double noise,
                 std::uint32_t seed, double pace = 0, const std::vector<int>& jumps = {},
                 const Slower& slower = {}) {
  std::mt19937 random(seed);
  const auto uniform = [&] { return double(random()) / 4294967296.0; };
  std::vector<AutoCandidate> candidates;
  for (const Simulated& one : methods) candidates.push_back(one.candidate);
  AutoDecision decision(candidates, first, pace);
  Walk walk;
  walk.each_ms.assign(methods.size(), 0), walk.drawn.assign(methods.size(), 0);
  std::vector<int> prepared(methods.size()), in_a_row(methods.size());
  int last = first;
  for (int frame = 0; frame < frames; ++frame) {
    std::vector<AutoOutlook> outlook(methods.size());
    for (std::size_t i = 0; i < methods.size(); ++i) {
      outlook[i].ready = prepared[i] >= methods[i].prepared_after;
      outlook[i].preparable = !outlook[i].ready;
      outlook[i].prepare_ms = 2.0 * std::max(0, methods[i].prepared_after - prepared[i]);
      outlook[i].good_enough = methods[i].good;
      outlook[i].guess_ms = methods[i].guess * methods[i].ms(frame);
      outlook[i].prior_ms = methods[i].prior;
      walk.each_ms[i] += methods[i].ms(frame);
    }
    const AutoChoice choice =
        decision.next(outlook, std::find(jumps.begin(), jumps.end(), frame) != jumps.end());
    const auto draws = std::size_t(choice.draws);
    EXPECT_TRUE(outlook[draws].ready);
    double beside = 0;
    if (choice.prepares >= 0) {
      ++prepared[std::size_t(choice.prepares)];
      beside = 2;
    }
    in_a_row[draws] = choice.draws == last ? in_a_row[draws] + 1 : 1;
    double ms = methods[draws].ms(frame);
    if (in_a_row[draws] <= methods[draws].candidate.warm_up) ms *= methods[draws].cold;
    const double more = uniform(), rare = uniform();
    if (slower) ms *= slower(frame, choice.draws, walk.drawn[draws]);
    const double measured = ms * (1 + noise * more) * (rare < 0.01 ? 1.8 : 1) + beside;
    decision.add(measured, beside > 0);
    walk.auto_ms += ms + beside;
    walk.frames.push_back(ms + beside);
    ++walk.drawn[draws];
    walk.changes += choice.draws != last;
    last = choice.draws;
  }
  return walk;
}

inline double regret(const Walk& walk) {
  return walk.auto_ms / *std::min_element(walk.each_ms.begin(), walk.each_ms.end());
}

inline std::function<double(int)> always(double ms) {
  return [ms](int) { return ms; };
}

}  // namespace rilievo
