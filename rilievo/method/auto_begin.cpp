#include <algorithm>
#include <glm/glm.hpp>
#include <utility>

#include "rilievo/core/box_view.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/frame/software/software_backend.h"
#include "rilievo/method/auto_frames.h"
#include "rilievo/method/good_enough.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo {
namespace {

// Keyframes begin where direct drawing takes so many times as long, by counts: along flights 3
// to 6. Nothing is counted where its model is below the second.
constexpr double kKeyframesPay = 2.75, kKeyframesMayPay = 1.3;
// And it is seen how good they are where polygons take so many times as long.
constexpr double kKeyframesWorthALook = 1 / AutoDecision::kWorthPreparing;
// The first frame of all is drawn twice if it is counted to take less, ms: keyframes that take much
// less than polygons are made whatever these take. Else polygons are taken to take that share of
// what was counted, or of the first frame's time if that is less: along eight walks they took 0.45
// to 1.1 of it. What is taken to be too cheap would be tried for nothing.
constexpr double kDrawnAgainMs = 250, kOfFirst = 0.8;
// Levels of detail leave about so many triangles for a pixel of an object's bounds, and so many of
// an object at least.
constexpr double kLevelTriangles = 2, kLeastLevel = 300;

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

// The pixels in which it may be seen.
double covered_pixels(const Camera& camera, const glm::dmat4& eye, const Box& bounds) {
  if (bounds.empty()) return 0;
  const RasterRect rect = rect_of_box(camera, view_of_box(eye, bounds, camera.projection));
  return rect.empty() ? 0 : (rect.right - rect.left) * (rect.bottom - rect.top);
}

}  // namespace

void AutoFrames::measure_load(const Camera& camera) {
  in_view_.clear();
  backend_.placed().cull(camera, in_view_);
  load_ = {0, double(camera.width) * camera.height, 0, threads_, masked_};
  const Scene& scene = backend_.scene();
  const glm::dmat4 eye = eye_from_world(camera);
  for (const std::uint32_t object : in_view_) {
    const Box& bounds = backend_.placed().bounds()[object];
    add_object(camera, bounds,
               double(scene.models[std::size_t(scene.objects[object].model)].triangles), load_);
    // Of few objects; many cover the frame.
    if (load_.covered < load_.pixels) load_.covered += covered_pixels(camera, eye, bounds);
  }
  // Until there are levels it is a guess.
  if (levels_.levels)
    load_.level_triangles = count_level_triangles(
        camera, in_view_, backend_.placed(), levels_.share * options_.error_px, *levels_.levels);
}

// Before the first frame, and when the frame's size changes.
Result<> AutoFrames::begin(const Camera& camera, double time) {
  width_ = 0, height_ = 0;
  const FrameLoad load{double(triangles_), double(camera.width) * camera.height, 0, threads_};
  caches_ = !load.few();
  // Costs that are counted are those of the cache and of direct drawing.
  only_direct_ = bends_ || load.fits() || !(caches_ || options_.by_clock);
  begins_with_keyframes_ = cheap_ = false;
  if (only_direct_) {
    decision_.reset();
    width_ = camera.width, height_ = camera.height;
    return Done{};
  }
  outlook_.assign(kMethods, {});
  if (options_.by_clock && active_->software_target())
    fade_.end(), fade_.reserve(camera.width, camera.height);
  measure_load(camera);
  begun_in_ = frame_;
  // What the first frame made was of another size.
  if (preparing_ < 0) made_.keyframes.reset();
  if (first_alone_) end_first_keyframe();
  const Result<bool> by_keyframes = begin_with_keyframes(camera, time);
  if (!by_keyframes) return by_keyframes.error();
  made_.usual.forget();
  // To try the cache later is dear: it captures for several frames. Direct drawing is tried at any
  // time.
  const int others = caches_ && !cheap_ ? kCache : kDirect;
  decision_.emplace(kCandidates, *by_keyframes ? kKeyframes : others,
                    options_.fps > 0 ? 1000 / options_.fps : 0);
  width_ = camera.width, height_ = camera.height;
  return Done{};
}

// Polygons take so many times what keyframes do, by models, if polygons take that.
double AutoFrames::polygons_over_keyframes(double direct_ms) const {
  return direct_ms / (load_.keyframes_ms() + FrameLoad::kKeyframesOfDirect * direct_ms);
}

