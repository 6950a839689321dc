// How long did it take?
#pragma once

#include <chrono>

namespace rilievo {

// Measures wall-clock time since its construction. Work of the GPU counts only after gl::finish().
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
