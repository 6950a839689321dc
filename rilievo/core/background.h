// Work in the background, on the worker threads of parallel_for.
//
// A worker begins when no parallel_for needs it, and then runs all tasks that are queued. Meanwhile
// parallel_for has one worker less: queue little where frames must stay fast. No more threads run
// than there are cores.
#pragma once

#include <functional>
#include <memory>

namespace rilievo {

// Runs tasks one after the other, in their order.
class Background {
 public:
  Background();
  // Waits for all tasks.
  ~Background();

  // Queues a task for another thread, and returns at once. The task can read what was written
  // before, may use parallel_for, and must not throw.
  void run(std::function<void()> task);
  // Returns when all tasks are done. Later code can read what they wrote.
  void wait();

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace rilievo
