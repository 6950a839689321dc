#include "rilievo/core/background.h"

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include <atomic>
#include <numeric>
#include <thread>
#include <vector>

#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

TEST(Background, runs_tasks_one_by_one_in_their_order) {
  std::vector<int> order;  // no lock: one task at a time, and each sees what the last one wrote
  {
    Background background;
    for (int i = 0; i < 500; ++i) background.run([&order, i] { order.push_back(i); });
    for (int i = 500; i < 600; ++i) {
      background.run([&order, i] { order.push_back(i); });
      if (i % 7 == 0) {
        background.wait();
        EXPECT_EQ(order.size(), std::size_t(i) + 1);
      }
    }
  }  // waits
  std::vector<int> expected(600);
  std::iota(expected.begin(), expected.end(), 0);
  EXPECT_EQ(order, expected);
}

// The caller must be able to go on, and to use parallel_for, while a task keeps its thread.
TEST(Background, does_not_make_the_caller_wait) {
  std::atomic<bool> go{false};
  Background background;
  std::atomic<int> ran{0};
  background.run([&] {
    while (!go) std::this_thread::yield();
    parallel_for(0, 100, [&](int) { ++ran; });
  });
  int sum = 0;
  for (int round = 0; round < 50; ++round) {
    std::vector<int> pieces(64, 0);
    parallel_for(0, 64, [&](int i) { pieces[std::size_t(i)] = i; });
    sum += std::accumulate(pieces.begin(), pieces.end(), 0);
  }
  EXPECT_EQ(sum, 50 * 63 * 32);
  EXPECT_EQ(ran, 0);
  go = true;
  background.wait();
  EXPECT_EQ(ran, 100);
}

TEST(Background, runs_where_parallel_for_has_one_thread) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism, 1);
  Background background;
  const std::thread::id caller = std::this_thread::get_id();
  std::thread::id worker;
  background.run([&] { worker = std::this_thread::get_id(); });
  background.wait();
  EXPECT_NE(worker, std::thread::id());
  EXPECT_NE(worker, caller);
}

}  // namespace
}  // namespace rilievo
