// The bits of Delta that a nailboard needs (S1.4, figure 5 of [Schaufler 1997]).
//
// Touching and interpenetrating objects, each a nailboard captured from the very eye that sees the
// frame, so that what is wrong is wrong for want of bits.
#include <fmt/format.h>

#include <array>
#include <memory>
#include <utility>
#include <vector>

#include "bench/benches.h"
#include "bench/drawn_by.h"
#include "bench/owned_frames.h"
#include "bench/report.h"
#include "rilievo/compare/compare.h"
#include "rilievo/method/pictures.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo::bench {
namespace {

constexpr std::array kBits = {2, 4, 6, 8, 16};

// The middle of the frame, where things meet, at its own size.
Rgba8Image middle_of(const Rgba8Image& frame) {
  const int width = std::min(frame.width(), 480), height = std::min(frame.height(), 300);
  const int left = (frame.width() - width) / 2, top = (frame.height() - height) / 2;
  Rgba8Image crop(width, height);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) crop(x, y) = frame(left + x, top + y);
  return crop;
}

Result<Rgba8Image> picture_of(FrameSource& source, const WalkFrame& frame,
                              const CompareOptions& options) {
  FrameSource* const sources[] = {&source};
  const Result<DrawTargets> targets =
      DrawTargets::create(sources, options.width, options.height, options.samples);
  if (!targets) return targets.error();
  if (const Result<double> ms = time_frame(source, *targets, frame); !ms) return ms.error();
  return middle_of(targets->of(source).color());
}

// `renderer`: null: software.
Result<std::unique_ptr<FrameSource>> make_pictures(const Scene& scene, SceneRenderer* renderer,
                                                   const PictureFramesOptions& options) {
  std::unique_ptr<Backend> backend = make_backend(scene, renderer, options.samples);
  Result<std::unique_ptr<FrameSource>> made = make_picture_frames(*backend, options);
  if (!made) return made.error();
  return {std::make_unique<OwnedFrames>(std::move(backend), std::move(*made))};
}

}  // namespace

Result<BenchReport> nailboard_bits(const BenchOptions& options) {
  const Result<BuiltinScene> built =
      make_builtin(options.quick ? "builtin:teapots?triangles=20000" : "builtin:teapots");
  if (!built) return built.error();
  const Result<std::unique_ptr<SceneRenderer>> renderer = make_renderer(built->scene, options);
  if (!renderer) return renderer.error();

  // Eyes from all along the path; each frame's pictures are its own.
  CompareOptions compare_options;
  compare_options.width = options.quick ? 160 : 1280;
  compare_options.height = options.quick ? 90 : 720;
  compare_options.frames = options.quick ? 2 : 12;
  compare_options.shown_frames = 2;
  const int apart = frame_count(built->path) / compare_options.frames;
  const auto walk = [&](int frame) {
    const double time = frame_time(built->path, frame * apart);
    return WalkFrame{camera_at(built->path, time, compare_options.width, compare_options.height),
                     time};
  };

  std::vector<std::unique_ptr<FrameSource>> sources;
  std::vector<ComparedSource> compared;
  const auto add = [&](std::string name, std::unique_ptr<FrameSource> source) {
    compared.push_back({std::move(name), source.get()});
    sources.push_back(std::move(source));
  };
  add("32-bit z-buffer", polygon_drawer(built->scene, renderer->get(), compare_options.samples));
  for (const int bits : kBits) {
    PictureFramesOptions pictures;
    pictures.delta_bits = bits;
    pictures.max_angle = 0;      // captured for every frame
    pictures.min_triangles = 0;  // everything is a nailboard
    Result<std::unique_ptr<FrameSource>> made =
        make_pictures(built->scene, renderer->get(), pictures);
    if (!made) return made.error();
    add(std::to_string(bits), std::move(*made));
  }
  compare_options.progress = options.progress;
  const Result<Report> compared_report = compare(compared, walk, compare_options);
  if (!compared_report) return compared_report.error();

  BenchReport report;
  Table table{"Pixels that show the wrong object, percent of those away from boundaries",
              {"bits of Delta", "mean", "worst frame"},
              {}};
  const auto wrong = [&](std::size_t method) {
    double sum = 0, most = 0;
    const auto& frames = compared_report->methods[method].frames;
    for (const FrameResult& frame : frames) {
      sum += frame.wrong_visibility;
      most = std::max(most, frame.wrong_visibility);
    }
    return std::pair(sum / double(frames.size()), most);
  };
  Curve curve{"mean", {}, {}};
  for (std::size_t i = 0; i < kBits.size(); ++i) {
    const auto [mean, most] = wrong(1 + i);
    report.figures.emplace_back(fmt::format("wrong_visibility_{}bit", kBits[i]), mean);
    table.rows.push_back({std::to_string(kBits[i]), fmt::format("{:.4f}", 100 * mean),
                          fmt::format("{:.4f}", 100 * most)});
    curve.x.push_back(kBits[i]);
    curve.y.push_back(100 * mean);
  }
  report.tables = {std::move(table)};
  Plot plot{"Wrong visibility over bits of Delta", "bits", "% of pixels", {std::move(curve)}};
  plot.points = true;
  report.plots = {std::move(plot)};
  for (std::size_t s = 0; s <= kBits.size(); ++s) {
    const Result<Rgba8Image> picture = picture_of(*compared[s].source, walk(0), compare_options);
    if (!picture) return picture.error();
    report.pictures.push_back(
        png_picture(s == 0 ? compared[s].name : compared[s].name + " bits", *picture));
  }
  report.notes = {fmt::format(
      "builtin:teapots, {} frames of {} x {}, every object a nailboard captured anew for every "
      "frame with exact depth (for the eye of the capture, eq. (4) gives the same); pixels within "
      "1 pixel of an object boundary of the true frame are not counted.",
      compare_options.frames, compare_options.width, compare_options.height)};
  return report;
}

}  // namespace rilievo::bench
