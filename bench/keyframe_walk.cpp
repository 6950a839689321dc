#include "bench/keyframe_walk.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <iterator>
#include <memory>
#include <utility>

#include "bench/real_scenes.h"
#include "rilievo/compare/real_time.h"
#include "rilievo/compare/reference_frames.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/measure/artifacts.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/measure/report.h"
#include "rilievo/measure/visibility.h"
#include "rilievo/method/method.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo::bench {
namespace {

// Neighbours whose depths differ by a larger share lie on two surfaces.
constexpr double kSilhouette = 0.03;

// Keeps what each frame consisted of.
class Watched final : public FrameSource {
 public:
  explicit Watched(KeyframeFrames& frames) : frames_(frames) {}

  Result<> draw(const Camera& camera, double time) override {
    Result<> drawn = frames_.draw(camera, time);
    if (drawn) shares.push_back(frames_.shares());
    return drawn;
  }
  Result<> draw_objects() override {
    live.push_back(frames_.live_share());
    return frames_.draw_objects();
  }
  [[nodiscard]] const SoftwareTarget* software_target() const override {
    return frames_.software_target();
  }
  [[nodiscard]] const FrameStats& stats() const override { return frames_.stats(); }

  std::vector<KeyframeShares> shares;
  std::vector<double> live;  // shares of the frames that were compared

