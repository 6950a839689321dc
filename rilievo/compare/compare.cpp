#include "rilievo/compare/compare.h"

#include <algorithm>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "rilievo/gl/context.h"
#include "rilievo/io/jpeg.h"
#include "rilievo/measure/artifacts.h"
#include "rilievo/measure/flip.h"
#include "rilievo/measure/gap_width.h"
#include "rilievo/measure/popping.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/measure/ssim.h"
#include "rilievo/measure/stats.h"
#include "rilievo/measure/visibility.h"

namespace rilievo {
namespace {

// A method while its frames come in.
struct Tally {
  MethodResult result;
  Histogram depth_errors;
  std::int64_t polygons = 0, groups = 0;
  std::map<std::string, std::int64_t> by_kind{{"nailboard", 0}};
  double bound_px = 0, gap_px = 0;
  int over_bound = 0;
  Rgba8Image last;  // frame
  Pop pop;

  void add_stats(const FrameStats& stats) {
    result.captures += stats.captures;
    result.capture_ms += stats.capture_ms;
    result.picture_bytes = std::max(result.picture_bytes, std::uint64_t(stats.picture_bytes));
    polygons += stats.polygons;
    groups += stats.groups;
    for (const auto& [kind, count] : stats.by_kind) by_kind[std::string(kind)] += count;
    bound_px = std::max(bound_px, stats.bound_px.value_or(0));
    gap_px = std::max(gap_px, stats.gap_px);
  }

  // The difference of two frames that are the same need not be measured.
  static FlipSummary flip_of(const Rgba8Image& truth, const Rgba8Image& frame) {
    return truth == frame ? FlipSummary() : summarize_flip(truth, frame);
  }
  static Artifacts artifacts_of(const Rgba8Image& truth, const Rgba8Image& frame) {
    return truth == frame ? Artifacts() : count_artifacts(truth, frame);
  }
  static bool polygons_alone(const FrameStats& stats) {
    return stats.polygons > 0 && stats.groups == 0 &&
           std::all_of(stats.by_kind.begin(), stats.by_kind.end(),
                       [](const auto& kind) { return kind.second == 0; });
  }

  // `color`: the true colours, of `truth` or of more samples.
  void add_frame(const DrawnFrame& truth, const Rgba8Image& color, const DrawnFrame& frame,
                 const BoundLimits& limits) {
    over_bound += !limits.hold(frame.stats);
    const Visibility visibility =
        frame.objects.empty() ? Visibility() : compare_visibility(truth.objects, frame.objects);
    const FlipSummary flip = flip_of(color, frame.color);
    const Artifacts artifacts = artifacts_of(color, frame.color);
    FrameResult& now = result.frames.emplace_back();
    now.frame_ms = frame.frame_ms;
    now.psnr_db = psnr_db(color, frame.color);
    now.ssim = ssim(color, frame.color);
    now.flip = flip.mean, now.flip_p99 = flip.p99;
    now.wrong_visibility = visibility.wrong_share();
    now.uncovered = visibility.uncovered_share();
    now.counted = double(visibility.counted) / double(truth.objects.texels().size());
    if (!frame.eye_z.empty()) now.gap_px = widest_gap_px(truth.objects, truth.eye_z, frame.eye_z);
    now.ghost = artifacts.ghost, now.speckle = artifacts.speckle;
    // Against themselves polygons say nothing; against more samples they do.
    now.pictures = &color != &truth.color || !polygons_alone(frame.stats);
    if (!frame.eye_z.empty())
      add_depth_errors(truth.objects, frame.objects, truth.eye_z, frame.eye_z, depth_errors);
    add_stats(frame.stats);
    if (!frame.stats.decision.method.empty())
      result.decisions.push_back(frame.stats.decision.sentence());
  }

