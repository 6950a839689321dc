#include "rilievo/method/auto.h"

#include <algorithm>
#include <utility>

#include "rilievo/core/stopwatch.h"
#include "rilievo/frame/software/software_frames.h"
#include "rilievo/keyframes/same_view.h"
#include "rilievo/method/auto_frames.h"
#include "rilievo/method/cached.h"

namespace rilievo {
namespace {

// The cache's share of direct drawing, while it was not drawn: 0.3 to 0.5 along flights, and 0.7 to
// 0.9 indoors; of an eye that stands, whose pictures stay as they are.
constexpr double kCacheOfDirect = 0.6, kCacheOfStanding = 0.3;
// An eye stands after so many frames in which it has not moved: in one it may only have been slow.
constexpr int kStands = 12;
// What is in view is cheap until direct drawing takes so many times what pixels alone take.
constexpr double kNotCheap = 1.25;
// What preparing takes for each triangle of the scene's meshes, ms: rays, levels.
constexpr double kRaysTriangleMs = 5e-4, kLevelsTriangleMs = 0.9e-3;
// The share of it that frames lose, which leave the thread that prepares what they do not use.
constexpr double kOfFrames = 0.2;
// One frame in so many looks at the scene's load, unless the eye jumps.
constexpr int kLookFrames = 8;
// The parts that the first two keyframes are made in.
constexpr int kFirstKeyframes = 64;
// Levels that leave more than this share of the triangles draw nearly what polygons do.
constexpr double kLevelsMayPay = 0.9;
// The share of a frame in how far off the model of polygons is, and the most that a trial says.
constexpr double kNewestOff = 0.2, kMostOffOfTrial = 2;
// The cache's frames that capture most.
constexpr int kFirstCaptures = 5;
// Keyframes leave frames this share of what keeps the pace: parts of them are not of equal time.
constexpr double kWithinPace = 0.95;
// Pictures that no frame was drawn from for more frames are mostly of no use.
constexpr int kPicturesLast = 60;
// With OpenGL frames overlap: one in so many is waited for, to be timed.
constexpr int kTimedFrames = 8;

}  // namespace

std::uint64_t AutoFrames::count_mesh_triangles(const Scene& scene) {
  std::uint64_t count = 0;
  for (const Mesh& mesh : scene.meshes) count += mesh.indices.size() / 3;
  return count;
}

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

void AutoFrames::look(const Camera& camera) {
  if (frame_ % kLookFrames == 0 || eye_.jumped()) measure_load(camera);
  const FrameLoad& load = load_;
  const double slowness = slowness_.value(), polygons_ms = slowness * load.direct_ms(),
               direct_guess_ms = off_[kDirect] * polygons_ms,
               direct_mean_ms = decision_->mean_ms(kDirect),
               direct_ms = direct_mean_ms > 0 ? direct_mean_ms : direct_guess_ms;
  outlook_[kDirect] = {true, false, true, polygons_ms, 0};
  outlook_[kCache] = {caches_ && !cheap_ && !shared_chooser_->cache_failed(), false, true, 0, 0};
  // What polygons took when they drew says nothing of what is in view now.
  outlook_[kCache].prior_ms =
      (still_frames_ >= kStands ? kCacheOfStanding : kCacheOfDirect) * direct_guess_ms;
  if (frame_ > 0 && decision_->mean_ms(kCache) == 0)
    outlook_[kCache].guess_ms = outlook_[kCache].prior_ms;
  for (const int method : {int(kRays), int(kLevels), int(kKeyframes)}) {
    AutoOutlook& one = outlook_[std::size_t(method)];
    one = {};
    one.ready = frames_[method] != nullptr;
    one.preparable = options_.by_clock && !one.ready && !failed_[method];
  }
  // OpenGL's time says nothing of what processors take.
  const double slow = backend_.drawn_by() == DrawnBy::opengl ? 1 : slowness;
  outlook_[kRays].guess_ms = slow * load.rays_ms();
  outlook_[kRays].prepare_ms = kOfFrames * slow * kRaysTriangleMs * double(meshes_triangles_);
  outlook_[kLevels].guess_ms = slowness * load.levels_ms();
  outlook_[kLevels].prepare_ms = (in_a_hurry(outlook_[kLevels].guess_ms) ? 1 : kOfFrames) * slow *
                                 kLevelsTriangleMs * double(meshes_triangles_);
  AutoOutlook& keyframes = outlook_[kKeyframes];
  keyframes.guess_ms = slow * load.keyframes_ms() + FrameLoad::kKeyframesOfDirect * direct_ms;
  keyframes.prepare_ms = kOfFrames * (slow * kRaysTriangleMs * double(meshes_triangles_) +
                                      kFirstKeyframes * keyframe_ms());
  // After a jump they show a coarse one, which pops when another method replaces it a frame later.
  keyframes.good_enough = !eye_.jumped() && good_enough(kKeyframes);
  outlook_[kLevels].good_enough = good_enough(kLevels);
  // Until there are levels it is a guess, and says nothing of scenes with few triangles.
  if (levels_.levels && decision_->draws() != kLevels &&
      load.level_triangles > kLevelsMayPay * load.triangles)
    outlook_[kLevels].ready = outlook_[kLevels].preparable = false;
  if (keyframes_) {
    const bool recent = preparing_ != kKeyframes && frame_ - keyframes_seen_ <= kKeyframesLast;
    // A first one, from before the first frame, draws before there are two; and what draws goes on
    // from a coarse one.
    const bool goes_on = first_alone_ || (draws_keyframes() && keyframes_->any());
    keyframes.ready = recent && (goes_on || keyframes_->prepared());
    keyframes.preparable = !keyframes.ready && frame_ >= keyframes_again_;
    keyframes.prepare_ms = kOfFrames * kFirstKeyframes * keyframe_ms();
  }
  for (int method = 0; method < kMethods; ++method) {
    double& off = off_[method];
    // What one frame took beside the others is believed less and less, until it is tried.
    const bool counted = method == kDirect && direct_counted_;
    if (frames_[method] && decision_->mean_ms(method) == 0) off = remembered_off(off, counted);
    outlook_[std::size_t(method)].guess_ms *= off;
  }
  // What is being prepared goes on, whatever the frames take meanwhile.
  if (preparing_ >= 0) outlook_[std::size_t(preparing_)].prepare_ms = 0;
}

// Polygons took that: how far off is their model? Levels are polygons, too. The few frames of a
// trial may be beside other programs' work.
void AutoFrames::learn_direct(double ms, bool trial) {
  const double most = trial ? std::max(kMostOffOfTrial, off_[kDirect]) : kMostOff,
               off = std::clamp(ms / (slowness_.value() * load_.direct_ms()), 1 / kMostOff, most);
  off_[kDirect] += (off - off_[kDirect]) * newest_share(kNewestOff, ++direct_frames_);
  if (!frames_[kLevels]) off_[kLevels] = off_[kDirect];
}

// Who draws took `times` what was counted for that. What was measured before took that long,
// whatever is said of the machine now; what was counted takes as much longer.
void AutoFrames::learn_slowness(MachineSlowness::Source source, double times, bool at_most) {
  const double more = slowness_.add(source, times, at_most);
  for (int method = 0; method < kMethods; ++method) {
    const bool as_direct = method == kDirect || (method == kLevels && !frames_[kLevels]);
    if (off_[method] == 1 || (as_direct && direct_counted_)) continue;
    off_[method] = std::clamp(off_[method] / more, 1 / kMostOff, kMostOff);
  }
}

// Are its frames as near to the truth as polygons, or as can be seen?
bool AutoFrames::looks_exact(int method) const {
  const std::optional<double>& db = method == kCache ? cache_loss_ : loss_[method].db;
  return method == kDirect || method == kRays || (db && *db <= 0);
}

// From what was shown last to another method, or to levels of another error.
void AutoFrames::begin_fade(int to) {
  int frames = FrameFade::kFrames;
  if (looks_exact(drawn_by_) && looks_exact(to)) frames = FrameFade::kFewFrames;
  // Back, as after a trial that failed; not on to a third picture.
  const bool within = fade_.goes_on();
  if (within && to == fades_out_ && to != drawn_by_)
    frames = std::min(frames, std::max(fade_.mixed(), 1));
  catches_up_ = to == kCache && frame_ - cache_drawn_ <= kPicturesLast;
  fade_.begin(*shown_, shown_camera_, frames, catches_up_);
  moved_.begin_fade(shown_time_, within);
  // What fades out now is a mix of two.
  fades_out_ = within ? -1 : drawn_by_;
}

// Does a frame of this camera have the size of the last one?
bool AutoFrames::as_large_as_shown(const Camera& camera) const {
  return shown_camera_.width == camera.width && shown_camera_.height == camera.height;
}

// Pictures of some frames ago may be late while what drew those fades out over them.
void AutoFrames::let_cache_catch_up(const Camera& camera, bool draws) {
  const bool fades = draws && catches_up_ && !eye_.jumped() && as_large_as_shown(camera);
  shared_chooser_->options().catch_up = fades ? fade_.left() : 0;
  if (draws) cache_drawn_ = frame_;
}

// What another method showed in the last frame fades out.
void AutoFrames::fade(const Camera& camera, double time) {
  const SoftwareTarget* now = active_->software_target();
  if (!now || only_direct_ || eye_.jumped() || !as_large_as_shown(camera)) fade_.end();
  shown_ = now, shown_camera_ = camera, shown_time_ = time;
  if (!fade_.goes_on()) return;
  fade_.mix(*now, camera, moved_.since(time));
  shown_ = &fade_.target();
  stats_.bound_px.reset();  // of a mean of two frames none is known
}

Result<> AutoFrames::draw_objects() {
  Result<> drawn = active_->draw_objects();
  if (drawn && shown_ == &fade_.target()) fade_.draw_objects();
  return drawn;
}

// The eye has jumped: keyframes and the cache's pictures are of elsewhere, and what was measured.
void AutoFrames::leave_place() {
  if (draws_keyframes()) forget_loss(kKeyframes);
  if (preparing_ < 0 && made_.keyframes) made_.jumped = true, made_.jumped_in = frame_;
  keyframes_seen_ = frame_ - kKeyframesLast - 1, cache_drawn_ = kNever;
  cheap_ = false, cache_loss_.reset();
}

Result<> AutoFrames::draw(const Camera& camera, double time) {
  begun_drawn_ = -1;
  if (camera.width != width_ || camera.height != height_)
    if (Result<> begun = begin(camera, time); !begun) return begun;
  if (only_direct_) {
    active_ = frames_[kDirect].get();
    shared_chooser_->use_cache(false);
    Result<> drawn = active_->draw(camera, time);
    stats_ = active_->stats();
    stats_.decision = {kCandidates[kDirect].name, describe(AutoReason::only)};
    fade(camera, time);
    return drawn;
  }
  if (Result<> adopted = adopt(); !adopted) return adopted;
  eye_.follow(camera);
  still_frames_ = frame_ > 0 && same_view(camera, shown_camera_) ? still_frames_ + 1 : 0;
  if (eye_.jumped()) leave_place();
  look(camera);
  // What frames make of keyframes they make after what is timed.
  const bool disturbed = preparing_ >= 0 && stage_ != Preparing::by_frames;
  // Nor does a trial leave a first keyframe behind.
  const AutoChoice choice =
      decision_->next(outlook_, eye_.jumped(), preparing_ >= 0 || first_alone_);
  if (first_alone_ && choice.draws != kKeyframes) end_first_keyframe();
  const bool opengl = backend_.drawn_by() == DrawnBy::opengl;
  // Warm-ups and trials are short: all of their frames count.
  const bool timed = !opengl || choice.reason == AutoReason::trial || frame_ % kTimedFrames == 0;
  ++frame_;
  if (opengl && timed) backend_.finish();
  // By counts the methods are direct drawing and the cache, whose frames keep to what they say.
  const bool changes = std::exchange(refined_, false) || choice.draws != drawn_by_;
  if (options_.by_clock && frame_ > 1 && changes && shown_) begin_fade(choice.draws);
  let_cache_catch_up(camera, choice.draws == kCache);
  drawn_by_ = choice.draws;
  shared_chooser_->use_cache(choice.draws == kCache);
  active_ = frames_[choice.draws == kCache ? kDirect : choice.draws].get();
  if (choice.draws == kKeyframes) keyframes_->set_pace(kWithinPace * pace_ms());
  double ms = begun_ms_;
  // What begins shows the first frame: polygons would be a change of method in the next one.
  const int drew = std::exchange(begun_drawn_, -1);
  const bool begins = drew >= 0, has_drawn = drew == choice.draws;
  if (!has_drawn) {
    const Stopwatch watch;
    if (Result<> drawn = active_->draw(camera, time); !drawn) return drawn;
    if (opengl && timed) backend_.finish();
    ms = begins ? std::min(ms, watch.ms()) : watch.ms();
  }
  show(camera, time, choice.draws);
  if (choice.draws == kKeyframes || keep_keyframes(camera, time, choice)) keyframes_seen_ = frame_;
  if (choice.draws == kKeyframes) {
    begins_with_keyframes_ = false;
    const KeyframeShares& shares = keyframes_->shares();
    // What finer ones lost says nothing of a coarse one.
    if (shares.coarse > 0) forget_loss(kKeyframes);
    if (first_alone_) ms = allow_second_keyframe(ms);
    ms = ms_when_settled(ms, shares.fill_ms, young_keyframes_ > 0);
    young_keyframes_ = std::max(young_keyframes_ - 1, 0);
  }
  // Not beside the first captures of the cache, which take long enough.
  if (begins_with_keyframes_ && frame_ - begun_in_ >= kFirstCaptures) {
    prepare(kKeyframes, camera, time);
    begins_with_keyframes_ = false;
  }
  if (choice.prepares >= 0 && !begins_with_keyframes_) prepare(choice.prepares, camera, time);
  if (preparing_ == kKeyframes) shared_eye_.post(eye_, time);
  if (options_.by_clock && (choice.draws == kKeyframes || choice.draws == kLevels))
    if (Result<> measured = measure_loss(camera, time, choice); !measured) return measured;
  if (choice.draws == kKeyframes) follow_first_keyframes();
  const double counted_ms = load_.by_threads(shared_chooser_->counted_ms());
  if (!options_.by_clock) {
    ms = counted_ms;
  } else if (timed && !disturbed && !begins && active_ == frames_[kDirect].get() &&
             counted_ms > 0) {
    // Captures of large meshes take many times what is counted for them; the first ones are many.
    const bool captured = active_->stats().captures > 0;
    if (!captured || frame_ - begun_in_ > kCacheWarmsUp)
      learn_slowness(choice.draws == kDirect ? MachineSlowness::polygons : MachineSlowness::cache,
                     ms / counted_ms, captured);
    if (choice.draws == kDirect) {
      learn_direct(ms, choice.reason == AutoReason::trial);
      direct_counted_ = false;
    }
    if (choice.draws == kDirect && counted_ms > kNotCheap * load_.pixels_ms()) cheap_ = false;
  }
  // What else draws does not say that other programs have ended.
  if (active_ != frames_[kDirect].get()) slowness_.forget();
  if (timed) decision_->add(ms, disturbed);
  make_part(camera, time, ms);
  stats_ = active_->stats();
  stats_.decision = {kCandidates[choice.draws].name, describe(choice.reason), choice.expected_ms,
                     choice.rival < 0 ? std::string_view() : kCandidates[choice.rival].name,
                     choice.rival_ms};
  fade(camera, time);
  return Done{};
}

// A first keyframe is left behind with each frame: until there is a second one, frames make as much
// of that as those of other methods would, if the pace leaves time. After a frame of `ms`; what it
// takes without.
double AutoFrames::allow_second_keyframe(double ms) {
  const double made_ms = keyframes_->shares().keyframe_ms, own_ms = ms - made_ms;
  double allowed_ms = time_for_keyframes(own_ms, own_ms, own_ms, own_ms);
  if (pace_ms() > 0) allowed_ms = std::clamp(pace_ms() - own_ms, 0.0, allowed_ms);
  keyframes_->allow_keyframe_ms(allowed_ms);
  const double share_ms = options_.keyframe_ms > 0 ? 0 : kKeyframeShare * own_ms;
  return own_ms + std::min(made_ms, std::max(keyframe_ms(), share_ms));
}

// After a frame from keyframes that began. A frame that completes one more does not show it yet;
// what was lost without it says little of frames with it, and is forgotten.
void AutoFrames::follow_first_keyframes() {
  const KeyframeShares& shares = keyframes_->shares();
  const bool completed = shares.completed > 0;
  if (completed && young_keyframes_ > 0) forget_loss(kKeyframes);
  if (!first_alone_) {
    if (completed) young_keyframes_ = 0;
    return;
  }
  if (second_made_ || shares.coarse) end_first_keyframe();
  second_made_ = first_alone_ && completed;
}

void AutoFrames::end_first_keyframe() {
  first_alone_ = second_made_ = false;
  keyframes_->allow_keyframe_ms(0);
}

// During a trial of another, and for some frames after one of theirs, they go on, as much as they
// must to be taken again. Are they as new as if they had drawn this frame?
bool AutoFrames::keep_keyframes(const Camera& camera, double time, const AutoChoice& choice) {
  if (choice.draws == kKeyframes || !keyframes_ || preparing_ >= 0) return false;
  // Those that were made while the cache captures after a jump were not tried yet: a model says
  // what they take.
  const double mean_ms = decision_->mean_ms(kKeyframes),
               keyframes_ms = mean_ms > 0 ? mean_ms : outlook_[kKeyframes].guess_ms;
  const bool tried = decision_->draws() == kCache && outlook_[kKeyframes].ready &&
                     outlook_[kKeyframes].good_enough &&
                     kept_after_trial(frame_ - loss_[kKeyframes].seen_in, kCacheWarmsUp,
                                      keyframes_ms, decision_->drawn_ms());
  if (decision_->draws() != kKeyframes && !tried) return false;
  if (frame_ - keyframes_seen_ >= kKeyframesLast - 3)
    return keyframes_->prepare(camera, time, false).ok();
  keyframes_->follow(camera, time);
  return false;
}

void AutoFrames::follow(const MethodOptions& options) {
  const bool other_error = options_.error_px != options.error_px;
  options_.error_px = options.error_px;
  if (other_error) cache_loss_.reset();
  if (other_error && levels_.chooser) {
    follow_error(options_.error_px, levels_);
    forget_levels();
  }
  options_.fps = options.fps;
  if (decision_) decision_->set_pace(options.fps > 0 ? 1000 / options.fps : 0);
  follow_cache(options, shared_chooser_->options());
}

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
