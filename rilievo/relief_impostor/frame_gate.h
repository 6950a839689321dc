// When does background work run beside frames that take all cores? (S5.5)
//
// Between frames. The lowest priority of the scheduler does not suffice: a frame's threads that
// wake up may come to share a core while work in the background has another one, and wait some
// milliseconds for each other. The frame's thread says when a frame is drawn, which never waits;
// the work waits meanwhile, at places of its own choosing, a millisecond apart or less.
#pragma once

#include <atomic>
#include <stop_token>

#include "rilievo/core/stopwatch.h"

namespace rilievo {

// One for all frames.
class FrameGate {
 public:
  void begin_frame() { drawing_.store(true, std::memory_order_release); }
  void end_frame() { drawing_.store(false, std::memory_order_release); }
  [[nodiscard]] bool drawing() const { return drawing_.load(std::memory_order_acquire); }

 private:
  std::atomic<bool> drawing_{false};
};

// One piece of work. It waits no more than twice as long as it works, and kFirstWait: where each
// frame follows the last one at once, a third of the time is left to it.
class GivenWay {
 public:
  static constexpr double kFirstWait = 25;  // milliseconds

  explicit GivenWay(const FrameGate& gate) : gate_(gate) {}
  // Waits while a frame is drawn, until `stop` is requested or it has waited enough. Any thread.
  void wait(const std::stop_token& stop);
  // Milliseconds, of all threads.
  [[nodiscard]] double waited_ms() const { return waited_ms_.load(std::memory_order_relaxed); }

 private:
  const FrameGate& gate_;
  const Stopwatch since_;
  std::atomic<double> waited_ms_{0};
};

}  // namespace rilievo
