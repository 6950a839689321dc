#include "rilievo/capture/store/group_pieces.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <random>

namespace rilievo {
namespace {

std::vector<double> some_times(std::mt19937& random, int count) {
  std::uniform_real_distribution<double> time(1.2, 5.8);
  std::vector<double> seconds;
  for (int i = 0; i < count; ++i) seconds.push_back(time(random));
  return seconds;
}

void expect_every_picture_once(const PieceGroups& groups, const std::vector<double>& seconds) {
  std::vector<int> all;
  for (std::size_t p = 0; p < groups.pictures.size(); ++p) {
    double sum = 0;
    for (const int picture : groups.pictures[p]) {
      all.push_back(picture);
      sum += seconds[std::size_t(picture)];
    }
    // Sums of the same numbers in another order.
    EXPECT_NEAR(groups.seconds[p], sum, 1e-9);
  }
  std::sort(all.begin(), all.end());
  std::vector<int> each(seconds.size());
  std::iota(each.begin(), each.end(), 0);
  EXPECT_EQ(all, each);
}

// The longest piece of the best of all groupings.
double best_of_all(const std::vector<double>& seconds, std::vector<double>& loads, std::size_t at) {
  if (at == seconds.size()) return *std::max_element(loads.begin(), loads.end());
  double best = 1e300;
  for (double& load : loads) {
    load += seconds[at];
    best = std::min(best, best_of_all(seconds, loads, at + 1));
    load -= seconds[at];
  }
  return best;
}

TEST(GroupPieces, the_longest_piece_is_at_most_a_third_longer_than_the_best_of_all_groupings) {
  std::mt19937 random(3);
  for (int round = 0; round < 20; ++round) {
    const std::vector<double> seconds = some_times(random, 8);
    for (const int count : {1, 2, 3}) {
      const PieceGroups groups = group_pieces(seconds, count);
      ASSERT_EQ(int(groups.pictures.size()), count);
      expect_every_picture_once(groups, seconds);
      std::vector<double> loads(static_cast<std::size_t>(count), 0.0);
      const double best = best_of_all(seconds, loads, 0);
      // Graham's bound of this rule.
      EXPECT_LE(*std::max_element(groups.seconds.begin(), groups.seconds.end()),
                (4.0 / 3 - 1.0 / (3 * count)) * best + 1e-9);
    }
  }
}

TEST(GroupPieces, are_even_to_a_fifth_and_no_larger_number_would_be) {
  std::mt19937 random(5);
  for (const int count : {1, 2, 7, 36, 100}) {
    const std::vector<double> seconds = some_times(random, count);
    const PieceGroups groups = even_pieces(seconds, 0.2);
    expect_every_picture_once(groups, seconds);
    EXPECT_GE(groups.least, 0.8);
    EXPECT_LE(groups.most, 1.2);
    for (int more = int(groups.pictures.size()) + 1; more <= count; ++more) {
      const PieceGroups finer = group_pieces(seconds, more);
      EXPECT_TRUE(finer.least < 0.8 || finer.most > 1.2) << more;
    }
  }
  // Pictures that take equally long are a piece each.
  EXPECT_EQ(even_pieces(std::vector<double>(24, 3.0), 0.2).pictures.size(), 24u);
}

}  // namespace
}  // namespace rilievo
