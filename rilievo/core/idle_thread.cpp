#include "rilievo/core/idle_thread.h"

#include <sys/resource.h>
#include <tbb/task_arena.h>

#include <utility>

#include "rilievo/core/on_this_thread.h"

namespace rilievo {
namespace {

constexpr int kHurryNice = 0;  // as much as a worker

}  // namespace

IdleThread::IdleThread(bool hurry)
    : thread_([this, hurry, threads = threads_of_frames()] { work(hurry, threads); }) {}

IdleThread::~IdleThread() {
  {
    const std::lock_guard lock(mutex_);
    ends_ = true;
  }
  changed_.notify_all();
  thread_.join();
}

void IdleThread::work(bool hurry, int threads_of_frames) {
  // Of this thread alone, as Linux has it. If it is refused, work is as fast as frames' work.
  (void)setpriority(PRIO_PROCESS, 0, hurry ? kHurryNice : kIdleNice);
  const OnThisThread alone(threads_of_frames);
  // Libraries that use TBB themselves, as Embree does, get no other thread either.
  tbb::task_arena one(1);
  std::unique_lock lock(mutex_);
  while (true) {
    changed_.wait(lock, [this] { return ends_ || !tasks_.empty(); });
    if (tasks_.empty()) return;
    std::function<void()> task = std::move(tasks_.front());
    tasks_.pop_front();
    busy_ = true;
    lock.unlock();
    one.execute([&task] { task(); });
    task = nullptr;
    lock.lock();
    busy_ = false;
    changed_.notify_all();
  }
}

void IdleThread::run(std::function<void()> task) {
  {
    const std::lock_guard lock(mutex_);
    tasks_.push_back(std::move(task));
  }
  changed_.notify_all();
}

void IdleThread::wait() {
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [this] { return !busy_ && tasks_.empty(); });
}

}  // namespace rilievo
