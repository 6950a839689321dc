// Pictures that replace others, with and without the cross-fade (S1.5).
//
// How much more than the true frames the cache's frames differ from those before them: figures
// pop_max_faded, pop_max_unfaded and pop_ratio, the first over the second.
#include <fmt/format.h>

#include <memory>
#include <utility>

#include "bench/benches.h"
#include "bench/drawn_by.h"
#include "rilievo/compare/compare.h"
#include "rilievo/measure/popping.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo::bench {

Result<BenchReport> pop(const BenchOptions& options) {
  const char* name =
      options.quick ? "builtin:forest?triangles=100000" : "builtin:forest?triangles=1000000";
  const Result<BuiltinScene> built = make_builtin(name);
  if (!built) return built.error();
  const Result<std::unique_ptr<SceneRenderer>> renderer = make_renderer(built->scene, options);
  if (!renderer) return renderer.error();
  CompareOptions compare_options;
  const std::unique_ptr<FrameSource> direct =
      polygon_drawer(built->scene, renderer->get(), compare_options.samples);
  ImageCacheOptions at_once;
  at_once.fade_frames = 1;
  const Result<CachedFrames> faded = make_cache(built->scene, renderer->get(), {}),
                             unfaded = make_cache(built->scene, renderer->get(), at_once);
  if (!faded || !unfaded) return faded ? unfaded.error() : faded.error();

  compare_options.width = options.quick ? 160 : 960;
  compare_options.height = options.quick ? 90 : 540;
  compare_options.frames = options.quick ? 3 : 120;
  compare_options.pop = true;
  compare_options.shown_frames = 2;
  compare_options.progress = options.progress;
  const auto walk = [&](int frame) {
    const double time = frame_time(built->path, frame);
    return WalkFrame{camera_at(built->path, time, compare_options.width, compare_options.height),
                     time};
  };
  const ComparedSource sources[] = {
      {"direct", direct.get()}, {"faded", faded->frames.get()}, {"at once", unfaded->frames.get()}};
  const Result<Report> compared = compare(sources, walk, compare_options);
  if (!compared) return compared.error();

  BenchReport report;
  Table table{
      "FLIP between a frame and the one before it, above the true frames' change, at most",
      {"new pictures", "in a tile", "in a frame", "captures", "mean FLIP against the true frames"},
      {}};
  Plot plot{"FLIP against the true frames", "frame", "FLIP", {}};
  for (const MethodResult& method : {compared->methods[1], compared->methods[2]}) {
    Curve curve{method.name, {}, {}};
    double sum = 0;
    for (std::size_t i = 0; i < method.frames.size(); ++i) {
      curve.x.push_back(double(i));
      curve.y.push_back(method.frames[i].flip);
      sum += method.frames[i].flip;
    }
    table.rows.push_back({method.name, fmt::format("{:.5f}", *method.pop_max),
                          fmt::format("{:.5f}", *method.pop_frame_max),
                          std::to_string(method.captures),
                          fmt::format("{:.4f}", sum / double(method.frames.size()))});
    plot.curves.push_back(std::move(curve));
  }
  const double with = *compared->methods[1].pop_max, without = *compared->methods[2].pop_max;
  report.figures = {{"pop_max_faded", with}, {"pop_max_unfaded", without}};
  if (without > 0) report.figures.emplace_back("pop_ratio", with / without);
  const double frame_with = *compared->methods[1].pop_frame_max,
               frame_without = *compared->methods[2].pop_frame_max;
  report.figures.emplace_back("pop_frame_max_faded", frame_with);
  report.figures.emplace_back("pop_frame_max_unfaded", frame_without);
  if (frame_without > 0) report.figures.emplace_back("pop_frame_ratio", frame_with / frame_without);
  report.tables = {std::move(table)};
  report.plots = {std::move(plot)};
  report.notes = {fmt::format("{}, {} frames of {} x {}, error 1 pixel, drawn by {}.", name,
                              compare_options.frames, compare_options.width, compare_options.height,
                              *renderer ? "OpenGL" : "software"),
                  fmt::format("A tile has {0} x {0} pixels: a picture that pops is a small part "
                              "of the frame.",
                              kPopTile)};
  return report;
}

}  // namespace rilievo::bench
