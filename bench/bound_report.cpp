#include <fmt/format.h>

#include "bench/bound.h"

namespace rilievo::bench {

Result<BenchReport> bound(const BenchOptions& options) {
  BoundOptions bound_options;
  if (options.quick) bound_options.cases = 100;
  const BoundFigures measured = run_bound_benchmark(bound_options);
  bound_options.scale = 0.5;
  const BoundFigures halved = run_bound_benchmark(bound_options);
  BenchReport report;
  report.figures = {{"cases", measured.cases},
                    {"violations", measured.violations},
                    {"tightness_median", measured.tightness_median},
                    {"violations_of_half_the_bound", halved.violations}};
  Table table{"The error bound against what is measured, by object",
              {"object", "cases", "violations", "median of bound / measured"},
              {}};
  for (const BoundFigures::OfObject& object : measured.objects)
    table.rows.push_back({object.name, std::to_string(object.cases),
                          std::to_string(object.violations),
                          fmt::format("{:.2f}", object.tightness_median)});
  report.tables = {std::move(table)};
  report.notes = {"The ratio is taken where the measured error is above 0.25 pixels.",
                  "Half the bound must be violated, or the comparison would prove nothing."};
  return report;
}

}  // namespace rilievo::bench
