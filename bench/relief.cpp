#include "bench/relief.h"

#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <vector>

#include "bench/relief_walk.h"
#include "bench/timing.h"
#include "rilievo/relief_impostor/impostor_warp.h"
#include "rilievo/relief_impostor/painted_picture.h"

namespace rilievo::bench {
namespace {

// A ball with waves and rings on it, all of the picture covered but its corners: the paper's 256 x
// 256 texels.
ImpostorPicture waves(int size) {
  return painted_picture(size, [&](double u, double v) -> std::optional<Paint> {
    const double r = u * u + v * v;
    if (r >= 1.6) return std::nullopt;
    const bool ring = std::fmod(5 * std::sqrt(r), 1.0) > 0.8;
    const double depth = 0.25 + 0.3 * r + 0.03 * std::sin(20 * u) * std::sin(17 * v) + 0.2 * ring;
    const int x = int((u + 1) * 0.5 * size), y = int((v + 1) * 0.5 * size);
    return Paint{{x * 255 / size, y * 255 / size, ring ? 200 : 40, 255}, depth};
  });
}

struct WarpTimes {
  double warp_ms = 1e300, copy_ms = 1e300, interpolated = 0;
};

// The fastest of the runs, each beside a copy of the same bytes, as in the bench `prewarp`: half of
// them read, half written.
WarpTimes warp_times(const ImpostorPicture& picture, const glm::dvec3& eye, int threads, int runs) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  std::size_t(threads));
  ImpostorWarpScratch scratch;
  Prewarped result;
  WarpTimes times;
  const auto counted = warp_impostor(picture, eye, {}, scratch, result);
  if (!counted) return times;
  times.interpolated = counted->share();
  const std::size_t texels = std::size_t(picture.width()) * std::size_t(picture.height());
  const std::size_t bytes = sizeof(WarpTexel) * texels + 6 * result.color.size();
  std::vector<char> from(bytes / 2, 1), to(from.size(), 2);
  for (int run = 0; run < runs; ++run) {
    times.warp_ms = std::min(
        times.warp_ms, ms_of([&] { (void)warp_impostor(picture, eye, {}, scratch, result); }));
    times.copy_ms =
        std::min(times.copy_ms, ms_of([&] { std::memcpy(to.data(), from.data(), to.size()); }));
    // What is copied must be used.
    from[std::size_t(run) % from.size()] = to[std::size_t(7 * run) % to.size()];
  }
  return times;
}

}  // namespace

Result<BenchReport> relief(const BenchOptions& options) {
  BenchReport report;
  Table table{"The pre-warp of a relief impostor, holes interpolated (S5.2)",
              {"size", "turned by", "threads", "ms", "Mtexel/s", "times memcpy", "interpolated"},
              {}};
  for (const int size : {256, 512}) {
    const ImpostorPicture picture = waves(size);
    for (const double degrees : {0.0, 4.0, 12.0})
      for (const int threads : {1, 2}) {
        const double angle = degrees * 0.017453292519943295;
        const glm::dvec3 eye =
            4.0 * glm::dvec3(std::sin(angle) * 0.9, std::sin(angle) * 0.4, std::cos(angle));
        const int runs = options.quick ? 3 : 400 * 256 * 256 / (size * size);
        const WarpTimes times = warp_times(picture, eye, threads, runs);
        const double rate = size * size / times.warp_ms / 1e3;
        const double ratio = times.warp_ms / times.copy_ms;
        if (degrees == 12.0) {
          report.figures.emplace_back(
              fmt::format("prewarp_{}_{}ms", size, threads == 1 ? "" : "2t_"), times.warp_ms);
          report.figures.emplace_back(fmt::format("mtexel_per_s_{}_{}t", size, threads), rate);
          report.figures.emplace_back(fmt::format("memcpy_ratio_{}_{}t", size, threads), ratio);
        }
        table.rows.push_back({fmt::format("{0} x {0}", size), fmt::format("{:.0f}", degrees),
                              std::to_string(threads), fmt::format("{:.3f}", times.warp_ms),
                              fmt::format("{:.0f}", rate), fmt::format("{:.1f}", ratio),
                              fmt::format("{:.1f} %", 100 * times.interpolated)});
      }
  }
  table.rows.push_back({"256 x 256", "", "1", "11", "6", "", "the paper's"});
  report.figures.emplace_back("prewarp_256_paper_ms", 11.0);
  report.tables = {std::move(table)};
  report.notes = {
      "The fastest of the runs; the figures are those of an eye turned by 12 degrees. Mtexel/s: of "
      "the picture. Times memcpy: by one thread, of half as many bytes as the picture (8 a texel) "
      "and the result (6 a texel) have, so that as many are read and written; in turn with the "
      "runs."};
  if (Result<> walked = relief_walk(options, report); !walked) return walked.error();
  return report;
}

}  // namespace rilievo::bench
