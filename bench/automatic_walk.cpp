#include "bench/automatic_walk.h"

#include <memory>
#include <numeric>
#include <random>
#include <span>
#include <utility>

#include "bench/real_scenes.h"
#include "rilievo/compare/drawn_frame.h"
#include "rilievo/compare/reference_frames.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/frame/software/software_backend.h"
#include "rilievo/keyframes/eye_prediction.h"
#include "rilievo/measure/flip.h"
#include "rilievo/measure/popping.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/method/good_enough.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo::bench {
namespace {

constexpr std::size_t kAround = 8;  // frames

// After so many frames a method whose median is so many times the least one's is drawn in one frame
// of so many: it is not the best. Not one whose frames follow from those before: the eye would be
// faster for it.
constexpr int kFramesOfAll = 24, kSeldom = 8;
constexpr double kFarFromBest = 3;

// What draws one of the methods.
struct Drawer {
  std::unique_ptr<SoftwareBackend> backend;
  std::unique_ptr<FrameSource> frames;

  [[nodiscard]] const Rgba8Image& color() const { return frames->software_target()->color(); }
};

// The frame of each method where it is judged.
struct Place {
  WalkFrame frame;
  std::vector<Rgba8Image> colors;
  bool bounded = false;  // auto's was drawn by the cache: its error is as was asked for
};

// Two of auto's frames in a row, of which it is asked whether the second one pops.
struct Step {
  WalkFrame last_frame, frame;
  Rgba8Image last, now;
  bool changed = false, jumped = false;  // the method; the eye
};

// By the rule of method/good_enough.h, of frames of such PSNR.
bool is_good(double db, double direct_db, double cache_db, double allowed_db) {
  const double best_db = std::min(direct_db, kUnseenDb);
  return good_enough(best_db - db, best_db - cache_db, allowed_db);
}

std::vector<bool> drawn_seldom(const std::vector<TimedMethod>& methods) {
  std::vector<double> medians;
  for (const TimedMethod& one : methods) medians.push_back(summarize(one.ms).p50);
  const double least = *std::min_element(medians.begin(), medians.end());
  std::vector<bool> seldom;
  for (std::size_t k = 0; k < methods.size(); ++k)
    seldom.push_back(k > 0 && k != kCacheAt && methods[k].name != "keyframes" &&
                     medians[k] > kFarFromBest * least);
  return seldom;
}

// Draws the walk, and keeps what is judged later.
class Walker {
 public:
  Walker(const Scene& scene, const CameraPath& path, const AutoRun& run, AutoWalk& walk)
      : scene_(scene),
        run_(run),
        walk_(walk),
        path_(there_and_back(path, kLongestWalk)),
        order_(std::size(kAutoMethods)),
        seldom_(std::size(kAutoMethods), false) {
    std::iota(order_.begin(), order_.end(), 0);
  }

  Result<> draw() {
    if (Result<> made = make_all(); !made) return made.error();
    for (int i = 0; i < run_.frames; ++i) {
      if (i == kFramesOfAll) seldom_ = drawn_seldom(walk_.methods);
      if (Result<> drawn = draw_frame(i); !drawn) return drawn.error();
      follow_auto(i);
      if (is_place(i)) keep_place(i);
    }
    return {Done()};
  }

  Result<> judge() {
    SoftwareBackend backend(scene_, kAutoSamples);
    const Result<Method> truth = make_method("direct-raster", {}, backend);
    if (!truth) return truth.error();
    ReferenceFrames reference(*truth->frames, kAutoSamples, {.samples = kAutoReference});
    for (const Place& place : places_)
      if (Result<> judged = judge_place(place, reference); !judged) return judged.error();
    for (const Step& step : steps_)
      if (Result<> judged = judge_step(step, reference); !judged) return judged.error();
    return {Done()};
  }

  // Of auto's first frames after a change, over the median of those around each.
  [[nodiscard]] double worst_change() const {
    const std::vector<double>& ms = walk_.methods[0].ms;
    double worst = 0;
    for (const std::size_t changed : change_frames_) {
      const std::size_t first = changed - std::min(changed, kAround);
      const std::size_t end = std::min(changed + kAround + 1, ms.size());
      const double around = summarize(std::span(ms).subspan(first, end - first)).p50;
      worst = std::max(worst, ms[changed] / around);
    }
    return worst;
  }

 private:
  Result<> make_all() {
    for (const char* name : kAutoMethods) {
      TimedMethod one;
      Drawer drawer{std::make_unique<SoftwareBackend>(scene_, kAutoSamples), nullptr};
      const Stopwatch watch;
      Result<Method> made = make_method(name, run_.method, *drawer.backend);
      if (!made) return made.error();
      drawer.frames = std::move(made->frames);
      one.name = name, one.prepare_ms = watch.ms();
      walk_.methods.push_back(std::move(one)), drawers_.push_back(std::move(drawer));
    }
    return {Done()};
  }

  [[nodiscard]] WalkFrame frame_at(int i) const {
    const double seconds = i / kAutoRefresh, start = path_.keys.front().time;
    return WalkFrame{camera_at(path_, start + seconds, run_.width, run_.height), seconds};
  }
  [[nodiscard]] bool is_place(int i) const { return (i + 1) % run_.place_frames() == 0; }

