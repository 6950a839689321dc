#include "rilievo/core/idle_thread.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <tbb/task_arena.h>

#include <atomic>
#include <numeric>
#include <set>
#include <thread>
#include <vector>

#include "rilievo/core/on_this_thread.h"
#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

TEST(IdleThread, runs_tasks_one_by_one_in_their_order) {
  std::vector<int> order;  // no lock: one task at a time, and each sees what the last one wrote
  {
    IdleThread idle;
    for (int i = 0; i < 500; ++i) idle.run([&order, i] { order.push_back(i); });
    for (int i = 500; i < 600; ++i) {
      idle.run([&order, i] { order.push_back(i); });
      if (i % 7 == 0) {
        idle.wait();
        EXPECT_EQ(order.size(), std::size_t(i) + 1);
      }
    }
  }  // waits
  std::vector<int> expected(600);
  std::iota(expected.begin(), expected.end(), 0);
  EXPECT_EQ(order, expected);
}

TEST(IdleThread, works_alone_and_last) {
  const int before = getpriority(PRIO_PROCESS, 0);
  IdleThread idle;
  std::set<std::thread::id> threads;  // no lock: there is one thread
  int priority = 0;
  idle.run([&] {
    parallel_for(0, 1000, [&](int) { threads.insert(std::this_thread::get_id()); });
    priority = getpriority(PRIO_PROCESS, 0);
  });
  idle.wait();
  EXPECT_EQ(threads.size(), 1u);
  EXPECT_FALSE(threads.contains(std::this_thread::get_id()));
  EXPECT_EQ(priority, 19);
  EXPECT_EQ(getpriority(PRIO_PROCESS, 0), before);  // the caller's is its own
}

// What it measures of its own work is compared with what frames take.
TEST(IdleThread, knows_on_how_many_threads_frames_run) {
  tbb::task_arena host(3);
  host.execute([] {
    IdleThread idle;
    int calls = 0, frames = 0;
    bool beside = false;
    idle.run([&] {
      calls = threads_of_calls(), frames = threads_of_frames(), beside = beside_frames();
    });
    idle.wait();
    EXPECT_EQ(calls, 1);
    EXPECT_EQ(frames, threads_of_calls());
    EXPECT_TRUE(beside);
    EXPECT_FALSE(beside_frames());
  });
}

// The caller must be able to go on, and to use parallel_for, while a task runs.
TEST(IdleThread, does_not_make_the_caller_wait) {
  std::atomic<bool> go{false};
  IdleThread idle;
  bool ran = false;
  idle.run([&] {
    while (!go) std::this_thread::yield();
    ran = true;
  });
  std::atomic<int> sum{0};
  for (int round = 0; round < 50; ++round) parallel_for(0, 64, [&](int i) { sum += i; });
  EXPECT_EQ(sum, 50 * 63 * 32);
  go = true;
  idle.wait();
  EXPECT_TRUE(ran);
}

}  // namespace
}  // namespace rilievo
