// The cost and the looks of relief impostors (S5.2, S5.9).
#include <fmt/format.h>
#include <tbb/global_control.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <vector>

#include "bench/benches.h"
#include "bench/relief_walk.h"
#include "bench/timing.h"
#include "rilievo/relief_impostor/merge_warps.h"
#include "rilievo/relief_impostor/painted_picture_test_helpers.h"

namespace rilievo::bench {
namespace {

// A ball with waves and rings on it, all of the picture covered but its corners: the paper's 256 x
// 256 texels.
ImpostorPicture waves(int width, int height) {
  return painted_picture(width, height, [&](double u, double v) -> std::optional<Paint> {
    const double r = u * u + v * v;
    if (r >= 1.6) return std::nullopt;
    const bool ring = std::fmod(5 * std::sqrt(r), 1.0) > 0.8;
    const double depth = 0.25 + 0.3 * r + 0.03 * std::sin(20 * u) * std::sin(17 * v) + 0.2 * ring;
    const int x = int((u + 1) * 0.5 * width), y = int((v + 1) * 0.5 * height);
    return Paint{{x * 255 / width, y * 255 / height, ring ? 200 : 40, 255}, depth};
  });
}

// Around the ball, from the picture's own eye.
glm::dvec3 turned_eye(double degrees) {
  const double angle = degrees * 0.017453292519943295;
  return 4.0 * glm::dvec3(std::sin(angle) * 0.9, std::sin(angle) * 0.4, std::cos(angle));
}

// The same, as another eye sees it.
ImpostorPicture seen_from(const ImpostorPicture& picture, const glm::dvec3& eye) {
  ImpostorWarpScratch scratch;
  Prewarped warped;
  Nailboard board;
  if (!warp_impostor(picture, eye, {.max_size = 4096}, scratch, warped)) return {};
  board.geometry = warped.geometry;
  board.geometry.delta_bits = kLevelBits;
  board.color = Rgba8Image(warped.width(), warped.height());
  board.delta = Image<std::uint16_t>(warped.width(), warped.height(), std::uint16_t(kEmptyLevel));
  for (int y = 0; y < warped.height(); ++y)
    for (int x = 0; x < warped.width(); ++x) {
      const auto at = std::size_t(y * warped.width() + x);
      if (warped.delta[at] == kEmptyWarped) continue;
      board.color(x, y) = warped.color[at];
      board.delta(x, y) =
          std::uint16_t(encode_delta(float(decode_delta(warped.delta[at], 16)), kLevelBits));
    }
  return impostor_picture(board);
}

struct WarpTimes {
  double ms = 1e300, copy_ms = 1e300;
};

// The fastest of the runs, each beside a copy of the same bytes, as in the bench `prewarp`: half of
// them read, half written.
template <class Warp>
WarpTimes warp_times(std::size_t bytes, int threads, int runs, const Warp& warp) {
  const tbb::global_control limit(tbb::global_control::max_allowed_parallelism,
                                  std::size_t(threads));
  WarpTimes times;
  std::vector<char> from(bytes / 2, 1), to(from.size(), 2);
  for (int run = 0; run < runs; ++run) {
    times.ms = std::min(times.ms, ms_of(warp));
    times.copy_ms =
        std::min(times.copy_ms, ms_of([&] { std::memcpy(to.data(), from.data(), to.size()); }));
    // What is copied must be used.
    from[std::size_t(run) % from.size()] = to[std::size_t(7 * run) % to.size()];
  }
  return times;
}

std::size_t bytes_of(const ImpostorPicture& picture) {
  return sizeof(WarpTexel) * std::size_t(picture.width()) * std::size_t(picture.height());
}

// A side of a square of as many texels as the largest picture that a frame of 1280 x 720 pixels
// shows: 1024 x 720.
constexpr int kFrameTexels = 858;

// One picture, and two of eyes that are 12 degrees apart, from the middle.
void pair_times(const BenchOptions& options, BenchReport& report) {
  Table table{"One picture, and two that are merged, 12 degrees apart, from the middle",
              {"size", "pictures", "threads", "ms", "times memcpy"},
              {}};
  for (const int size : {256, kFrameTexels}) {
    const ImpostorPicture one = waves(size, size), two = seen_from(one, turned_eye(12));
    for (const bool both : {false, true})
      for (const int threads : {1, 2}) {
        WarpPairScratch scratch;
        Prewarped result;
        const auto warp = [&] {
          if (both)
            (void)warp_pair(one, two, turned_eye(6), {}, scratch, result);
          else
            (void)warp_impostor(one, turned_eye(6), {}, scratch.main, result);
        };
        warp();
        const std::size_t bytes =
            bytes_of(one) + (both ? bytes_of(two) : 0) + 6 * result.color.size();
        const int runs = options.quick ? 3 : 400 * 256 * 256 / (size * size);
        const WarpTimes times = warp_times(bytes, threads, runs, warp);
        const double ratio = times.ms / times.copy_ms;
        table.rows.push_back({fmt::format("{0} x {0}", size), both ? "2" : "1",
                              std::to_string(threads), fmt::format("{:.3f}", times.ms),
                              fmt::format("{:.1f}", ratio)});
        const std::string name = fmt::format("{}_{}{}t", both ? "pair" : "one",
                                             size == kFrameTexels ? "720p_" : "256_", threads);
        report.figures.emplace_back(name + "_ms", times.ms);
        report.figures.emplace_back(name + "_over_memcpy", ratio);
      }
  }
  report.tables.push_back(std::move(table));
}

// One picture that fills a frame of 1280 x 720 pixels.
void frame_times(const BenchOptions& options, BenchReport& report) {
  Table table{"One picture of 1280 x 720 texels", {"threads", "ms", "times memcpy"}, {}};
  const ImpostorPicture picture = waves(1280, 720);
  ImpostorWarpScratch scratch;
  Prewarped result;
  const auto warp = [&] {
    (void)warp_impostor(picture, turned_eye(6), {.max_size = 2048}, scratch, result);
  };
  for (const int threads : {1, 2}) {
    warp();
    const WarpTimes times = warp_times(bytes_of(picture) + 6 * result.color.size(), threads,
                                       options.quick ? 3 : 100, warp);
    const double ratio = times.ms / times.copy_ms;
    table.rows.push_back(
        {std::to_string(threads), fmt::format("{:.3f}", times.ms), fmt::format("{:.1f}", ratio)});
    const std::string name = fmt::format("frame_1280x720_{}t", threads);
    report.figures.emplace_back(name + "_ms", times.ms);
    report.figures.emplace_back(name + "_over_memcpy", ratio);
  }
  report.tables.push_back(std::move(table));
}

}  // namespace

Result<BenchReport> relief(const BenchOptions& options) {
  BenchReport report;
  Table table{"The pre-warp of a relief impostor, holes interpolated (S5.2)",
              {"size", "turned by", "threads", "ms", "Mtexel/s", "times memcpy", "interpolated"},
              {}};
  for (const int size : {256, 512}) {
    const ImpostorPicture picture = waves(size, size);
    for (const double degrees : {0.0, 4.0, 12.0})
      for (const int threads : {1, 2}) {
        const glm::dvec3 eye = turned_eye(degrees);
        const int runs = options.quick ? 3 : 400 * 256 * 256 / (size * size);
        ImpostorWarpScratch scratch;
        Prewarped result;
        const auto counted = warp_impostor(picture, eye, {}, scratch, result);
        const WarpTimes times =
            warp_times(bytes_of(picture) + 6 * result.color.size(), threads, runs,
                       [&] { (void)warp_impostor(picture, eye, {}, scratch, result); });
        const double rate = size * size / times.ms / 1e3;
        const double ratio = times.ms / times.copy_ms;
        if (degrees == 12.0) {
          report.figures.emplace_back(
              fmt::format("prewarp_{}_{}ms", size, threads == 1 ? "" : "2t_"), times.ms);
          report.figures.emplace_back(fmt::format("mtexel_per_s_{}_{}t", size, threads), rate);
          report.figures.emplace_back(fmt::format("memcpy_ratio_{}_{}t", size, threads), ratio);
        }
        table.rows.push_back({fmt::format("{0} x {0}", size), fmt::format("{:.0f}", degrees),
                              std::to_string(threads), fmt::format("{:.3f}", times.ms),
                              fmt::format("{:.0f}", rate), fmt::format("{:.1f}", ratio),
                              fmt::format("{:.1f} %", counted ? 100 * counted->share() : 0.0)});
      }
  }
  table.rows.push_back({"256 x 256", "", "1", "11", "6", "", "the paper's"});
  report.figures.emplace_back("prewarp_256_paper_ms", 11.0);
  report.tables = {std::move(table)};
  pair_times(options, report);
  frame_times(options, report);
  report.notes = {
      "The fastest of the runs; the figures are those of an eye turned by 12 degrees. Mtexel/s: of "
      "the picture. Times memcpy: by one thread, of half as many bytes as the picture (8 a texel) "
      "and the result (6 a texel) have, so that as many are read and written; in turn with the "
      "runs. 858 x 858 texels are as many as 1024 x 720, the largest picture in a frame of 1280 x "
      "720 pixels."};
  if (Result<> walked = relief_walk(options, report); !walked) return walked.error();
  return report;
}

}  // namespace rilievo::bench
