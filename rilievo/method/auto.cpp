#include "rilievo/method/auto.h"

#include <algorithm>
#include <atomic>
#include <glm/glm.hpp>
#include <optional>
#include <thread>
#include <utility>

#include "rilievo/core/expects.h"
#include "rilievo/core/idle_thread.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/frame/software/software_frames.h"
#include "rilievo/method/auto_decision.h"
#include "rilievo/method/auto_keyframes.h"
#include "rilievo/method/auto_levels.h"
#include "rilievo/method/cached.h"
#include "rilievo/method/direct_or_cached.h"
#include "rilievo/method/frame_fade.h"
#include "rilievo/method/good_enough.h"
#include "rilievo/render/rays/ray_visibility.h"

namespace rilievo {
namespace {

enum Methods { kDirect, kCache, kRays, kLevels, kKeyframes, kMethods };

// Frames of the cache after a change until it has the pictures that it wants.
constexpr int kCacheWarmsUp = 12;
// The first frames of what has its own memory are slower.
constexpr int kWarmsUp = 1;
// Keyframes are good enough in about half of the walks that were measured (bench/results/auto.md).
constexpr double kKeyframesChance = 0.5;
// Until there are three: those that began are filled more where the eye leaves the second one.
constexpr int kKeyframesDwell = 48;
constexpr AutoCandidate kCandidates[] = {
    {"direct", 0, 0},
    {"cache", 1, kCacheWarmsUp},
    {"rays", 0, kWarmsUp},
    {"lod", 2, kWarmsUp},
    {"keyframes", 3, kWarmsUp, kKeyframesChance, kKeyframesDwell}};
// Keyframes begin where direct drawing takes so many times as long, by counts: along flights 3
// to 6. Nothing is counted where its model is below the second.
constexpr double kKeyframesPay = 2.4, kKeyframesMayPay = 1.3;
// The cache's share of direct drawing, while it was not drawn: 0.3 to 0.5 along flights, and 0.7 to
// 0.9 indoors.
constexpr double kCacheOfDirect = 0.6;
// What is in view is cheap until direct drawing takes so many times what pixels alone take.
constexpr double kNotCheap = 1.25;
// What preparing takes for each triangle of the scene's meshes, ms: rays, levels.
constexpr double kRaysTriangleMs = 5e-4, kLevelsTriangleMs = 0.9e-3;
// The share of it that frames lose, which leave the thread that prepares what they do not use.
constexpr double kOfFrames = 0.2;
// What is expected to take less than this share of what draws is prepared in a hurry: frames lose
// all the time that preparing takes, for a short time.
constexpr double kHurry = AutoDecision::kPlainlyWorth;
// One frame in so many looks at the scene's load, unless the eye jumps.
constexpr int kLookFrames = 8;
// The time of a frame that goes into keyframes, if none is asked for; and the parts that the first
// two are made in.
constexpr double kKeyframeMs = 8;
constexpr int kFirstKeyframes = 64;
// Keyframes that no frame was drawn from for so many frames are of elsewhere; and those that nobody
// wanted are made again after so many.
constexpr int kKeyframesLast = 8, kKeyframesAgain = 120;
// Levels of detail leave about so many triangles for a pixel of an object's bounds, and so many of
// an object at least.
constexpr double kLevelTriangles = 2, kLeastLevel = 300;
// One frame in so many of keyframes is looked at, once it is known how good they are; and what was
// not good enough is looked at again after so many frames.
constexpr int kLossFrames = 4, kLooksAgain = 600;
// Levels are as good, or as bad, in most places.
constexpr int kLossFramesOfLevels = 16, kLooksAgainAtLevels = 3600;
// So many times as many pixels of each frame are looked at until the loss is known: a trial is a
// few frames. Of larger meshes the rays' tree takes too much memory.
constexpr int kLossesOfTrial = 4;
constexpr std::uint64_t kMostForLoss = 2'000'000;
// The share of a frame in how slow the machine is.
constexpr double kNewestSlowness = 0.05;
// And between which it is taken to lie: a frame that shows next to nothing, or
// triangles behind others, says little.
constexpr double kFastest = 0.6, kSlowest = 10;
// How far off models are taken to be, at most, by a frame that was drawn beside the others.
constexpr double kMostOff = 5;
// The share of a frame in how far off the model of polygons is.
constexpr double kNewestOff = 0.2;
// With OpenGL frames overlap: one in so many is waited for, to be timed.
constexpr int kTimedFrames = 8;

std::uint64_t triangles_of_meshes(const Scene& scene) {
  std::uint64_t count = 0;
  for (const Mesh& mesh : scene.meshes) count += mesh.indices.size() / 3;
  return count;
}

// An object of so many triangles in view.
void add_object(const Camera& camera, const Box& bounds, double triangles, FrameLoad& load) {
  load.triangles += triangles;
  const double radius = double(bounds.radius());
  const double way = glm::length(glm::dvec3(bounds.center()) - camera.position());
  const double f = camera.width / (camera.window.right - camera.window.left);
  const double across = f * radius / std::max(way - radius, camera.z_near);
  const double pixels = std::min(3 * across * across, load.pixels);
  // Of large meshes no finer levels are made (auto_levels.h).
  const double most = std::min(kLevelTriangles * pixels, FrameLoad::kFew * load.pixels);
  load.level_triangles += std::min(triangles, std::max(most, kLeastLevel));
}

// What is made on another thread, while frames are drawn.
struct Prepared {
  Result<std::unique_ptr<RayVisibility>> rays{Error{}};
  AutoLevels levels;
  std::unique_ptr<KeyframeFrames> keyframes;
  bool failed = false;
  ShownFrame shown;  // what it is compared with
  Audition found;
};

// How far what is prepared is.
enum class Preparing { made, shown, looked_at };

class AutoFrames final : public FrameSource {
 public:
  static Result<std::unique_ptr<AutoFrames>> create(const MethodOptions& options, Backend& backend);

