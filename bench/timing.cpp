#include "bench/timing.h"

#include <algorithm>
#include <cstdlib>

#include "rilievo/core/stopwatch.h"
#include "rilievo/gl/context.h"
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
  return median_of(ms);
}

double finished_ms(int runs, int warm_ups, const std::function<void()>& work,
                   const std::function<void()>& prepare) {
  const auto finished = [&] { work(), gl::finish(); };
  const auto prepared = [&] {
    if (prepare) prepare();
    gl::finish();
  };
  return median_ms(runs, warm_ups, finished, prepared);
}

double RunTimes::least() const { return *std::min_element(runs.begin(), runs.end()); }
double RunTimes::median() const { return median_of(runs); }

std::vector<RunTimes> time_in_turn(int runs, int frames,
                                   std::span<const std::function<void()>> ways) {
  std::vector<RunTimes> times(ways.size());
  for (const auto& way : ways) way();  // compiles shaders, touches memory
  for (int run = 0; run < runs; ++run)
    for (std::size_t i = 0; i < ways.size(); ++i) {
      std::vector<double> ms;
      for (int frame = 0; frame < frames; ++frame) ms.push_back(ms_of(ways[i]));
      times[i].runs.push_back(median_of(ms));
    }
  return times;
}

double machine_load() {
  double now = 0;
  return getloadavg(&now, 1) == 1 ? now : 0;
}

void report_load(double before, BenchReport& report) {
  report.figures.emplace_back("load_before", before);
  report.figures.emplace_back("load_after", machine_load());
  report.notes.emplace_back(
      "The load is the machine's, of one minute: above the number of cores, others took part of "
      "the time.");
}

}  // namespace rilievo::bench
