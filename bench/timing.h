// The time that work takes.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "rilievo/measure/bench_report.h"

namespace rilievo::bench {

// Milliseconds of one run.
[[nodiscard]] double ms_of(const std::function<void()>& work);
// The median of `runs` runs, in milliseconds, after `warm_ups` that compile shaders and touch
// memory. `prepare` comes before each one and is not timed; it may be empty.
[[nodiscard]] double median_ms(int runs, int warm_ups, const std::function<void()>& work,
                               const std::function<void()>& prepare = {});
// The same of work that OpenGL may still be doing when it returns.
[[nodiscard]] double finished_ms(int runs, int warm_ups, const std::function<void()>& work,
                                 const std::function<void()>& prepare = {});

// Milliseconds of a frame, of each run the median of its frames.
struct RunTimes {
  std::vector<double> runs;
  [[nodiscard]] double least() const;
  [[nodiscard]] double median() const;
};
// Runs of some frames each, the ways of drawing in turn, so that each meets the same load. Each is
// called once before.
[[nodiscard]] std::vector<RunTimes> time_in_turn(int runs, int frames,
                                                 std::span<const std::function<void()>> ways);

// The machine's load over the last minute: what other programs did to the figures.
[[nodiscard]] double machine_load();
// Adds the load before a measurement and now to the report's figures, and a note that explains
// them.
void report_load(double before, BenchReport& report);

}  // namespace rilievo::bench