// Where polygons take long keyframes are made from the first frame on, and before the first one of
// all it is seen how good they are. Do they draw it?
Result<bool> AutoFrames::begin_with_keyframes(const Camera& camera, double time) {
  if (!options_.by_clock || !caches_ || failed_[kKeyframes] || meshes_triangles_ > kMostForLoss ||
      backend_.drawn_by() != DrawnBy::software || preparing_ >= 0)
    return false;
  if (polygons_over_keyframes(load_.direct_ms()) < kKeyframesMayPay) return false;
  const Result<bool> pay = count_polygons(camera, time);
  if (!pay) return pay.error();
  if (begun_ms_ < pace_ms()) return false;
  begins_with_keyframes_ = *pay;
  const double direct_ms = begun_ms_ / slowness_.value();
  return frame_ == 0 && polygons_over_keyframes(direct_ms) >= kKeyframesWorthALook &&
         make_first_keyframe(camera, time);
}

// Draws the frame and counts its work, since times of a first frame say little. Do keyframes pay?
Result<bool> AutoFrames::count_polygons(const Camera& camera, double time) {
  const Stopwatch watch;
  shared_chooser_->use_cache(false);
  if (Result<> drawn = frames_[kDirect]->draw(camera, time); !drawn) return drawn.error();
  begun_drawn_ = kDirect;
  const double counted_ms = load_.by_threads(shared_chooser_->counted_ms());
  // It touched memory for the first time. Where much depends on how long it takes from then on, it
  // is drawn again.
  const bool again = frame_ == 0 && counted_ms < kDrawnAgainMs;
  if (again) {
    const Stopwatch warm;
    if (Result<> drawn = frames_[kDirect]->draw(camera, time); !drawn) return drawn.error();
    begun_ms_ = warm.ms();
    learn_slowness(MachineSlowness::polygons, begun_ms_ / counted_ms, false);
    direct_counted_ = false;
  } else {
    const double ms = watch.ms(), believed_ms = slowness_.value() * counted_ms;
    begun_ms_ = kOfFirst * std::min(ms, believed_ms);
    direct_counted_ = believed_ms < ms;
  }
  learn_direct(begun_ms_, false);
  cheap_ = counted_ms < load_.pixels_ms();
  return polygons_over_keyframes(counted_ms) >= kKeyframesPay;
}

// Makes the first keyframe, which later ones would wait for in any case. Where it is certainly good
// enough it draws from this frame on; where it is not, and never will be, nothing more is made;
// else it is the first one of those that frames make, if they do. What fails, for want of memory,
// leaves the frame to the other methods.
bool AutoFrames::make_first_keyframe(const Camera& camera, double time) {
  const auto fail = [&] {
    failed_[kKeyframes] = true;
    return begins_with_keyframes_ = false;
  };
  Result<SoftwareBackend*> software = backend_.software();
  if (!software) return fail();
  Result<std::unique_ptr<KeyframeFrames>> made = make_keyframes((*software)->scene());
  if (!made || !(*made)->draw(camera, time)) return fail();
  KeyframeFrames& frames = **made;
  // Nothing stands still.
  if (!frames.any()) return begins_with_keyframes_ = false;
  const Image<float>& inverse_z = frames_[kDirect]->software_target()->inverse_z();
  std::optional<double> loss_db;
  bool good = true, hopeless = false;
  for (const double pixels : {kSoonAside, kLongAside}) {
    if (!good) break;
    const Result<std::optional<double>> found = loss_aside(camera, time, inverse_z, pixels, frames);
    if (!found) return fail();
    loss_db = *found;
    good = loss_db && good_beside_cache(*loss_db, std::nullopt, options_.loss_db, false);
    hopeless = pixels == kSoonAside && loss_db &&
               first_is_hopeless(*loss_db, std::nullopt, options_.loss_db, false);
  }
  if (!good && !hopeless) {
    if (begins_with_keyframes_) made_.keyframes = std::move(*made);
    return false;
  }
  begins_with_keyframes_ = false;
  const Stopwatch watch;
  if (good && !frames.draw(camera, time)) return fail();
  const double ms = watch.ms();
  Result<std::unique_ptr<FrameSource>> presented = backend_.present(std::move(*made));
  if (!presented) return fail();
  keyframes_ = &frames;
  frames_[kKeyframes] = std::move(*presented);
  keyframes_seen_ = frame_, keyframes_again_ = frame_ + kKeyframesAgain;
  loss_[kKeyframes] = {.db = loss_db, .seen_in = frame_};
  if (!good) return false;
  // What was seen from aside is no frame's.
  frames.forget_loss();
  begun_drawn_ = kKeyframes, begun_ms_ = ms;
  young_keyframes_ = kKeyframesDwell, first_alone_ = true;
  return true;
}

}  // namespace rilievo
