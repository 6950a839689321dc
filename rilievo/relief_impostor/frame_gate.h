// When does background work run beside frames that take all cores? (S5.5)
//
// Between frames. The lowest priority of the scheduler does not suffice: threads of a frame that
// wake up may share one core while background work has another, and wait milliseconds for each
// other. The thread that draws says when a frame begins and ends, and never waits. Background work
// calls wait() every millisecond or more often.
#pragma once

#include <atomic>
#include <stop_token>

#include "rilievo/core/stopwatch.h"

namespace rilievo {

// Is a frame being drawn? Shared by the thread that draws and all background work.
class FrameGate {
 public:
  void begin_frame() { drawing_.store(true, std::memory_order_release); }
  void end_frame() { drawing_.store(false, std::memory_order_release); }
  [[nodiscard]] bool drawing() const { return drawing_.load(std::memory_order_acquire); }

 private:
  std::atomic<bool> drawing_{false};
};

// One task in the background, for example a capture. It waits at most kFirstWait and twice the time
// that it has worked, so that a third of the time is left to it where frames have no pauses.
class BackgroundWork {
 public:
  static constexpr double kFirstWait = 25;  // milliseconds

  explicit BackgroundWork(const FrameGate& gate) : gate_(gate) {}
  // Returns when no frame is being drawn, `stop` is requested, or the task has waited as long as it
  // may. Any thread.
  void wait(const std::stop_token& stop);
  // The time spent in wait(), milliseconds, of all threads.
  [[nodiscard]] double waited_ms() const { return waited_ms_.load(std::memory_order_relaxed); }

 private:
  const FrameGate& gate_;
  const Stopwatch since_;
  std::atomic<double> waited_ms_{0};
};

}  // namespace rilievo
