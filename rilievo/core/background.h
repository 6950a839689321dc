// How does work run beside what a thread does, by the same workers?
//
// On a thread of parallel_for, from when it has nothing else to do until all tasks are done. So no
// more threads run than there are cores, and whoever wants frames to stay fast gives it little.
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

  // Has the task run later, on another thread; does not wait. The task can read what was written
  // before, may use parallel_for, and must not throw.
  void run(std::function<void()> task);
  // Returns when all tasks are done. Later code can read what they wrote.
  void wait();

 private:
  struct State;
  std::shared_ptr<State> state_;
};

}  // namespace rilievo
