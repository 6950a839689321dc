// The cost of the pre-warp of layered reliefs (S4.6 to S4.8).
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <vector>

#include "bench/benches.h"
#include "bench/relief_objects.h"
#include "bench/timing.h"
#include "rilievo/layered_relief/prewarp.h"

namespace rilievo::bench {
namespace {

struct Measured {
  double warp_ms = 1e300, copy_ms = 1e300;
  double samples = 0;  // of the relief
  double bytes = 0;    // of the samples, and of the picture
  double again = 0;    // samples warped over samples drawn
};

// The fastest of `runs`, each beside a copy of the same bytes: one reads and writes half of them
// each, as the warp would if it read as much as it writes. A machine that does other things besides
// makes both slower, but not for good.
Measured measure(const LayeredRelief& relief, const PrewarpOptions& options, const glm::dvec3& eye,
                 int threads, int runs) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  std::size_t(threads));
  Measured m;
  Prewarp prewarp(relief, options);
  Prewarped result;
  const auto stats = prewarp.warp(eye, nullptr, result);
  if (!stats) return m;
  m.samples = double(relief.samples());
  m.again = double(stats->samples_warped) / double(std::max<std::size_t>(stats->samples_drawn, 1));
  m.bytes = 8 * m.samples + 6 * double(result.color.size());
  std::vector<char> from(std::size_t(m.bytes / 2), 1), to(from.size(), 2);
  for (int run = 0; run < runs; ++run) {
    m.warp_ms = std::min(m.warp_ms, ms_of([&] { (void)prewarp.warp(eye, nullptr, result); }));
    m.copy_ms = std::min(m.copy_ms, ms_of([&] { std::memcpy(to.data(), from.data(), to.size()); }));
    // What is copied must be used.
    from[std::size_t(run) % from.size()] = to[std::size_t(7 * run) % to.size()];
  }
  return m;
}

}  // namespace

Result<BenchReport> prewarp(const BenchOptions& options) {
  BenchReport report;
  Table table{
      "Layered reliefs of the fern, seen from 20 degrees beside their directions",
      {"size", "splat", "threads", "samples", "ms", "M samples/s", "times memcpy", "warped again"},
      {}};
  Result<ReliefObject> fern = relief_object("fern");
  if (!fern) return fern.error();
  int done = 0;
  for (const int size : {256, 512, 1024}) {
    if (options.quick && size > 512) break;
    const int runs = options.quick ? 3 : std::max(12, 300 * 256 * 256 / (size * size));
    const Result<LayeredDepthImage> layers = relief_layers(*fern, size, {0, 0.26, 0.97});
    if (!layers) return layers.error();
    const Result<LayeredRelief> relief = build_layered_relief(*layers);
    if (!relief) return relief.error();
    // Three times the object's size away.
    const ReliefFrame frame = relief->frame();
    const double away = 3.0 * size * glm::length(frame.a);
    const glm::dvec3 eye =
        frame.world(0.5 * size + 0.34 * away / glm::length(frame.a), 0.5 * size, -0.94 * away);
    for (const auto& [splat, name] :
         {std::pair(Splat::nearest, "nearest"), std::pair(Splat::rectangle, "splat")})
      for (const int threads : {1, 2}) {
        if (options.progress) options.progress(done++, 12);
        PrewarpOptions warp;
        warp.splat = splat;
        warp.max_size = 4096;
        const Measured m = measure(*relief, warp, eye, threads, runs);
        const double rate = m.samples / m.warp_ms / 1e3, ratio = m.warp_ms / m.copy_ms;
        report.figures.emplace_back(fmt::format("msamples_per_s_{}_{}_{}t", name, size, threads),
                                    rate);
        report.figures.emplace_back(fmt::format("memcpy_ratio_{}_{}_{}t", name, size, threads),
                                    ratio);
        table.rows.push_back({fmt::format("{0} x {0}", size), name, std::to_string(threads),
                              fmt::format("{:.0f}", m.samples), fmt::format("{:.3f}", m.warp_ms),
                              fmt::format("{:.0f}", rate), fmt::format("{:.2f}", ratio),
                              fmt::format("{:.2f}", m.again)});
      }
  }
  table.rows.push_back({"512 x 512", "the paper's", "1", "250000", "100", "2.8", "", "1.20"});
  report.figures.emplace_back("msamples_per_s_paper", 2.8);
  report.tables = {std::move(table)};
  report.notes = {
      "The fastest of the runs. Times memcpy: by one thread, of half as many bytes as the samples "
      "(8 each) and the picture (6 a texel) have, so that as many are read and written; in turn "
      "with the runs. The picture's planes are emptied, drawn and written out within the time.",
      "The paper's: 250 000 samples at 10 Hz and 140 000 at 20 Hz, 300 MHz R12000."};
  return report;
}

}  // namespace rilievo::bench
