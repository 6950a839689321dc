#include "rilievo/core/background.h"

#include <tbb/task_arena.h>

#include <condition_variable>
#include <deque>
#include <mutex>
#include <utility>

namespace rilievo {

// ThreadSanitizer knows the mutex, but not TBB: this file is not instrumented there, as
// parallel_for.cpp.
struct Background::State : std::enable_shared_from_this<State> {
  std::mutex mutex;  // held for the queue alone
  std::condition_variable done;
  std::deque<std::function<void()>> tasks;
  bool busy = false;
  tbb::task_arena arena{tbb::task_arena::automatic, 0, tbb::task_arena::priority::low};

  // TBB may still hold its task when the last one of ours is done: it shares the state.
  void begin() {
    arena.enqueue([state = shared_from_this()] { state->run_next(); });
  }
  void run_next() {
    std::function<void()> task;
    {
      const std::lock_guard lock(mutex);
      task = std::move(tasks.front());
      tasks.pop_front();
    }
    task();
    task = nullptr;
    {
      const std::lock_guard lock(mutex);
      if (tasks.empty()) {
        busy = false;
        done.notify_all();
        return;
      }
    }
    begin();  // not at once: whoever needs this thread more takes it in between
  }
};

Background::Background() : state_(std::make_shared<State>()) {}
Background::~Background() { wait(); }

void Background::run(std::function<void()> task) {
  {
    const std::lock_guard lock(state_->mutex);
    state_->tasks.push_back(std::move(task));
    if (std::exchange(state_->busy, true)) return;
  }
  state_->begin();
}

void Background::wait() {
  std::unique_lock lock(state_->mutex);
  state_->done.wait(lock, [this] { return !state_->busy; });
}

}  // namespace rilievo
