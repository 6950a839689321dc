#include <fmt/format.h>

#include "bench/bound.h"
#include "bench/gap.h"

namespace rilievo::bench {

Result<BenchReport> bound(const BenchOptions& options) {
  BoundOptions bound_options;
  GapOptions gap_options;
  if (options.quick) bound_options.cases = gap_options.cases = 100;
  const BoundStats measured = run_bound_benchmark(bound_options);
  bound_options.scale = 0.5;
  const BoundStats halved = run_bound_benchmark(bound_options);
  const GapStats gap = run_gap_benchmark(gap_options);
  gap_options.scale = 0.5;
  const GapStats gap_halved = run_gap_benchmark(gap_options);
  BenchReport report;
  report.figures = {{"cases", measured.cases},
                    {"violations", measured.violations},
                    {"tightness_median", measured.tightness_median},
                    {"violations_of_half_the_bound", halved.violations},
                    {"gap_cases", gap.cases},
                    {"gap_violations", gap.violations},
                    {"gap_tightness_median", gap.tightness_median},
                    {"gap_violations_of_half_the_bound", gap_halved.violations},
                    {"gap_violations_of_the_seen_slab", gap.slab_violations}};
  Table table{"The error bound against what is measured, by object",
              {"object", "cases", "violations", "median of bound / measured"},
              {}};
  for (const BoundStats::OfObject& object : measured.objects)
    table.rows.push_back({object.name, std::to_string(object.cases),
                          std::to_string(object.violations),
                          fmt::format("{:.2f}", object.tightness_median)});
  Table gaps{"What was hidden at capture: the bound of the strip against ray casting, by scene",
             {"scene", "cases", "strips of 1 px or more", "violations", "of the seen slab",
              "median of bound / measured"},
             {}};
  for (const GapStats::OfScene& scene : gap.scenes)
    gaps.rows.push_back({scene.name, std::to_string(scene.cases), std::to_string(scene.seen),
                         std::to_string(scene.violations), std::to_string(scene.slab_violations),
                         fmt::format("{:.2f}", scene.tightness_median)});
  report.tables = {std::move(table), std::move(gaps)};
  report.notes = {"The ratio is taken where the measured error is above 0.25 pixels.",
                  "Half the bound must be violated, or the comparison would prove nothing.",
                  "The strip's ratio is taken where it is at least a pixel wide. The seen slab is "
                  "the depths that the capture saw, without what was hidden."};
  return report;
}

}  // namespace rilievo::bench