  Result<> draw_frame(int i) {
    const WalkFrame frame = frame_at(i);
    // In another order each time: what one leaves in the processor's caches, and what it still does
    // on other threads when its frame is drawn, must not always meet the same one.
    std::shuffle(order_.begin(), order_.end(), rng_);
    for (const std::size_t k : order_) {
      if (seldom_[k] && !is_place(i) && i % kSeldom != 0) continue;
      TimedMethod& one = walk_.methods[k];
      const BusyWatch busy;
      const Result<double> ms = time_frame(*drawers_[k].frames, DrawTargets(), frame);
      if (!ms) return ms.error();
      if (i > 0) one.busy_ms.push_back(busy.ms());
      (i == 0 ? one.first_ms : one.ms.emplace_back()) = *ms;
    }
    return {Done()};
  }

  // What auto drew by.
  void follow_auto(int i) {
    const FrameDecision& decision = drawers_[0].frames->stats().decision;
    const Rgba8Image& color = drawers_[0].color();
    const WalkFrame frame = frame_at(i);
    eye_.follow(frame.camera);
    ++walk_.drawn_by[std::string(decision.method)];
    const bool changed = i > 0 && decision.method != last_;
    const bool usual = i > 0 && !changed && i % (run_.frames / kUsualFrames + 1) == 0;
    walk_.changes += changed;
    if (changed) change_frames_.push_back(walk_.methods[0].ms.size() - 1);
    if (changed || usual)
      steps_.push_back({.last_frame = frame_at(i - 1),
                        .frame = frame,
                        .last = last_color_,
                        .now = color,
                        .changed = changed,
                        .jumped = eye_.jumped()});
    last_ = decision.method, last_color_ = color;
  }

  void keep_place(int i) {
    const FrameStats& stats = drawers_[0].frames->stats();
    Place place{.frame = frame_at(i),
                .bounded = stats.decision.method == "cache" && stats.bound_px &&
                           *stats.bound_px <= run_.method.error_px};
    for (const Drawer& one : drawers_) place.colors.push_back(one.color());
    places_.push_back(std::move(place));
  }

  Result<> judge_place(const Place& place, ReferenceFrames& reference) {
    const Result<Rgba8Image> color = reference.frame(place.frame);
    if (!color) return color.error();
    std::vector<double> db;
    for (const Rgba8Image& one : place.colors)
      db.push_back(std::min(psnr_db(*color, one), kMaxPsnrDb));
    for (std::size_t k = 0; k < db.size(); ++k) {
      walk_.methods[k].psnr_db.push_back(db[k]);
      const bool as_asked = k == kCacheAt || (k == 0 && place.bounded);
      walk_.methods[k].bad_places +=
          !as_asked && !is_good(db[k], db[kDirectAt], db[kCacheAt], run_.method.loss_db);
    }
    return {Done()};
  }

  // How much more the frame changed than the true frames did, where it did most.
  Result<> judge_step(const Step& step, ReferenceFrames& reference) {
    const Result<Rgba8Image> true_last = reference.frame(step.last_frame);
    if (!true_last) return true_last.error();
    const Result<Rgba8Image> true_now = reference.frame(step.frame);
    if (!true_now) return true_now.error();
    const double pop =
        largest_pop(flip_map(*true_last, *true_now), flip_map(step.last, step.now)).tile;
    double& most = !step.changed ? walk_.usual_pop : step.jumped ? walk_.cut_pop : walk_.change_pop;
    most = std::max(most, pop);
    return {Done()};
  }

  const Scene& scene_;
  const AutoRun& run_;
  AutoWalk& walk_;
  CameraPath path_;
  std::vector<Drawer> drawers_;
  std::vector<std::size_t> order_;
  std::vector<bool> seldom_;
  std::mt19937 rng_{1};
  EyePrediction eye_;
  std::string last_;
  Rgba8Image last_color_;
  std::vector<std::size_t> change_frames_;  // of TimedMethod::ms
  std::vector<Place> places_;
  std::vector<Step> steps_;
};

// Which of the others is best.
void compare(const AutoRun& run, AutoWalk& walk) {
  const TimedMethod &direct = walk.methods[kDirectAt], &cache = walk.methods[kCacheAt];
  for (std::size_t k = 0; k < walk.methods.size(); ++k) {
    TimedMethod& one = walk.methods[k];
    one.summary = summarize(one.ms), one.busy = summarize(one.busy_ms);
    one.good_in_mean = k == kCacheAt || is_good(one.mean_db(), direct.mean_db(), cache.mean_db(),
                                                run.method.loss_db);
    if (k > 0 && one.good_in_mean &&
        (walk.best_in_mean == 0 || one.summary.p50 < walk.methods[walk.best_in_mean].summary.p50))
      walk.best_in_mean = k;
    if (k == 0 || !one.good()) continue;
    if (walk.best == 0 || one.summary.p50 < walk.methods[walk.best].summary.p50) walk.best = k;
    const auto least = [](double& of, double value) {
      if (of == 0 || value < of) of = value;
    };
    least(walk.best_busy_p50, one.busy.p50);
    least(walk.best_p99, one.summary.p99);
    if (one.prepare_ms <= direct.prepare_ms + kAtOnceMs)
      least(walk.best_p99_at_once, one.summary.p99);
  }
}

}  // namespace

double TimedMethod::mean_db() const {
  return std::accumulate(psnr_db.begin(), psnr_db.end(), 0.0) / double(psnr_db.size());
}

Result<AutoWalk> walk_by_all(const Scene& scene, const CameraPath& path, const AutoRun& run) {
  AutoWalk walk;
  Walker walker(scene, path, run, walk);
  if (Result<> drawn = walker.draw(); !drawn) return drawn.error();
  if (Result<> judged = walker.judge(); !judged) return judged.error();
  walk.change_ms = walker.worst_change();
  compare(run, walk);
  return {std::move(walk)};
}

}  // namespace rilievo::bench
