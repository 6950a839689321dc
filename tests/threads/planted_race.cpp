// Two pieces of one parallel_for write the same number: what tools/check_threads must find, or it
// finds nothing. With the argument `none` each writes its own, which it must not report.
#include <tbb/global_control.h>

#include <atomic>
#include <cstdio>
#include <cstring>
#include <thread>
#include <vector>

#include "rilievo/core/parallel_for.h"

int main(int count, char** arguments) {
  const bool race = count < 2 || std::strcmp(arguments[1], "none") != 0;
  const tbb::global_control several(tbb::global_control::max_allowed_parallelism, 4);
  constexpr int kPieces = 64;
  std::vector<long> sums(kPieces, 0);
  std::thread::id first = std::this_thread::get_id();
  // Relaxed: it puts the threads in no order.
  std::atomic<bool> by_another = false;
  while (!by_another.load(std::memory_order_relaxed))
    rilievo::parallel_for(0, kPieces, [&](int i) {
      for (int k = 0; k < 1000; ++k) sums[std::size_t(race ? 0 : i)] += k;
      if (std::this_thread::get_id() != first) by_another.store(true, std::memory_order_relaxed);
    });
  long sum = 0;
  for (const long each : sums) sum += each;
  std::printf("%ld\n", sum);
}
