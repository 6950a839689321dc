#include "rilievo/core/parallel_for.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>
#include <tbb/task_arena.h>

#include <random>
#include <stdexcept>
#include <vector>

#include "rilievo/core/on_this_thread.h"

namespace rilievo {
namespace {

TEST(ParallelFor, runs_each_piece_once) {
  std::mt19937 rng(1);
  for (int round = 0; round < 50; ++round) {
    const int first = int(rng() % 20) - 10, last = first + int(rng() % 300) - 20;
    std::vector<int> runs(320, 0);
    parallel_for(first, last, [&](int i) { ++runs[std::size_t(i - first)]; });
    for (int k = 0; k < 320; ++k) ASSERT_EQ(runs[std::size_t(k)], k < last - first ? 1 : 0);
  }
}

TEST(ParallelFor, pieces_see_what_came_before_and_are_seen_by_what_comes_after) {
  std::vector<std::size_t> numbers(1000, 0);
  for (std::size_t round = 1; round < 50; ++round) {
    parallel_for(std::size_t(0), numbers.size(),
                 [&](std::size_t i) { numbers[i] += round * (i + 1); });
    // Another shape of pieces, so that other threads have what was written.
    std::vector<std::size_t> sums(10, 0);
    parallel_for(0, 10, [&](int part) {
      for (std::size_t i = std::size_t(part); i < numbers.size(); i += 10)
        sums[std::size_t(part)] += numbers[i];
    });
    std::size_t sum = 0;
    for (const std::size_t part : sums) sum += part;
    ASSERT_EQ(sum, round * (round + 1) / 2 * (1000 * 1001 / 2));
  }
}

TEST(ParallelFor, may_be_nested) {
  std::vector<int> runs(400, 0);
  parallel_for(
      0, 20, [&](int y) { parallel_for(0, 20, [&](int x) { ++runs[std::size_t(20 * y + x)]; }); });
  for (const int run : runs) EXPECT_EQ(run, 1);
}

TEST(ParallelFor, tells_on_how_many_threads_it_runs_whatever_limits_them) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 3);
  const auto in_arena = [](int slots) {
    tbb::task_arena arena(slots);
    return arena.execute([] { return threads_of_calls(); });
  };
  EXPECT_EQ(in_arena(1), 1);
  EXPECT_EQ(in_arena(2), 2);
  EXPECT_EQ(in_arena(5), 3);
  {
    const tbb::global_control one(tbb::global_control::max_allowed_parallelism, 1);
    EXPECT_EQ(in_arena(5), 1);
  }
  const OnThisThread alone;
  EXPECT_EQ(threads_of_calls(), 1);
}

TEST(ParallelFor, lets_an_exception_out) {
  const auto fail = [](int i) {
    if (i == 17) throw std::runtime_error("17");
  };
  EXPECT_THROW(parallel_for(0, 100, fail), std::runtime_error);
}

}  // namespace
}  // namespace rilievo