 private:
  KeyframeFrames& frames_;
};

double median_of_shares(const std::vector<KeyframeShares>& shares, double KeyframeShares::*field) {
  std::vector<double> values;
  for (const KeyframeShares& one : shares) values.push_back(one.*field);
  return median_of(values);
}

void add_shares(const Watched& watched, KeyframeWalk& walk) {
  // The first frame makes the first keyframe.
  const std::vector<KeyframeShares> all(watched.shares.begin() + 1, watched.shares.end());
  walk.polygons_ms = median_of_shares(all, &KeyframeShares::polygons_ms);
  walk.warp_ms = median_of_shares(all, &KeyframeShares::warp_ms);
  walk.fill_ms = median_of_shares(all, &KeyframeShares::fill_ms);
  walk.tiles_ms = median_of_shares(all, &KeyframeShares::tiles_ms);
  walk.keyframe_ms = median_of_shares(all, &KeyframeShares::keyframe_ms);
  for (const KeyframeShares& one : all) {
    walk.filled_share += one.filled / double(all.size());
    walk.filled_share_max = std::max(walk.filled_share_max, one.filled);
    walk.keyframes += one.completed, walk.coarse += one.coarse;
  }
  for (const double share : watched.live) walk.live_share += share / double(watched.live.size());
}

int square_of(const glm::u8vec4& a, const glm::u8vec4& b) {
  int sum = 0;
  for (int c = 0; c < 3; ++c) sum += (int(a[c]) - int(b[c])) * (int(a[c]) - int(b[c]));
  return sum;
}

// Is a neighbour of the pixel on another surface?
bool at_silhouette(const Image<float>& eye_z, int x, int y) {
  const float here = eye_z(x, y);
  for (int j = std::max(y - 1, 0); j <= std::min(y + 1, eye_z.height() - 1); ++j)
    for (int i = std::max(x - 1, 0); i <= std::min(x + 1, eye_z.width() - 1); ++i) {
      const float there = eye_z(i, j);
      // Written so that infinities differ from numbers and not from each other.
      if (there != here && !(std::abs(there - here) <= kSilhouette * std::min(there, here)))
        return true;
    }
  return false;
}

// Squared differences: all, at silhouettes, and of pixels of a wrong object elsewhere.
struct Losses {
  double all = 0, edges = 0, wrong = 0;
};

void add_losses(const DrawnFrame& truth, const Rgba8Image& color, const DrawnFrame& shown,
                Losses& losses) {
  for (int y = 0; y < color.height(); ++y)
    for (int x = 0; x < color.width(); ++x) {
      const int square = square_of(color(x, y), shown.color(x, y));
      losses.all += square;
      if (at_silhouette(truth.eye_z, x, y))
        losses.edges += square;
      else if (truth.objects(x, y) != shown.objects(x, y))
        losses.wrong += square;
    }
}

// A way to draw that does not depend on the frames before.
struct Direct {
  const char* name;
  std::unique_ptr<FrameSource> frames;
  std::vector<double> ms, busy_ms;
  double psnr_sum = 0, flicker_sum = 0;
  Rgba8Image before;
};

struct TimedFrame {
  double ms, busy_ms;
};
Result<TimedFrame> time_both(FrameSource& source, const WalkFrame& frame) {
  const BusyWatch busy;
  const Result<double> ms = time_frame(source, DrawTargets(), frame);
  if (!ms) return ms.error();
  return {TimedFrame{*ms, busy.ms()}};
}

Result<std::vector<Direct>> make_direct(SoftwareBackend& backend, bool all) {
  std::vector<Direct> made;
  for (const char* name : {"direct-raster", "direct-rays", "lod"}) {
    if (!all && !made.empty()) break;
    Result<Method> method = make_method(name, {}, backend);
    if (!method) return method.error();
    made.push_back({name, std::move(method->frames)});
  }
  return {std::move(made)};
}

// The same view, with samples a quarter of a pixel beside: as far off as those of a picture that
// is drawn again are.
WalkFrame beside(const WalkFrame& frame) {
  WalkFrame moved = frame;
  ImageWindow& w = moved.camera.window;
  const double x = (w.right - w.left) / frame.camera.width / 4,
               y = (w.top - w.bottom) / frame.camera.height / 4;
  w = {w.left + x, w.right + x, w.bottom + y, w.top + y};
  return moved;
}

// What the compared frames ought to show, and what they show.
Result<> compare_frames(const RealTimeWalk& walked, ReferenceFrames& reference,
                        std::vector<Direct>& rivals, KeyframeWalk& walk) {
  std::vector<double> psnr;
  Losses losses;
  Rgba8Image true_before, before;
  Visibility all, all_beside;
  int pairs = 0;
  for (std::size_t i = 0; i < walked.kept.size(); ++i) {
    const auto& [frame, shown] = walked.kept[i];
    Result<Rgba8Image> color = reference.frame(frame);
    if (!color) return color.error();
    Result<DrawnFrame> truth = draw_frame(*rivals[0].frames, DrawTargets(), frame);
    if (!truth) return truth.error();
    const Result<DrawnFrame> moved = draw_frame(*rivals[0].frames, DrawTargets(), beside(frame));
    if (!moved) return moved.error();
    psnr.push_back(std::min(psnr_db(*color, shown.color), kMaxPsnrDb));
    const Visibility seen = compare_visibility(truth->objects, shown.objects);
    all.counted += seen.counted, all.wrong += seen.wrong;
    const Visibility of_beside = compare_visibility(truth->objects, moved->objects);
    all_beside.counted += of_beside.counted, all_beside.wrong += of_beside.wrong;
    all.counted_objects += seen.counted_objects, all.uncovered += seen.uncovered;
    walk.wrong_share_max = std::max(walk.wrong_share_max, seen.wrong_share());
    walk.missing += count_missing_objects(truth->objects, shown.objects);
    add_losses(*truth, *color, shown, losses);
    const bool second = i % 2 == 1;
    pairs += second;
    if (second) walk.shimmer += flicker(true_before, *color, before, shown.color);
    for (Direct& rival : rivals) {
      const Result<TimedFrame> timed = time_both(*rival.frames, frame);
      if (!timed) return timed.error();
      rival.ms.push_back(timed->ms), rival.busy_ms.push_back(timed->busy_ms);
      Rgba8Image drawn = rival.frames->software_target()->color();
      rival.psnr_sum += std::min(psnr_db(*color, drawn), kMaxPsnrDb);
      if (second) rival.flicker_sum += flicker(true_before, *color, rival.before, drawn);
      rival.before = std::move(drawn);
    }
    if (i + 1 == walked.kept.size()) walk.truth = *color, walk.shown = shown.color;
    true_before = std::move(*color), before = shown.color;
  }
  walk.psnr_db = summarize(psnr);
  walk.wrong_share_direct = all_beside.wrong_share();
  walk.wrong_share = all.wrong_share(), walk.uncovered_share = all.uncovered_share();
  walk.shimmer /= std::max(pairs, 1);
  if (losses.all > 0)
    walk.lost_at_edges = losses.edges / losses.all, walk.lost_as_wrong = losses.wrong / losses.all;
  for (const Direct& rival : rivals)
    walk.rivals.push_back({rival.name, median_of(rival.ms), median_of(rival.busy_ms),
                           rival.psnr_sum / double(walked.kept.size()),
                           rival.flicker_sum / std::max(pairs, 1)});
  return Done{};
}

// What the cache shows depends on the frames before: it walks by itself.
Result<KeyframeRival> walk_by_cache(SoftwareBackend& backend,
                                    const std::function<WalkFrame(double)>& at,
                                    RealTimeOptions options, ReferenceFrames& reference) {
  Result<Method> cache = make_method("cache", {.max_spike = kInteractiveSpike}, backend);
  if (!cache) return cache.error();
  options.in_a_row = 1;
  const Result<RealTimeWalk> walked = walk_in_real_time(*cache->frames, {}, at, options);
  if (!walked) return walked.error();
  KeyframeRival rival;
  rival.name = "cache";
  rival.p50_ms = median_of(walked->frame_ms), rival.busy_p50_ms = median_of(walked->busy_ms);
  for (const auto& [frame, shown] : walked->kept) {
    const Result<Rgba8Image> color = reference.frame(frame);
    if (!color) return color.error();
    rival.psnr_db +=
        std::min(psnr_db(*color, shown.color), kMaxPsnrDb) / double(walked->kept.size());
  }
  return {std::move(rival)};
}

}  // namespace

