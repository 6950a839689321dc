#include "rilievo/method/auto_trials.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

namespace rilievo {
namespace {

constexpr double kNow = 20;  // what draws takes

// Tries a method whose frames take `ms`, the last one again and again, and says how many it drew.
int frames_of_trial(const std::vector<double>& ms, int warm_up, double expected_ms,
                    AutoTrials& trials, std::optional<AutoTrials::Found>* found = nullptr) {
  trials.begin(3, warm_up, expected_ms);
  EXPECT_EQ(trials.method(), 3);
  int frames = 0;
  while (!trials.over(kNow, kNow)) {
    trials.add(ms[std::min(std::size_t(frames), ms.size() - 1)], kNow);
    ++frames;
    EXPECT_LT(frames, 50);
    if (frames >= 50) break;
  }
  const auto ended = trials.end();
  EXPECT_FALSE(trials.goes_on());
  if (found) *found = ended;
  return frames;
}

int frames_of_trial(const std::vector<double>& ms, int warm_up = 1, double expected_ms = 0) {
  AutoTrials trials(12);
  return frames_of_trial(ms, warm_up, expected_ms, trials);
}

TEST(AutoTrials, what_is_plainly_cheaper_is_known_after_three_frames) {
  EXPECT_EQ(frames_of_trial({30, 10}), 1 + AutoTrials::kFrames);
  EXPECT_EQ(frames_of_trial({10}, 0), AutoTrials::kFrames);
  EXPECT_EQ(frames_of_trial({25, 10}, 12), 12 + AutoTrials::kFrames);
}

TEST(AutoTrials, what_takes_about_the_same_is_looked_at_for_longer) {
  for (const double ms : {18.0, 20.0, 22.0}) {
    AutoTrials trials(12);
    std::optional<AutoTrials::Found> found;
    EXPECT_EQ(frames_of_trial({ms}, 1, 0, trials, &found), 1 + AutoTrials::kCloseFrames);
    ASSERT_TRUE(found);
    EXPECT_TRUE(found->close);
    EXPECT_EQ(found->frames, AutoTrials::kCloseFrames);
  }
}

TEST(AutoTrials, what_takes_much_more_ends_at_once) {
  EXPECT_EQ(frames_of_trial({40}, 0), 1);
  EXPECT_EQ(frames_of_trial({40}, 1), 2);
  // Unless it was expected to be no dearer: one frame may be the work of another program.
  EXPECT_EQ(frames_of_trial({10, 40, 10}, 1, 15), 1 + AutoTrials::kFrames);
  EXPECT_EQ(frames_of_trial({10, 40}, 1, 15), 3);
  // While it warms up for long, half of that is waited for, and more may be much.
  EXPECT_EQ(frames_of_trial({33}, 12), 12 / 2 + 1);
  EXPECT_EQ(frames_of_trial({28, 28, 28, 28, 28, 28, 28, 28, 28, 28, 28, 28, 10}, 12),
            12 + AutoTrials::kFrames);
  // And whatever it takes, no more than five frames are lost.
  EXPECT_EQ(frames_of_trial({200}, 12), 1);
  EXPECT_EQ(frames_of_trial({60}, 12), 3);
}

// The slow twin: the mean of all frames but the largest, each at most 1.3 times their median.
TEST(AutoTrials, a_frame_that_was_disturbed_does_not_count) {
  std::mt19937 random(5);
  for (int trial = 0; trial < 200; ++trial) {
    std::vector<double> ms(1, 50);
    for (int i = 0; i < AutoTrials::kCloseFrames; ++i)
      ms.push_back(18 + 4.0 * double(random()) / 4294967296.0);
    ms[std::size_t(2 + trial % 9)] = 24.9;
    AutoTrials trials(12);
    std::optional<AutoTrials::Found> found;
    const int frames = frames_of_trial(ms, 1, 0, trials, &found);
    ASSERT_TRUE(found);
    std::vector<double> counted(ms.begin() + 1, ms.begin() + frames);
    std::sort(counted.begin(), counted.end());
    const double most = 1.3 * counted[counted.size() / 2];
    double sum = 0;
    for (std::size_t i = 0; i + 1 < counted.size(); ++i) sum += std::min(counted[i], most);
    EXPECT_NEAR(found->mean_ms, sum / double(counted.size() - 1), 1e-9);
    EXPECT_LT(found->mean_ms, 22);
  }
}

TEST(AutoTrials, nothing_was_found_where_nothing_was_drawn) {
  AutoTrials trials(12);
  trials.begin(0, 1, 0);
  EXPECT_FALSE(trials.over(kNow, kNow));
  EXPECT_FALSE(trials.end());
  EXPECT_FALSE(trials.goes_on());
}

// All trials together take kShare of all time, and the time of two frames.
TEST(AutoTrials, only_what_can_be_afforded_begins) {
  AutoTrials trials(12);
  double all_ms = 0, more_ms = 0;
  const TrialOutlook dear{.warm_up = 1, .likely_ms = 24};
  int tried = 0;
  for (int frame = 0; frame < 4000; ++frame) {
    const double expense = (24 - kNow) * (1 + AutoTrials::kFrames);
    EXPECT_EQ(trials.affords(dear, kNow, kNow),
              more_ms + expense <= 2 * kNow + AutoTrials::kShare * all_ms);
    // What is likely to be no dearer is no expense.
    EXPECT_TRUE(trials.affords({.warm_up = 12, .likely_ms = kNow}, kNow, kNow));
    if (trials.affords(dear, kNow, kNow)) {
      ++tried;
      trials.begin(0, 1, 24);
      for (int i = 0; i < 2; ++i) trials.add(26, kNow), all_ms += 26, more_ms += 6;
      EXPECT_TRUE(trials.over(kNow, kNow));
      EXPECT_TRUE(trials.end());
    }
    trials.add_other(kNow), all_ms += kNow;
  }
  EXPECT_LE(more_ms, 2 * kNow + AutoTrials::kShare * all_ms);
  EXPECT_GT(tried, 50);
}

TEST(AutoTrials, to_return_to_what_warms_up_for_long_is_an_expense) {
  AutoTrials trials(12);
  TrialOutlook outlook{.warm_up = 12, .likely_ms = 19, .measured = true};
  EXPECT_FALSE(trials.affords(outlook, kNow, kNow));
  outlook.measured = false;
  EXPECT_TRUE(trials.affords(outlook, kNow, kNow));
  outlook.measured = true, outlook.warm_up = 2;
  EXPECT_TRUE(trials.affords(outlook, kNow, kNow));
}

// As in scan-orbit, whose keyframes take 13 ms: a cache that a rough guess says to take 18, and
// that may take 14, captured in frames of 33 to find out.
TEST(AutoTrials, to_begin_with_what_warms_up_for_long_for_no_likely_gain_is_an_expense) {
  AutoTrials trials(12);
  TrialOutlook outlook{.warm_up = 12, .likely_ms = 1.02 * kNow, .measured = false};
  EXPECT_FALSE(trials.affords(outlook, kNow, kNow));
  // With a pace that it keeps it loses nothing.
  EXPECT_TRUE(trials.affords(outlook, 1.1 * kNow, kNow));
  // After a thousand frames it is a small share of all.
  for (int i = 0; i < 250; ++i) trials.add_other(kNow);
  EXPECT_FALSE(trials.affords(outlook, kNow, kNow));
  for (int i = 0; i < 750; ++i) trials.add_other(kNow);
  EXPECT_TRUE(trials.affords(outlook, kNow, kNow));
}

}  // namespace
}  // namespace rilievo
