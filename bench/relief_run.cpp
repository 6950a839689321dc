// Layered reliefs over a run of turns, as the paper measured them (S4.4, S4.7).
#include <fmt/format.h>

#include <cmath>
#include <glm/gtc/quaternion.hpp>
#include <memory>
#include <random>
#include <vector>

#include "bench/benches.h"
#include "bench/prewarp_ahead.h"
#include "bench/relief_objects.h"
#include "bench/report.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/layered_relief/relief_set.h"
#include "rilievo/layered_relief/splat_layers_test_helpers.h"
#include "rilievo/measure/stats.h"

namespace rilievo::bench {
namespace {

// From where the object is seen at each step: turned by 1.2 degrees about an axis that wanders;
// every 30th time by 40 more.
std::vector<glm::dvec3> directions(int steps) {
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<glm::dvec3> all;
  glm::dquat turn(1, 0, 0, 0);
  glm::dvec3 axis(0.2, 1, 0);
  for (int i = 0; i < steps; ++i) {
    axis = glm::normalize(axis + 0.25 * glm::dvec3{unit(rng), unit(rng), unit(rng)});
    turn = glm::angleAxis((i % 30 == 29 ? 41.2 : 1.2) * 0.0174533, axis) * turn;
    all.push_back(turn * glm::dvec3(0, 0, 1));
  }
  return all;
}

struct Run {
  std::vector<double> warp_ms, frame_ms;
  double warped = 0, drawn = 0;  // samples
  int switches = 0;
};

Camera camera_at(const Box& box, const glm::dvec3& direction, int size) {
  const double away = 3.5 * double(box.radius());
  const glm::dvec3 up = std::abs(direction.y) > 0.95 ? glm::dvec3(1, 0, 0) : glm::dvec3(0, 1, 0);
  return look_at(glm::dvec3(box.center()) + away * direction, glm::dvec3(box.center()), up, 0.62,
                 size, size, 0.1 * away, 10 * away);
}

Run run_over(const ReliefSet& set, const Box& box, int steps, int size, SplattedFrame& last) {
  Run run;
  std::vector<std::unique_ptr<Prewarp>> prewarps;
  PrewarpOptions options;
  options.max_size = 2048;
  for (const LayeredRelief& relief : set.reliefs)
    prewarps.push_back(std::make_unique<Prewarp>(relief, options));
  Prewarped picture;
  int current = -1;
  for (const glm::dvec3& direction : directions(steps)) {
    const Camera camera = camera_at(box, direction, size);
    const glm::dvec3 eye = camera.position();
    const Stopwatch watch;
    const int picked = pick_relief(set, eye, current);
    run.switches += picked != current;
    current = picked;
    if (picked < 0) continue;
    const auto stats = prewarps[std::size_t(picked)]->warp(eye, &camera, picture);
    run.warp_ms.push_back(watch.ms());
    last = empty_frame(camera);
    map_picture(picture, last);
    run.frame_ms.push_back(watch.ms());
    if (!stats) continue;
    run.warped += double(stats->samples_warped), run.drawn += double(stats->samples_drawn);
  }
  return run;
}

// The same frames, but the pre-warp for the next eye, which is known, runs beside the drawing of
// this one. Of a frame: from one picture drawn to the next.
std::vector<double> overlapped_ms(const ReliefSet& set, const Box& box, int steps, int size,
                                  SplattedFrame& last) {
  std::vector<Camera> cameras;
  for (const glm::dvec3& direction : directions(steps))
    cameras.push_back(camera_at(box, direction, size));
  PrewarpOptions options;
  options.max_size = 2048;
  PrewarpAhead ahead(set, options, Overlap::always);
  std::vector<double> ms;
  for (std::size_t i = 0; i < cameras.size(); ++i) {
    const Stopwatch watch;
    ahead.frame(cameras[i], i + 1 < cameras.size() ? &cameras[i + 1] : nullptr,
                [&](const Prewarped& picture) {
                  last = empty_frame(cameras[i]);
                  map_picture(picture, last);
                });
    ms.push_back(watch.ms());
  }
  return ms;
}

}  // namespace

Result<BenchReport> relief_run(const BenchOptions& options) {
  BenchReport report;
  const int steps = options.quick ? 10 : 300, size = options.quick ? 128 : 1024;
  Table table{fmt::format("{} turns, {} x {} pixels, six reliefs of {} texels", steps, size, size,
                          size / 2),
              {"object", "", "warp p50 ms", "p99", "frame p50 ms", "p99", "warped / drawn",
               "switches", "samples", "MB"},
              {}};
  for (const char* name : {"fish", "cube", "fern"}) {
    const Result<ReliefObject> object = relief_object(name);
    if (!object) return object.error();
    const Result<std::vector<glm::dvec3>> six = relief_directions(6);
    ReliefBakeOptions bake;
    bake.size = size / 2;
    bake.ball = paper_ball(*object);
    const Result<ReliefSet> set = bake_reliefs(*object->rays, *six, bake);
    if (!set) return set.error();
    double samples = 0, memory = 0;
    for (const LayeredRelief& relief : set->reliefs)
      samples += double(relief.samples()) / 6, memory += double(bytes(relief)) / 1e6;
    SplattedFrame beside;
    const Box box = world_bounds(*object->scene);
    const Summary overlapped = summarize(overlapped_ms(*set, box, steps, size, beside));
    report.figures.emplace_back(fmt::format("frame_p50_ms_{}_overlapped", name), overlapped.p50);
    report.figures.emplace_back(fmt::format("frame_p99_ms_{}_overlapped", name), overlapped.p99);
    table.rows.push_back({name, "overlapped", "", "", fmt::format("{:.2f}", overlapped.p50),
                          fmt::format("{:.2f}", overlapped.p99), "", "", "", ""});
    SplattedFrame last;
    const Run run = run_over(*set, box, steps, size, last);
    if (last.color != beside.color) return Error{name, "the overlapped run drew another picture"};
    const Summary warp = summarize(run.warp_ms), frame = summarize(run.frame_ms);
    const double again = run.warped / std::max(run.drawn, 1.0);
    table.rows.push_back({name, "", fmt::format("{:.2f}", warp.p50),
                          fmt::format("{:.2f}", warp.p99), fmt::format("{:.2f}", frame.p50),
                          fmt::format("{:.2f}", frame.p99), fmt::format("{:.2f}", again),
                          std::to_string(run.switches), fmt::format("{:.0f}", samples),
                          fmt::format("{:.1f}", memory)});
    report.figures.emplace_back(fmt::format("warp_p50_ms_{}", name), warp.p50);
    report.figures.emplace_back(fmt::format("warp_p99_ms_{}", name), warp.p99);
    report.figures.emplace_back(fmt::format("frame_p50_ms_{}", name), frame.p50);
    report.figures.emplace_back(fmt::format("frame_p99_ms_{}", name), frame.p99);
    report.figures.emplace_back(fmt::format("warped_over_drawn_{}", name), again);
    report.pictures.push_back(
        png_picture(fmt::format("{}, last frame", name), frame_over(last, {0.55f, 0.62f, 0.70f})));
  }
  table.rows.push_back({"the paper's fish, cube", "", "50", "", "67", "", "1.2", "", "140000", ""});
  table.rows.push_back({"the paper's fern", "", "100", "", "111", "", "1.2", "", "250000", ""});
  report.tables = {std::move(table)};
  report.notes = {
      "A turn is 1.2 degrees, every 30th one 41. The frame is the warp, and its picture drawn with "
      "depth by processors. Overlapped: the next eye's warp runs beside the drawing; its last "
      "picture "
      "is the same. The paper's: 300 MHz R12000, InfiniteReality2."};
  return report;
}

}  // namespace rilievo::bench
