// A watch of one thread's processor time.
#pragma once

#include <time.h>

namespace rilievo {

// Measures the processor time of this thread since its construction.
class ThreadWatch {
 public:
  // Milliseconds since the start.
  [[nodiscard]] double ms() const { return now() - start_; }

 private:
  static double now() {
    timespec at{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &at);
    return 1e3 * double(at.tv_sec) + 1e-6 * double(at.tv_nsec);
  }
  double start_ = now();
};

}  // namespace rilievo
