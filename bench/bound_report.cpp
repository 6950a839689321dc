// The error bounds against what is measured and what is drawn: whether they hold.
#include <fmt/format.h>

#include "bench/benches.h"
#include "bench/bound.h"
#include "bench/drawn_bound.h"
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
  DrawnBoundOptions drawn_options;
  drawn_options.progress = options.progress;
  if (options.quick) drawn_options.cases = 500;
  Table drawn_table{"What is drawn against the bound: balls in whole frames of the cache",
                    {"error allowed, px", "cases", "frames", "captures", "moving", "fading",
                     "missing", "violations", "centroid over the bound, most, px",
                     "outline over the bound, most, px", "median of bound / centroid's error"},
                    {}};
  int drawn_violations = 0, drawn_cases = 0;
  for (const double error_px : {1.0, 2.0, 6.0}) {
    drawn_options.error_px = error_px;
    const Result<DrawnBoundStats> run = run_drawn_bound_benchmark(drawn_options);
    if (!run) return run.error();
    drawn_cases += run->cases, drawn_violations += run->violations;
    drawn_table.rows.push_back({fmt::format("{:g}", error_px), std::to_string(run->cases),
                                std::to_string(run->frames), std::to_string(run->captures),
                                std::to_string(run->moving), std::to_string(run->fading),
                                std::to_string(run->missing), std::to_string(run->violations),
                                fmt::format("{:.2f}", run->centroid_excess_px),
                                fmt::format("{:.2f}", run->outline_excess_px),
                                fmt::format("{:.2f}", run->tightness_median)});
  }
  drawn_options.scale = 0.25;
  const Result<DrawnBoundStats> drawn_halved = run_drawn_bound_benchmark(drawn_options);
  if (!drawn_halved) return drawn_halved.error();
  BenchReport report;
  report.figures = {{"cases", measured.cases},
                    {"violations", measured.violations},
                    {"tightness_median", measured.tightness_median},
                    {"violations_of_half_the_bound", halved.violations},
                    {"drawn_cases", drawn_cases},
                    {"drawn_violations", drawn_violations},
                    {"drawn_violations_of_a_quarter", drawn_halved->violations},
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
  report.tables = {std::move(table), std::move(gaps), std::move(drawn_table)};
  report.notes = {
      "The ratio is taken where the measured error is above 0.25 pixels.",
      "Half the bound (of what is drawn, a quarter) must be violated, or the comparison would "
      "prove "
      "nothing.",
      "The strip's ratio is taken where it is at least a pixel wide. The seen slab is "
      "the depths that the capture saw, without what was hidden.",
      fmt::format(
          "What is drawn may exceed the bound by {:.1f} px at its outline, where texels are "
          "as large as pixels, and by {:.1f} px in "
          "its centroid, because identifiers are taken at the centres of pixels and "
          "texels; and by the strip of a ball's far side that its picture lacks: "
          "r (1 - cos a) for a ball of r pixels seen from an angle a beside the capture.",
          outline_slack_px(1), centroid_slack_px(1))};
  return report;
}

}  // namespace rilievo::bench