const KeyframeRival& KeyframeWalk::fastest_as_good() const {
  const KeyframeRival* best = nullptr;
  for (const KeyframeRival& rival : rivals)
    if (rival.psnr_db >= psnr_db.mean && (!best || rival.p50_ms < best->p50_ms)) best = &rival;
  if (best) return *best;
  return *std::max_element(rivals.begin(), rivals.end(),
                           [](const auto& a, const auto& b) { return a.psnr_db < b.psnr_db; });
}

Result<KeyframeWalk> walk_by_keyframes(SoftwareBackend& backend, const CameraPath& path,
                                       const KeyframeWalkOptions& options) {
  Result<std::unique_ptr<KeyframeFrames>> frames =
      KeyframeFrames::create(backend.scene(), options.keyframes);
  if (!frames) return frames.error();
  Result<std::vector<Direct>> rivals = make_direct(backend, !options.each_frame);
  if (!rivals) return rivals.error();

  const CameraPath endless = there_and_back(path, kLongestWalk);
  const double start = endless.keys.front().time;
  const auto at = [&](double seconds) {
    return WalkFrame{camera_at(endless, start + seconds, options.width, options.height), seconds};
  };
  RealTimeOptions real_time;
  real_time.seconds = options.seconds;
  real_time.kept = options.places, real_time.in_a_row = 2;
  real_time.cuts = cuts_of(endless);
  real_time.each_frame = options.each_frame;
  KeyframeWalk walk;
  Watched watched(**frames);
  const Result<RealTimeWalk> walked = walk_in_real_time(watched, {}, at, real_time);
  if (!walked) return walked.error();
  walk.frames = int(walked->frame_ms.size());
  walk.first_frame_ms = walked->first_frame_ms;
  walk.frame_ms = summarize(walked->frame_ms);
  walk.busy_p50_ms = median_of(walked->busy_ms);
  add_shares(watched, walk);

  // Not one of the rivals: other sizes are other memory.
  const Result<Method> true_frames = make_method("direct-raster", {}, backend);
  if (!true_frames) return true_frames.error();
  ReferenceOptions true_options{.samples = options.reference};
  if (options.each_frame)
    true_options.folder = options.reference_folder, true_options.scene = options.scene;
  ReferenceFrames reference(*true_frames->frames, options.keyframes.samples, true_options);
  // What a first frame makes is not timed.
  for (Direct& rival : *rivals)
    if (Result<double> ms = time_frame(*rival.frames, DrawTargets(), at(0)); !ms) return ms.error();
  if (Result<> done = compare_frames(*walked, reference, *rivals, walk); !done) return done.error();

  if (options.each_frame) return {std::move(walk)};
  Result<KeyframeRival> cache = walk_by_cache(backend, at, real_time, reference);
  if (!cache) return cache.error();
  walk.rivals.push_back(std::move(*cache));
  return {std::move(walk)};
}

}  // namespace rilievo::bench
