// What AutoDecision prepares beside the frames, and when.
#include <gtest/gtest.h>

#include <vector>

#include "rilievo/method/auto_decision.h"
#include "rilievo/method/auto_decision_test_helpers.h"

namespace rilievo {
namespace {

TEST(AutoDecision, what_must_be_prepared_is_prepared_where_it_may_pay) {
  const Walk pays = walk(
      {{{"direct", 0}, always(100)}, {{"keyframes", 2, 2}, always(30), 1, 1, 30}}, 0, 1000, 0.1, 1);
  EXPECT_LT(regret(pays), 1.2);
  EXPECT_GT(pays.drawn[1], 900);
  const Walk loses = walk(
      {{{"direct", 0}, always(20)}, {{"keyframes", 2, 2}, always(30), 1, 1, 30}}, 0, 1000, 0.1, 1);
  EXPECT_EQ(loses.drawn[1], 0);
  EXPECT_LT(loses.auto_ms, 20 * 1000 + 10);  // next to nothing was prepared
}

// Unless a model promises that it is much cheaper: then it is tried once.
TEST(AutoDecision, what_will_hardly_be_good_enough_must_gain_more) {
  const auto prepared = [](double chance, double ms) {
    return walk({{{"direct", 0}, always(30)}, {{"keyframes", 2, 2, chance}, always(ms), 1, 1, 64}},
                0, 300, 0.1, 1)
        .drawn[1];
  };
  EXPECT_GT(prepared(1, 27), 100);
  EXPECT_EQ(prepared(0.02, 29), 0);
  EXPECT_GT(prepared(0.02, 20), 150);
}

TEST(AutoDecision, what_is_prepared_within_two_frames_need_not_gain_much) {
  const auto drawn = [](int prepared_after) {
    return walk({{{"direct", 0}, always(10)}, {{"lod", 2, 1}, always(9), 1.2, 1, prepared_after}},
                0, 300, 0.01, 1)
        .drawn[1];
  };
  EXPECT_GT(drawn(5), 200);
  EXPECT_EQ(drawn(30), 0);
}

// What is plainly the cheapest by the models is begun while the first method warms up.
TEST(AutoDecision, what_is_plainly_cheaper_is_prepared_from_the_first_frame_on) {
  const auto first_prepared = [](double guess) {
    const AutoCandidate candidates[] = {{"direct", 0}, {"cache", 1, 12}, {"lod", 2}};
    AutoDecision decision(candidates, 1);
    for (int frame = 0; frame < 40; ++frame) {
      const AutoOutlook outlook[] = {
          {true, false, true, 70, 0}, {true, false, true, 0, 0}, {false, true, true, guess, 500}};
      const AutoChoice choice = decision.next(outlook);
      if (choice.prepares == 2) return frame;
      decision.add(frame < 12 ? 200 : 60);
    }
    return 40;
  };
  EXPECT_EQ(first_prepared(20), 0);
  EXPECT_GE(first_prepared(42), 12);
}

TEST(AutoDecision, of_what_is_plainly_cheaper_the_likely_is_prepared_first) {
  const std::vector<AutoCandidate> candidates{{"a", 0, 2}, {"sure", 1}, {"doubtful", 1, 0, 0.5}};
  // A little less, and much less.
  for (const double doubtful_ms : {17.0, 2.0}) {
    AutoDecision decision(candidates, 0);
    const std::vector<AutoOutlook> outlook{{.ready = true, .guess_ms = 70},
                                           {.preparable = true, .guess_ms = 20},
                                           {.preparable = true, .guess_ms = doubtful_ms}};
    EXPECT_EQ(decision.next(outlook).prepares, 1) << doubtful_ms;
    const std::vector<AutoOutlook> dear{{.ready = true, .guess_ms = 70},
                                        {.preparable = true, .guess_ms = 60},
                                        {.preparable = true, .guess_ms = doubtful_ms}};
    EXPECT_EQ(AutoDecision(candidates, 0).next(dear).prepares, 2) << doubtful_ms;
  }
}

// One that is a little cheaper but hardly good enough would keep the other from being prepared.
TEST(AutoDecision, of_two_that_must_be_prepared_the_likelier_is_the_first) {
  const AutoCandidate candidates[] = {{"direct", 0}, {"lod", 2, 1}, {"keyframes", 3, 1, 0.03}};
  AutoDecision decision(candidates, 0);
  std::vector<int> prepared;
  for (int frame = 0; frame < 40; ++frame) {
    const auto done = [&](int i) { return std::count(prepared.begin(), prepared.end(), i) >= 10; };
    const AutoOutlook outlook[] = {{true, false, true, 90, 0},
                                   {done(1), !done(1), true, 50, 500},
                                   {done(2), !done(2), true, 45, 500}};
    const AutoChoice choice = decision.next(outlook);
    if (choice.prepares >= 0) prepared.push_back(choice.prepares);
    decision.add(choice.draws == 0 ? 90 : 50);
  }
  ASSERT_GE(prepared.size(), 10u);
  EXPECT_EQ(std::count(prepared.begin(), prepared.begin() + 10, 1), 10);
}

// But not one that gains next to nothing: in the grove rays kept keyframes waiting.
TEST(AutoDecision, what_promises_much_is_prepared_before_what_is_likely_but_dear) {
  const AutoCandidate candidates[] = {{"cache", 1}, {"rays", 0, 1}, {"keyframes", 3, 1, 0.03}};
  AutoDecision decision(candidates, 0);
  for (int frame = 0; frame < 20; ++frame) {
    const AutoOutlook outlook[] = {
        {true, false, true, 0, 0}, {false, true, true, 165, 100}, {false, true, true, 60, 200}};
    const AutoChoice choice = decision.next(outlook);
    if (choice.prepares >= 0) {
      EXPECT_EQ(choice.prepares, 2);
    }
    decision.add(180);
  }
}

// It takes memory bandwidth and a part of a core.
TEST(AutoDecision, while_something_is_tried_nothing_is_prepared) {
  const std::vector<AutoCandidate> candidates{{"direct", 0}, {"lod", 2, 1}, {"keyframes", 3, 1}};
  AutoDecision decision(candidates, 0);
  int tried = 0, prepared = 0;
  for (int frame = 0; frame < 40; ++frame) {
    const std::vector<AutoOutlook> outlook{
        {.ready = true, .guess_ms = 90},
        {.preparable = true, .guess_ms = 40, .prepare_ms = 100},
        {.ready = frame >= 4, .preparable = frame < 4, .guess_ms = 50, .prepare_ms = 1e6}};
    const AutoChoice choice = decision.next(outlook);
    tried += choice.reason == AutoReason::trial;
    prepared += choice.prepares == 1;
    if (choice.reason == AutoReason::trial) {
      EXPECT_EQ(choice.prepares, -1) << frame;
    }
    decision.add(choice.draws == 0 ? 90 : 50);
  }
  EXPECT_GT(tried, 0);
  EXPECT_GT(prepared, 0);
}

// As in scan-orbit: direct drawing and the cache take the same, levels a little less, keyframes six
// tenths. What gains most is prepared first, and as soon as it is known that a trial of direct
// drawing gained nothing: the cache, which warms up again, is known.
TEST(AutoDecision, what_gains_most_is_prepared_first_and_at_once) {
  const AutoCandidate candidates[] = {
      {"direct", 0}, {"cache", 1, 12}, {"lod", 2, 1}, {"keyframes", 3, 1, 0.5, 48}};
  AutoDecision decision(candidates, 1);
  int trial_ended = -1, prepared_in = -1, prepared = -1;
  bool tried = false;
  for (int frame = 0; frame < 80 && prepared < 0; ++frame) {
    const AutoOutlook outlook[] = {{.ready = true, .guess_ms = 11.9},
                                   {.ready = true, .prior_ms = 7.1},
                                   {.preparable = true, .guess_ms = 11.5, .prepare_ms = 107},
                                   {.preparable = true, .guess_ms = 7.7, .prepare_ms = 150}};
    const AutoChoice choice = decision.next(outlook);
    const bool trial = choice.reason == AutoReason::trial;
    if (tried && !trial && trial_ended < 0) trial_ended = frame;
    tried = trial;
    if (choice.prepares >= 0) prepared = choice.prepares, prepared_in = frame;
    decision.add(choice.draws == 0 ? 12.8 : 12.7);
  }
  EXPECT_EQ(prepared, 3);
  EXPECT_GE(trial_ended, 0);
  EXPECT_EQ(prepared_in, trial_ended);
}

TEST(AutoDecision, what_is_prepared_is_not_prepared_again) {
  const AutoCandidate candidates[] = {{"direct", 0}, {"lod", 2, 1}};
  AutoDecision decision(candidates, 0);
  int prepared = 0;
  for (int frame = 0; frame < 100; ++frame) {
    const bool ready = prepared > 0;
    const AutoOutlook outlook[] = {{true, false, true, 70, 0}, {ready, !ready, true, 20, 10}};
    const AutoChoice choice = decision.next(outlook);
    prepared += choice.prepares == 1;
    decision.add(choice.draws == 0 ? 70 : 20);
  }
  EXPECT_EQ(prepared, 1);
}

}  // namespace
}  // namespace rilievo
