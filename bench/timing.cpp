#include "bench/timing.h"

#include <vector>

#include "rilievo/core/stopwatch.h"
#include "rilievo/measure/stats.h"

namespace rilievo::bench {

double ms_of(const std::function<void()>& work) {
  const Stopwatch watch;
  work();
  return watch.ms();
}

double median_ms(int runs, int warm_ups, const std::function<void()>& work,
                 const std::function<void()>& prepare) {
  std::vector<double> ms;
  for (int run = 0; run < runs + warm_ups; ++run) {
    if (prepare) prepare();
    const double took_ms = ms_of(work);
    if (run >= warm_ups) ms.push_back(took_ms);
  }
  return percentile(ms, 0.5);
}

}  // namespace rilievo::bench