  Result<> draw(const Camera& camera, double time) override;
  Result<> draw_objects() override;
  [[nodiscard]] const SoftwareTarget* software_target() const override { return shown_; }
  [[nodiscard]] const FrameStats& stats() const override { return stats_; }
  [[nodiscard]] std::vector<DepthImage> read_pictures() const override {
    return active_->read_pictures();
  }
  void follow(const MethodOptions& options);
  // What is made beside the frames waits for the eye.
  ~AutoFrames() override { shared_eye_.end(); }

 private:
  AutoFrames(const MethodOptions& options, Backend& backend)
      : options_(options),
        backend_(backend),
        threads_(options.by_clock ? int(std::max(1u, std::thread::hardware_concurrency())) : 2),
        triangles_(count_triangles(backend.scene())),
        meshes_triangles_(triangles_of_meshes(backend.scene())) {}

  Result<> begin(const Camera& camera, double time);
  Result<bool> keyframes_pay(const Camera& camera, double time);
  Result<> begin_keyframes_here(const Camera& camera, double time);
  Result<> begin_keyframes_ahead(double time);
  [[nodiscard]] Result<std::unique_ptr<KeyframeFrames>> make_keyframes(const Scene& scene) const;
  void look(const Camera& camera);
  void measure_load(const Camera& camera);
  [[nodiscard]] bool in_a_hurry(double guess_ms) const;
  [[nodiscard]] bool good_enough(int method);
  void learn_direct(double ms);
  void measure_loss(const Camera& camera, const AutoChoice& choice);
  void prepare(int method, int goes_on = 0);
  void fade(const Camera& camera);
  void show(const Camera& camera, double time, int drawn_by);
  void look_at_prepared();
  Result<> adopt();

  MethodOptions options_;
  Backend& backend_;
  int threads_;  // by counts as on the machine of FrameLoad, so that all machines draw the same
  std::uint64_t triangles_, meshes_triangles_;
  bool only_direct_ = true, caches_ = false;  // does what may draw?
  bool cheap_ = false;  // what is in view: there is nothing that the cache could gain
  bool bends_ = false, masked_ = false, moves_ = false;
  int width_ = 0, height_ = 0;
  std::optional<AutoDecision> decision_;
  EyePrediction eye_;
  std::vector<AutoOutlook> outlook_;
  std::vector<std::uint32_t> in_view_;
  FrameLoad load_;  // of the last look

