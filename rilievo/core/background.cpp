#include "rilievo/core/background.h"

#include <tbb/task_arena.h>

#include <algorithm>
#include <condition_variable>
#include <deque>
#include <mutex>
#include <utility>

#include "rilievo/core/happens.h"

namespace rilievo {

struct Background::State {
  std::mutex mutex;  // held for the queue alone
  std::condition_variable done;
  std::deque<std::function<void()>> tasks;
  bool busy = false;
  char handed_over = 0;  // for ThreadSanitizer, which knows the mutex but not TBB
  // Of all threads but the caller's, which TBB does not count as a worker.
  tbb::task_arena arena{std::max(1, tbb::this_task_arena::max_concurrency() - 1), 0,
                        tbb::task_arena::priority::low};

  ~State() { detail::happens_after(handed_over); }

  void run_all() {
    std::unique_lock lock(mutex);
    while (!tasks.empty()) {
      std::function<void()> task = std::move(tasks.front());
      tasks.pop_front();
      lock.unlock();
      task();
      task = nullptr;
      lock.lock();
    }
    busy = false;
    done.notify_all();
  }
};

Background::Background() : state_(std::make_shared<State>()) {}
Background::~Background() {
  wait();
  detail::happens_before(state_->handed_over);
}

void Background::run(std::function<void()> task) {
  {
    const std::lock_guard lock(state_->mutex);
    state_->tasks.push_back(std::move(task));
    if (std::exchange(state_->busy, true)) return;
  }
  // The task shares the state, which must live until TBB is done with the task.
  detail::happens_before(state_->handed_over);
  state_->arena.enqueue([state = state_] {
    detail::happens_after(state->handed_over);
    state->run_all();
    detail::happens_before(state->handed_over);
  });
}

void Background::wait() {
  std::unique_lock lock(state_->mutex);
  state_->done.wait(lock, [this] { return !state_->busy; });
}

}  // namespace rilievo
