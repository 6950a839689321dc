// How long did it take?
#pragma once

#include <chrono>

namespace rilievo {

// Runs from its making on. Wall clock: what the GPU does counts after gl::finish() only.
class Stopwatch {
 public:
  // Milliseconds since the start.
  [[nodiscard]] double ms() const {
    return std::chrono::duration<double, std::milli>(Clock::now() - start_).count();
  }

 private:
  using Clock = std::chrono::steady_clock;
  Clock::time_point start_ = Clock::now();
};

}  // namespace rilievo
