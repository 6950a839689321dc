// A thread for work beside frames that must not slow them.
//
// Background takes one of the workers of parallel_for, so that frames have one core less. This is a
// thread of its own with the lowest priority of the system: it gets what frames leave, which is a
// good part of a core where they do not fill all of them, and next to nothing where they do. One in
// a hurry has the priority of all others.
#pragma once

#include <condition_variable>
#include <deque>
#include <functional>
#include <mutex>
#include <thread>

namespace rilievo {

// The nice value of work beside frames, by threads and by programs. The scheduler gives it a weight
// of 15, and a frame's worker 1024.
inline constexpr int kIdleNice = 19;

// Runs tasks one after the other, in their order.
class IdleThread {
 public:
  explicit IdleThread(bool hurry = false);
  // Waits for all tasks.
  ~IdleThread();
  IdleThread(const IdleThread&) = delete;
  IdleThread& operator=(const IdleThread&) = delete;

  // Queues a task, and returns at once. The task can read what was written before, may use
  // parallel_for, which then runs on this thread alone, and must not throw.
  void run(std::function<void()> task);
  // Returns when all tasks are done. Later code can read what they wrote.
  void wait();

 private:
  void work(bool hurry, int threads_of_frames);

  std::mutex mutex_;  // held for the queue alone
  std::condition_variable changed_;
  std::deque<std::function<void()>> tasks_;
  bool busy_ = false, ends_ = false;
  std::thread thread_;  // last: it uses the others
};

}  // namespace rilievo
