#include "rilievo/method/dear_frames.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace rilievo {
namespace {

constexpr double kMost = 26, kDear = 60;

// The slow twin: looks for the gaps before each frame in all frames before it.
double mean_of_all(const std::vector<bool>& dear) {
  double mean = 0;
  for (int last = 0; last < int(dear.size()); ++last) {
    std::vector<int> gaps;  // from the last row of dear frames back
    int usual = 0;
    bool any = false;
    for (int i = last; i >= 0; --i) {
      if (!dear[std::size_t(i)]) {
        ++usual;
        continue;
      }
      if (any && usual > 0) gaps.push_back(usual);
      any = true, usual = 0;
    }
    const bool often =
        gaps.size() >= 2 && gaps[0] < DearFrames::kOften && gaps[1] < DearFrames::kOften;
    mean += ((dear[std::size_t(last)] && often ? kDear - kMost : 0) - mean) * DearFrames::kNewest;
  }
  return mean;
}

TEST(DearFrames, count_where_two_gaps_before_them_are_short) {
  std::mt19937 random(3);
  for (int walk = 0; walk < 100; ++walk) {
    DearFrames frames;
    std::vector<bool> dear;
    for (int i = 0; i < 100; ++i) {
      dear.push_back(random() % unsigned(3 + walk % 20) == 0);
      frames.add(dear.back() ? kDear : 20, kMost);
    }
    EXPECT_NEAR(frames.mean_ms(), mean_of_all(dear), 1e-9) << walk;
  }
}

TEST(DearFrames, every_fourth_adds_a_quarter) {
  DearFrames frames;
  for (int i = 0; i < 400; ++i) frames.add(i % 4 == 3 ? kDear : 20, kMost);
  // Its last frame is a dear one, of which 0.03 are in the mean.
  EXPECT_NEAR(frames.mean_ms(), (kDear - kMost) / 4, 0.03 * (kDear - kMost));
}

TEST(DearFrames, two_rows_of_slow_frames_add_nothing) {
  DearFrames frames;
  for (int i = 0; i < 60; ++i) frames.add((i >= 20 && i < 30) || i == 35 ? kDear : 20, kMost);
  EXPECT_EQ(frames.mean_ms(), 0);
}

}  // namespace
}  // namespace rilievo