  // FLIP maps between the true frame and the one before it, and between `frame` and the one before
  // it; empty for the first.
  void add_pop(const Image<float>& true_change, const Image<float>& change) {
    if (true_change.empty()) return;
    const Pop now = largest_pop(true_change, change);
    pop = {std::max(pop.frame, now.frame), std::max(pop.tile, now.tile)};
  }
  // `true_last` is the true frame before `truth`; empty for the first.
  void add_change(const Rgba8Image& true_last, const Rgba8Image& truth, const Rgba8Image& frame) {
    if (!true_last.empty())
      result.flicker.push_back(
          truth == frame && true_last == last ? 0 : flicker(true_last, truth, last, frame));
    last = frame;
  }
  // FLIP map from the last frame to this one; empty if there was none.
  [[nodiscard]] Image<float> change_to(const Rgba8Image& frame) const {
    if (last.empty()) return {};
    if (last == frame) return Image<float>(frame.width(), frame.height(), 0.0f);
    return flip_map(last, frame);
  }

  MethodResult finish(bool with_pop) {
    if (with_pop) result.pop_max = pop.tile, result.pop_frame_max = pop.frame;
    result.depth_error_p50 = depth_errors.percentile(0.50);
    result.depth_error_p99 = depth_errors.percentile(0.99);
    if (bound_px > 0) result.bound_px_max = bound_px;
    if (gap_px > 0) result.gap_bound_px_max = gap_px;
    if (!result.over_bound_share)
      result.over_bound_share = double(over_bound) / double(result.frames.size());
    result.drawn_as = {{"polygons", polygons}};
    for (const auto& [kind, count] : by_kind) result.drawn_as.emplace_back(kind, count);
    result.drawn_as.emplace_back("hierarchy", groups);
    return std::move(result);
  }
};

EncodedPicture jpeg(const Rgba8Image& picture) { return {"image/jpeg", encode_jpeg(picture)}; }

Result<DrawTargets> make_targets_of(std::span<const ComparedSource> sources,
                                    const CompareOptions& options) {
  std::vector<FrameSource*> drawing;
  for (const ComparedSource& one : sources)
    if (one.source) drawing.push_back(one.source);
  return DrawTargets::create(drawing, options.width, options.height, options.samples);
}

Report begin_report(const CompareOptions& options, const DrawTargets& targets) {
  Report report;
  report.machine = this_machine();
  report.machine.gl_renderer = targets.with_opengl() ? gl::renderer_name() : "none";
  report.width = options.width;
  report.height = options.height;
  report.antialiasing = std::to_string(options.samples) + " samples a pixel";
  return report;
}

// How many frames of every source fit into the memory.
int block_size(std::size_t sources, const CompareOptions& options) {
  const std::size_t pixel = sizeof(glm::u8vec4) + sizeof(std::uint32_t) + sizeof(float);
  const std::size_t bytes =
      sources * pixel * std::size_t(options.width) * std::size_t(options.height);
  return int(std::clamp<std::size_t>(options.max_bytes / bytes, 1, std::size_t(options.frames)));
}

}  // namespace

Result<Report> compare(std::span<const ComparedSource> sources,
                       const std::function<WalkFrame(int frame)>& walk,
                       const CompareOptions& options) {
  RILIEVO_EXPECTS(!sources.empty() && sources[0].source);
  RILIEVO_EXPECTS_GE(options.frames, 1);
  RILIEVO_EXPECTS_GE(std::min(options.width, options.height), kMinCompareSize);
  const Result<DrawTargets> own = make_targets_of(sources, options);
  if (!own) return own.error();
  const DrawTargets& targets = *own;

  Report report = begin_report(options, targets);
  report.shown = frames_to_show(options.frames, options.shown_frames);

  // Compiles what is compiled late, captures what is captured first.
  std::vector<Tally> tallies(sources.size());
  for (std::size_t s = 0; s < sources.size(); ++s) {
    tallies[s].result.name = sources[s].name;
    for (int i = 0; i < options.warm_up && sources[s].source; ++i) {
      const Result<double> ms = time_frame(*sources[s].source, targets, walk(0));
      if (!ms) return ms.error();
      if (i == 0) tallies[s].result.first_frame_ms = *ms;
      const FrameStats& stats = sources[s].source->stats();
      tallies[s].result.captures += stats.captures;
      tallies[s].result.capture_ms += stats.capture_ms;
    }
  }

  Rgba8Image true_last;  // frame
  const int step = block_size(sources.size(), options);
  for (int first = 0; first < options.frames; first += step) {
    const int end = std::min(first + step, options.frames);
    std::vector<std::vector<DrawnFrame>> drawn(sources.size());
    for (std::size_t s = 0; s < sources.size(); ++s)
      for (int frame = first; frame < end; ++frame) {
        Result<DrawnFrame> one = sources[s].source
                                     ? draw_frame(*sources[s].source, targets, walk(frame))
                                     : sources[s].read(frame);
        if (!one) return one.error();
        drawn[s].push_back(std::move(*one));
      }
    for (int frame = first; frame < end; ++frame) {
      const std::size_t i = std::size_t(frame - first);
      const bool shown = std::binary_search(report.shown.begin(), report.shown.end(), frame);
      const DrawnFrame& truth = drawn[0][i];
      std::optional<Rgba8Image> reference;
      if (options.reference) {
        Result<Rgba8Image> made = options.reference->frame(walk(frame));
        if (!made) return made.error();
        reference = std::move(*made);
      }
      const Rgba8Image& color = reference ? *reference : truth.color;
      if (shown) report.true_pictures.push_back(jpeg(color));
      const Image<float> true_change =
          options.pop && !true_last.empty() ? flip_map(true_last, color) : Image<float>();
      for (std::size_t s = 0; s < sources.size(); ++s) {
        if (options.pop)
          tallies[s].add_pop(true_change, s == 0 && !reference
                                              ? true_change
                                              : tallies[s].change_to(drawn[s][i].color));
        tallies[s].add_change(true_last, color, drawn[s][i].color);
        tallies[s].add_frame(truth, color, drawn[s][i], options.limits);
        if (!shown) continue;
        tallies[s].result.pictures.push_back(jpeg(drawn[s][i].color));
        tallies[s].result.differences.push_back(jpeg(difference_picture(color, drawn[s][i].color)));
      }
      true_last = color;
      if (options.progress) options.progress(frame + 1, options.frames);
    }
  }
  for (Tally& tally : tallies) report.methods.push_back(tally.finish(options.pop));
  return report;
}

Result<Report> compare_in_real_time(std::span<const ComparedSource> sources,
                                    const std::function<WalkFrame(double seconds)>& walk,
                                    const CompareOptions& options,
                                    const RealTimeOptions& real_time) {
  RILIEVO_EXPECTS(!sources.empty());
  const Result<DrawTargets> own = make_targets_of(sources, options);
  if (!own) return own.error();
  const DrawTargets& targets = *own;
  Report report = begin_report(options, targets);
  int done = 0;
  for (const ComparedSource& compared : sources) {
    Result<RealTimeWalk> walked = walk_in_real_time(*compared.source, targets, walk, real_time);
    if (!walked) return walked.error();
    Tally tally;
    for (const auto& [frame, drawn] : walked->kept) {
      Result<DrawnFrame> truth = draw_frame(*sources[0].source, targets, frame);
      if (!truth) return truth.error();
      std::optional<Rgba8Image> reference;
      if (options.reference) {
        Result<Rgba8Image> made = options.reference->frame(frame);
        if (!made) return made.error();
        reference = std::move(*made);
      }
      tally.add_frame(*truth, reference ? *reference : truth->color, drawn, real_time.limits);
    }
    // Of all frames, not of those that were compared.
    MethodResult& result = tally.result;
    result.name = compared.name;
    result.captures = walked->captures, result.capture_ms = walked->capture_ms;
    result.picture_bytes = walked->picture_bytes;
    tally.bound_px = walked->bound_px, tally.gap_px = walked->gap_px;
    result.first_frame_ms = walked->first_frame_ms;
    result.cut_ms = walked->cut_ms;
    result.over_bound_share = walked->over_bound_share;
    result.walked_frames = int(walked->frame_ms.size());
    result.walked_ms = summarize(walked->frame_ms);
    report.methods.push_back(tally.finish(false));
    if (options.progress) options.progress(++done, int(sources.size()));
  }
  report.notes.push_back("The eye moved by the clock: times are of all frames after the first, " +
                         std::to_string(real_time.kept) +
                         " frames of each method, spread evenly over its walk, were compared.");
  return report;
}

}  // namespace rilievo
