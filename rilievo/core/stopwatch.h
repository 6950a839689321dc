// Watches: wall-clock time, and processor time.
#pragma once

#include <chrono>
#include <ctime>

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

// Measures the processor time of all threads since its construction, which other programs disturb
// less.
class BusyWatch {
 public:
  // Milliseconds since the start.
  [[nodiscard]] double ms() const { return 1e3 * double(std::clock() - start_) / CLOCKS_PER_SEC; }

 private:
  std::clock_t start_ = std::clock();
};

}  // namespace rilievo