  DirectOrCached* shared_chooser_ = nullptr;       // of frames_[kDirect]
  std::unique_ptr<FrameSource> frames_[kMethods];  // kCache: none, they are kDirect's
  KeyframeFrames* keyframes_ = nullptr;            // of frames_[kKeyframes]
  int keyframes_seen_ = 0;   // the last frame that they drew, or were prepared for
  int keyframes_again_ = 0;  // the first frame in which they may be prepared again
  AutoLevels levels_;        // of frames_[kLevels]
  FrameSource* active_ = nullptr;
  FrameFade fade_;                         // from another method's frames
  const SoftwareTarget* shown_ = nullptr;  // the last frame; null: no software drew it
  Camera shown_camera_;
  FrameStats stats_;
  bool failed_[kMethods] = {};

  int preparing_ = -1;
  Preparing stage_ = Preparing::made;  // of preparing_: what it waits for
  struct Loss {
    std::optional<double> db;  // none: not known
    int seen_in = 0;           // the last frame that the method drew
  } loss_[kMethods];
  double off_[kMethods] = {1, 1, 1, 1, 1};  // times as much as its model says
  std::optional<double> cache_loss_;        // none: not known
  std::unique_ptr<FrameLoss> losses_;       // of the other thread, while something is prepared
  SharedEye shared_eye_;
  std::atomic<bool> prepared_{false};
  Prepared made_;
  bool begins_with_keyframes_ = false;  // until the frame after begun_in_
  int begun_in_ = 0;
  double begun_ms_ = 0;  // of the frame that direct drawing drew to find out
  int frame_ = 0, counted_frames_ = 0, direct_frames_ = 0, drawn_by_ = kDirect;
  double slowness_ = 1;  // times as slow as the machine of FrameLoad
  bool hurries_ = false;
  std::optional<IdleThread> beside_;  // last: it ends first
};

Result<std::unique_ptr<AutoFrames>> AutoFrames::create(const MethodOptions& options,
                                                       Backend& backend) {
  std::unique_ptr<AutoFrames> made(new AutoFrames(options, backend));
  auto chooser =
      std::make_unique<DirectOrCached>(backend, cache_options(options, backend.samples()));
  made->shared_chooser_ = chooser.get();
  for (const Material& material : backend.scene().materials)
    made->masked_ = made->masked_ || material.alpha_mode == AlphaMode::mask;
  for (const Object& object : backend.scene().objects) made->moves_ = made->moves_ || object.moving;
  made->bends_ = backend.deformations() && !backend.deformations()->meshes.empty();
  Result<std::unique_ptr<FrameSource>> frames{Error{}};
  if (made->bends_) {
    // As direct-raster: OpenGL's polygons do not bend.
    Result<SoftwareBackend*> software = backend.software();
    if (!software) return software.error();
    frames = backend.present(std::make_unique<SoftwareFrames>(**software, std::move(chooser)));
  } else {
    frames = backend.make_frames(std::move(chooser));
  }
  if (!frames) return frames.error();
  made->frames_[kDirect] = std::move(*frames);
  made->active_ = made->frames_[kDirect].get();
  made->shown_ = made->active_->software_target();
  return made;
}

// Before the first frame, and when the frame's size changes.
Result<> AutoFrames::begin(const Camera& camera, double time) {
  width_ = camera.width, height_ = camera.height;
  const FrameLoad load{double(triangles_), double(camera.width) * camera.height, 0, threads_};
  caches_ = !load.few();
  // Costs that are counted are those of the cache and of direct drawing.
  only_direct_ = bends_ || load.fits() || !(caches_ || options_.by_clock);
  begins_with_keyframes_ = cheap_ = false;
  if (only_direct_) {
    decision_.reset();
    return Done{};
  }
  const double pace_ms = options_.fps > 0 ? 1000 / options_.fps : 0;
  outlook_.assign(kMethods, {});
  if (options_.by_clock && active_->software_target()) fade_.end(), fade_.reserve(width_, height_);
  measure_load(camera);
  const Result<bool> pay = keyframes_pay(camera, time);
  if (!pay) return pay.error();
  begins_with_keyframes_ = *pay, begun_in_ = frame_;
  // To try the cache later is dear: it captures for several frames. Direct drawing is tried at any
  // time.
  decision_.emplace(kCandidates, caches_ && !cheap_ && !begins_with_keyframes_ ? kCache : kDirect,
                    pace_ms);
  return Done{};
}

// Does direct drawing take so long that keyframes are worth waiting for? Draws the frame, whose
// work is counted: times of a first frame say little.
Result<bool> AutoFrames::keyframes_pay(const Camera& camera, double time) {
  if (!options_.by_clock || !caches_ || failed_[kKeyframes] || meshes_triangles_ > kMostForLoss ||
      backend_.drawn_by() != DrawnBy::software || preparing_ >= 0)
    return false;
  const auto pay = [&](double times, double direct_ms) {
    return direct_ms >= times * (load_.keyframes_ms() + FrameLoad::kKeyframesOfDirect * direct_ms);
  };
  if (!pay(kKeyframesMayPay, load_.direct_ms())) return false;
  shared_chooser_->use_cache(false);
  const Stopwatch watch;
  if (Result<> drawn = frames_[kDirect]->draw(camera, time); !drawn) return drawn.error();
  const double counted_ms = shared_chooser_->counted_ms();
  // It touched memory for the first time.
  begun_ms_ = std::min(watch.ms(), slowness_ * counted_ms);
  learn_direct(slowness_ * counted_ms);
  cheap_ = counted_ms < load_.pixels_ms();
  const bool keeps_pace =
      options_.fps > 0 && counted_ms < AutoDecision::kKeepsPace * 1000 / options_.fps;
  return !keeps_pace && pay(kKeyframesPay, counted_ms);
}

// After the frame that begins: makes its keyframe.
Result<> AutoFrames::begin_keyframes_here(const Camera& camera, double time) {
  if (!keyframes_) {
    Result<SoftwareBackend*> software = backend_.software();
    if (!software) return software.error();
    Result<std::unique_ptr<KeyframeFrames>> made = make_keyframes((*software)->scene());
    failed_[kKeyframes] = !made;
    if (made) keyframes_ = made->get(), frames_[kKeyframes] = std::move(*made);
  }
  if (keyframes_) return keyframes_->prepare_first(camera, time);
  begins_with_keyframes_ = false;
  decision_->begin_with(kCache);
  return Done{};
}

// Before the frame that follows, when it is known how the eye moves: keyframes draw it if they are
// good enough.
Result<> AutoFrames::begin_keyframes_ahead(double time) {
  Loss& loss = loss_[kKeyframes];
  if (!eye_.jumped()) {
    const Result<BegunKeyframes> begun = begin_keyframes(eye_, time, *keyframes_);
    if (!begun) return begun.error();
    loss = {begun->loss_db, frame_};
    keyframes_seen_ = frame_;
    if (loss.db && good_enough(kKeyframes)) {
      decision_->begin_with(kKeyframes);
      return Done{};
    }
  }
  decision_->begin_with(kCache);
  // They may be as good as the cache, once that has its pictures.
  keyframes_seen_ = frame_ - kKeyframesLast - 1;
  loss.db.reset(), keyframes_->forget_loss();
  if (!eye_.jumped()) prepare(kKeyframes, kCacheWarmsUp);
  return Done{};
}

Result<std::unique_ptr<KeyframeFrames>> AutoFrames::make_keyframes(const Scene& scene) const {
  KeyframeFramesOptions keyframes;
  keyframes.samples = backend_.samples();
  keyframes.polygons_where_cheaper = false;
  keyframes.keyframes.samples = options_.keyframe_samples;
  keyframes.keyframes.keyframe_ms = options_.keyframe_ms > 0 ? options_.keyframe_ms : kKeyframeMs;
  return KeyframeFrames::create(scene, keyframes);
}

void AutoFrames::measure_load(const Camera& camera) {
  in_view_.clear();
  backend_.placed().cull(camera, in_view_);
  load_ = {0, double(camera.width) * camera.height, 0, threads_, masked_};
  const Scene& scene = backend_.scene();
  for (const std::uint32_t object : in_view_)
    add_object(camera, backend_.placed().bounds()[object],
               double(scene.models[std::size_t(scene.objects[object].model)].triangles), load_);
  // Until there are levels it is a guess.
  if (levels_.levels)
    load_.level_triangles = count_level_triangles(camera, in_view_, backend_.placed(),
                                                  levels_.error_px, *levels_.levels);
}

// What takes that time, beside what draws, or beside direct drawing until that is known?
bool AutoFrames::in_a_hurry(double guess_ms) const {
  const double least = decision_->drawn_ms() > 0
                           ? std::min(decision_->drawn_ms(), slowness_ * load_.direct_ms())
                           : slowness_ * load_.direct_ms();
  return guess_ms < kHurry * least;
}

void AutoFrames::look(const Camera& camera) {
  if (frame_ % kLookFrames == 0 || eye_.jumped()) measure_load(camera);
  const FrameLoad& load = load_;
  outlook_[kDirect] = {true, false, true, slowness_ * load.direct_ms(), 0};
  const double direct_mean_ms = decision_->mean_ms(kDirect),
               direct_ms = direct_mean_ms > 0 ? direct_mean_ms
                                              : off_[kDirect] * slowness_ * load.direct_ms();
  outlook_[kCache] = {caches_ && !cheap_ && !shared_chooser_->cache_failed(), false, true, 0, 0};
  if (frame_ > 0 && decision_->mean_ms(kCache) == 0)
    outlook_[kCache].guess_ms = kCacheOfDirect * direct_ms;
  for (const int method : {int(kRays), int(kLevels), int(kKeyframes)}) {
    AutoOutlook& one = outlook_[std::size_t(method)];
    one = {};
    one.ready = frames_[method] != nullptr;
    one.preparable = options_.by_clock && !one.ready && !failed_[method];
  }
  // OpenGL's time says nothing of what processors take.
  const double slow = backend_.drawn_by() == DrawnBy::opengl ? 1 : slowness_;
  outlook_[kRays].guess_ms = slow * load.rays_ms();
  outlook_[kRays].prepare_ms = kOfFrames * slow * kRaysTriangleMs * double(meshes_triangles_);
  outlook_[kLevels].guess_ms = slowness_ * load.levels_ms();
  outlook_[kLevels].prepare_ms = (in_a_hurry(outlook_[kLevels].guess_ms) ? 1 : kOfFrames) * slow *
                                 kLevelsTriangleMs * double(meshes_triangles_);
  AutoOutlook& keyframes = outlook_[kKeyframes];
  keyframes.guess_ms = slow * load.keyframes_ms() + FrameLoad::kKeyframesOfDirect * direct_ms;
  keyframes.prepare_ms = kOfFrames * (slow * kRaysTriangleMs * double(meshes_triangles_) +
                                      kFirstKeyframes * kKeyframeMs);
  keyframes.good_enough = good_enough(kKeyframes);
  outlook_[kLevels].good_enough = good_enough(kLevels);
  if (keyframes_) {
    keyframes.ready = preparing_ != kKeyframes && frame_ - keyframes_seen_ <= kKeyframesLast &&
                      keyframes_->prepared();
    keyframes.preparable = !keyframes.ready && frame_ >= keyframes_again_;
    keyframes.prepare_ms = kOfFrames * kFirstKeyframes * kKeyframeMs;
  }
  for (int method = 0; method < kMethods; ++method)
    outlook_[std::size_t(method)].guess_ms *= off_[method];
  // What is being prepared goes on, whatever the frames take meanwhile.
  if (preparing_ >= 0) outlook_[std::size_t(preparing_)].prepare_ms = 0;
}

// Polygons took that: how far off is their model? Levels are polygons, too.
void AutoFrames::learn_direct(double ms) {
  const double off = std::clamp(ms / (slowness_ * load_.direct_ms()), 1 / kMostOff, kMostOff);
  off_[kDirect] += (off - off_[kDirect]) * std::max(kNewestOff, 1.0 / ++direct_frames_);
  if (!frames_[kLevels]) off_[kLevels] = off_[kDirect];
}

// Is a method whose loss is measured? What was not may be, some time later.
bool AutoFrames::good_enough(int method) {
  Loss& of = loss_[method];
  const auto good = [&] {
    // Nobody has seen it yet: what was looked at is one frame.
    const double sure = decision_->mean_ms(method) == 0 ? kCertainly : 1;
    return !of.db || rilievo::good_enough(*of.db, cache_loss_, sure * options_.loss_db);
  };
  const int again = method == kLevels ? kLooksAgainAtLevels : kLooksAgain;
  if (!good() && preparing_ < 0 && frame_ - of.seen_in > again) {
    of.db.reset();
    if (method == kKeyframes && keyframes_) keyframes_->forget_loss();
    if (method == kLevels && losses_) losses_->forget();
  }
  return good();
}

// Of the frame that was drawn last.
void AutoFrames::measure_loss(const Camera& camera, const AutoChoice& choice) {
  Loss& of = loss_[choice.draws];
  of.seen_in = frame_;
  if (of.db && frame_ % (choice.draws == kLevels ? kLossFramesOfLevels : kLossFrames) != 0) return;
  if (choice.draws == kKeyframes)
    for (int i = of.db ? kLossesOfTrial - 1 : 0; i < kLossesOfTrial; ++i)
      of.db = loss_of(*keyframes_);
  if (choice.draws != kLevels || !losses_ || preparing_ >= 0) return;
  const SoftwareTarget* target = active_->software_target();
  if (!target) return;
  in_view_.clear();
  backend_.placed().cull(camera, in_view_);
  losses_->add(camera, in_view_, target->color(), of.db ? 1 : kLossesOfTrial);
  if (const std::optional<double> db = losses_->db()) of.db = db;
}

// `goes_on`: with keyframes that there are, for so many frames.
void AutoFrames::prepare(int method, int goes_on) {
  const bool again = method == kKeyframes && keyframes_;
  if (preparing_ >= 0 || failed_[method] || (frames_[method] && !again)) return;
  Result<SoftwareBackend*> software = backend_.software();
  if (!software) {
    failed_[method] = true;
    return;
  }
  preparing_ = method, stage_ = Preparing::made;
  shared_eye_.forget();
  prepared_ = false;
  // What will hardly be good enough is worth no frame's time.
  const bool hurry =
      decision_->likely(method) && in_a_hurry(outlook_[std::size_t(method)].guess_ms);
  if (!beside_ || hurries_ != hurry) beside_.emplace(hurries_ = hurry);
  const Scene& scene = (*software)->scene();
  // What moves is not where the rays' scene has it.
  const bool measures = method != kRays && meshes_triangles_ <= kMostForLoss && !moves_;
  const double pixels = double(width_) * height_;
  beside_->run([this, method, &scene, measures, pixels, goes_on, error_px = options_.error_px] {
    if (measures && !losses_)
      if (Result<RayScene> rays = RayScene::create(scene))
        losses_ = std::make_unique<FrameLoss>(std::move(*rays));
    if (method == kRays) made_.rays = RayVisibility::create(scene);
    if (method == kLevels) made_.levels = prepare_levels(backend_, scene, pixels, error_px);
    if (method == kKeyframes) {
      if (!keyframes_) {
        if (auto made = make_keyframes(scene)) made_.keyframes = std::move(*made);
      }
      KeyframeFrames* frames = keyframes_ ? keyframes_ : made_.keyframes.get();
      made_.failed = !frames || !prepare_keyframes(shared_eye_, *frames, goes_on);
    }
    prepared_ = true;
  });
}

// What was shown, for what is prepared to be compared with.
void AutoFrames::show(const Camera& camera, double time, int drawn_by) {
  if (preparing_ < 0 || stage_ != Preparing::shown) return;
  const SoftwareTarget* target = active_->software_target();
  if (!target) return;
  ShownFrame& shown = made_.shown;
  shown.color = target->color();
  shown.camera = camera, shown.time = time, shown.by_cache = drawn_by == kCache;
  backend_.placed().cull(camera, shown.in_view);
  look_at_prepared();
}

void AutoFrames::look_at_prepared() {
  stage_ = Preparing::looked_at;
  prepared_ = false;
  beside_->run(
      [this, method = preparing_, error_px = options_.error_px, loss_db = options_.loss_db] {
        const ShownFrame& shown = made_.shown;
        if (method == kRays) made_.found = audition_rays(shown, backend_.samples(), **made_.rays);
        if (method == kLevels)
          made_.found = audition_levels(shown, error_px, loss_db, losses_.get(), made_.levels);
        if (method == kKeyframes)
          made_.found =
              audition_keyframes(shown, losses_.get(), keyframes_ ? *keyframes_ : *made_.keyframes);
        prepared_ = true;
      });
}

// Takes what was prepared.
Result<> AutoFrames::adopt() {
  if (preparing_ < 0 || !prepared_) return Done{};
  // What draws may have changed to what no software shows.
  if (stage_ == Preparing::shown && active_->software_target()) return Done{};
  beside_->wait();
  const bool can_be_seen =
      active_->software_target() &&
      ((preparing_ == kRays && made_.rays) || (preparing_ == kLevels && made_.levels.frames) ||
       (preparing_ == kKeyframes && !made_.failed));
  if (stage_ == Preparing::made && can_be_seen) {
    stage_ = Preparing::shown;
    return Done{};
  }
  const int method = std::exchange(preparing_, -1);
  Result<SoftwareBackend*> software = backend_.software();
  if (!software) return software.error();
  if (stage_ == Preparing::looked_at) {
    loss_[method] = {made_.found.loss_db, frame_};
    if (made_.found.cache_loss_db) cache_loss_ = made_.found.cache_loss_db;
  }
  Result<std::unique_ptr<FrameSource>> frames{Error{}};
  if (method == kRays && made_.rays)
    frames = backend_.present(std::make_unique<SoftwareFrames>(
        **software, std::make_unique<DirectChooser>(), std::move(*made_.rays)));
  if (method == kLevels && finish_levels(backend_, options_.error_px, made_.levels)) {
    levels_ = std::move(made_.levels);
    frames = std::move(levels_.frames);
  }
  if (method == kKeyframes) {
    keyframes_seen_ = frame_, keyframes_again_ = frame_ + kKeyframesAgain;
    if (made_.failed) keyframes_ = nullptr, loss_[method] = {}, frames_[method].reset();
  }
  if (method == kKeyframes && made_.keyframes) {
    keyframes_ = made_.keyframes.get();
    frames = backend_.present(std::move(made_.keyframes));
    if (!frames) keyframes_ = nullptr, loss_[method] = {};
  }
  const double ms = made_.found.processor_ms / threads_;
  if (method == kLevels && levels_.levels && stage_ == Preparing::looked_at)
    measure_load(made_.shown.camera);
  const double guess_ms = method == kLevels ? slowness_ * load_.levels_ms()
                                            : outlook_[std::size_t(method)].guess_ms / off_[method];
  if (stage_ == Preparing::looked_at && ms > 0 && guess_ms > 0)
    off_[method] = std::clamp(ms / guess_ms, 1 / kMostOff, kMostOff);
  // Levels are polygons, too.
  if (method == kLevels && decision_ && decision_->mean_ms(kDirect) == 0)
    off_[kDirect] = std::max(1.0, off_[kLevels]);
  made_ = {};
  // Memory, mostly: the other methods go on.
  if (frames) frames_[method] = std::move(*frames);
  failed_[method] = !frames_[method];
  return Done{};
}

// What another method showed in the last frame fades out.
void AutoFrames::fade(const Camera& camera) {
  const SoftwareTarget* now = active_->software_target();
  const bool same_size =
      shown_camera_.width == camera.width && shown_camera_.height == camera.height;
  if (!now || only_direct_ || eye_.jumped() || !same_size) fade_.end();
  shown_ = now, shown_camera_ = camera;
  if (!fade_.goes_on()) return;
  fade_.mix(*now, camera);
  shown_ = &fade_.target();
  stats_.bound_px.reset();  // of a mean of two frames none is known
}

Result<> AutoFrames::draw_objects() {
  Result<> drawn = active_->draw_objects();
  if (drawn && shown_ == &fade_.target()) fade_.draw_objects();
  return drawn;
}

Result<> AutoFrames::draw(const Camera& camera, double time) {
  if (camera.width != width_ || camera.height != height_)
    if (Result<> begun = begin(camera, time); !begun) return begun;
  if (only_direct_) {
    active_ = frames_[kDirect].get();
    shared_chooser_->use_cache(false);
    Result<> drawn = active_->draw(camera, time);
    stats_ = active_->stats();
    stats_.decision = {kCandidates[kDirect].name, describe(AutoReason::only)};
    fade(camera);
    return drawn;
  }
  if (Result<> adopted = adopt(); !adopted) return adopted;
  eye_.follow(camera);
  // What was seen of them was elsewhere.
  if (eye_.jumped() && drawn_by_ == kKeyframes)
    loss_[kKeyframes].db.reset(), keyframes_->forget_loss();
  const bool first = frame_ == begun_in_;
  if (!first && std::exchange(begins_with_keyframes_, false))
    if (Result<> begun = begin_keyframes_ahead(time); !begun) return begun;
  look(camera);
  const bool disturbed = preparing_ >= 0;
  const AutoChoice choice = decision_->next(outlook_, eye_.jumped(), disturbed);
  const bool opengl = backend_.drawn_by() == DrawnBy::opengl;
  // Warm-ups and trials are short: all of their frames count.
  const bool timed = !opengl || choice.reason == AutoReason::trial || frame_ % kTimedFrames == 0;
  ++frame_;
  if (opengl && timed) backend_.finish();
  // By counts the methods are direct drawing and the cache, whose frames keep to what they say.
  if (options_.by_clock && frame_ > 1 && choice.draws != drawn_by_ && shown_)
    fade_.begin(*shown_, shown_camera_);
  drawn_by_ = choice.draws;
  shared_chooser_->use_cache(choice.draws == kCache);
  active_ = frames_[choice.draws == kCache ? kDirect : choice.draws].get();
  double ms = begun_ms_;
  const bool begins = first && begins_with_keyframes_;  // and the frame is drawn
  if (!begins) {
    const Stopwatch watch;
    if (Result<> drawn = active_->draw(camera, time); !drawn) return drawn;
    if (opengl && timed) backend_.finish();
    ms = watch.ms();
  }
  show(camera, time, choice.draws);
  if (choice.draws == kKeyframes) keyframes_seen_ = frame_;
  if (choice.prepares >= 0) prepare(choice.prepares);
  if (preparing_ == kKeyframes) shared_eye_.post(eye_, time);
  if (options_.by_clock && (choice.draws == kKeyframes || choice.draws == kLevels))
    measure_loss(camera, choice);
  const double counted_ms = shared_chooser_->counted_ms();
  if (!options_.by_clock) {
    ms = counted_ms;
  } else if (timed && !disturbed && !begins && active_ == frames_[kDirect].get() &&
             counted_ms > 0) {
    const double slowness = std::clamp(ms / counted_ms, kFastest, kSlowest);
    // Captures of large meshes take many times what is counted for them.
    if (active_->stats().captures == 0 || slowness < slowness_)
      slowness_ += (slowness - slowness_) * std::max(kNewestSlowness, 1.0 / ++counted_frames_);
    if (choice.draws == kDirect) learn_direct(ms);
    if (choice.draws == kDirect && counted_ms > kNotCheap * load_.pixels_ms()) cheap_ = false;
  }
  if (timed) decision_->add(ms, disturbed);
  if (begins)
    if (Result<> begun = begin_keyframes_here(camera, time); !begun) return begun;
  stats_ = active_->stats();
  stats_.decision = {kCandidates[choice.draws].name, describe(choice.reason), choice.expected_ms,
                     choice.rival < 0 ? std::string_view() : kCandidates[choice.rival].name,
                     choice.rival_ms};
  fade(camera);
  return Done{};
}

void AutoFrames::follow(const MethodOptions& options) {
  options_.error_px = options.error_px;
  options_.fps = options.fps;
  if (decision_) decision_->set_pace(options.fps > 0 ? 1000 / options.fps : 0);
  follow_cache(options, shared_chooser_->options());
}

}  // namespace

Result<Method> make_auto(const MethodOptions& options, Backend& backend) {
  // These change the scene that the cache draws, or take minutes.
  if (options.bake_mb > 0) return Error{"--bake-mb", "is for --method cache"};
  if (options.levels) return Error{"--levels", "is for --method cache"};
  Result<std::unique_ptr<AutoFrames>> made = AutoFrames::create(options, backend);
  if (!made) return made.error();
  Method method;
  method.follow = [frames = made->get()](const MethodOptions& changed) { frames->follow(changed); };
  method.frames = std::move(*made);
  return method;
}

}  // namespace rilievo
