#include "rilievo/keyframes/keyframe_producer.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "rilievo/core/expects.h"
#include "rilievo/core/on_this_thread.h"
#include "rilievo/core/thread_watch.h"
#include "rilievo/keyframes/same_view.h"
#include "rilievo/keyframes/weigh_keyframes.h"

namespace rilievo {
namespace {

// Keyframes that are kept: one behind, one ahead. A coarse one is in the place of one.
constexpr std::size_t kKept = 2;
// Memory is kept for so many more.
constexpr std::size_t kSpare = 2;
// Steps of the first keyframe, each of which takes memory for what it reads: with two of them a
// program's first frame touches 100 MB more, which takes as long as several keyframes where the
// system maps pages slowly (core/large_buffer.h).
constexpr int kFirstSteps = 16;
// The share of the last band in the mean cost of a column.
constexpr double kNewestCost = 0.1;
// The share of the last frame in the mean time that holes take.
constexpr double kNewestHoles = 0.1;
// An eye that turns by so many radians a frame, or more, gets a margin that is wider by so much
// along that axis.
constexpr double kTurning = 0.003, kTurningMargin = 1.2;
// The most frames for a keyframe, or those of its interval if these are more.
constexpr int kMostInterval = 32;
// The interval where frames are allowed more time: something dearer draws them until two keyframes
// are there. Half of what is usual: until there is a third one the eye is no farther from the
// second one than it may be later.
constexpr int kAllowedInterval = 8;
// Columns of a step of what is captured in parts: so few that a frame's time is kept well, also by
// near objects, which come first and take several times the mean, and so many that all cores have
// work.
constexpr int kPart = KeyframeMaker::kBand / 4;
// What is being made for an eye that looks elsewhere, by so many radians, is given up.
constexpr double kElsewhere = 0.7;

double turn_between(const Camera& a, const Camera& b) {
  return std::acos(std::clamp(glm::dot(a.forward(), b.forward()), -1.0, 1.0));
}

}  // namespace

KeyframeProducer::KeyframeProducer(CaptureSource& source, CaptureSource& quick,
                                   const KeyframeOptions& options,
                                   std::vector<std::uint32_t> objects, NearObjects* near)
    : source_(source),
      coarse_(quick),
      options_(options),
      objects_(std::move(objects)),
      near_(near) {
  RILIEVO_EXPECTS(options.interval >= 1 && options.margin >= 1);
  if (options.beside) background_.emplace();
}

KeyframeProducer::~KeyframeProducer() { stop_.request_stop(); }

// Of a fine keyframe.
Camera KeyframeProducer::camera_with(const Camera& frame, KeyframeMargin margin) const {
  return keyframe_camera(
      frame, margin, 1,
      makes_quarters(options_.samples) ? Keyframe::kMostRowsWithQuarters : Keyframe::kMostRows);
}

// An eye's view, as the last frame's.
Camera KeyframeProducer::plain(const Camera& eye) const {
  Camera moved = frame_;
  moved.world_from_eye = eye.world_from_eye;
  return camera_with(moved, margin());
}

std::size_t KeyframeProducer::bytes() const {
  std::size_t bytes = 0;
  for (const std::vector<Keyframe>* list : {&ready_, &spare_})
    for (const Keyframe& key : *list)
      bytes += sizeof(std::uint32_t) * (key.color.texels().size() + key.object.texels().size()) +
               sizeof(float) * key.inverse_z.texels().size() +
               sizeof(LightCell) * key.light.cells.texels().size();
  return bytes;
}

KeyframeWork KeyframeProducer::take_work() { return std::exchange(done_, {}); }

void KeyframeProducer::choose() {
  chosen_.clear();
  double sum = 0;
  for (const Keyframe& key : ready_) sum += eye_distance(key, frame_);
  for (const Keyframe& key : ready_) chosen_.push_back({&key, keyframe_weight(key, frame_, sum)});
  spare_weak(chosen_);
}

std::span<const WarpedKeyframe> KeyframeProducer::follow(const Camera& frame, double time) {
  frame_ = frame;
  time_ = time;
  if (std::exchange(complete_, false)) add(maker_.take());
  prediction_.follow(frame);
  choose();
  return chosen_;
}

void KeyframeProducer::keep_memory(Keyframe keyframe) {
  // Small: whole ones would have to grow again.
  if (keyframe.coarse)
    coarse_.reuse(std::move(keyframe));
  else
    spare_.push_back(std::move(keyframe));
}

// Of those to come, wide enough for an eye that turns sideways: frames that are timed touch no new
// page.
void KeyframeProducer::add_spare() {
  resize(spare_.emplace_back(), widest(), makes_quarters(options_.samples));
}

// Of an eye that turns sideways: an eye that turns much upwards is rarer.
Camera KeyframeProducer::widest() const {
  return camera_with(frame_, {options_.margin * kTurningMargin, options_.margin});
}

void KeyframeProducer::reserve(const Camera& camera, double time) {
  RILIEVO_EXPECTS(!options_.beside && !any());
  frame_ = camera, time_ = time;
  take_memory();
  // Nothing is known yet of how the eye moves: a source grows its memory as a whole.
  maker_.begin(request_for(widest()), reusable());
  if (options_.keyframe_ms > 0 && maker_.takes_parts(source_)) maker_.start(source_);
  keep_memory(maker_.give_up());
}

void KeyframeProducer::take_memory() {
  RILIEVO_EXPECTS(!options_.beside);
  while (ready_.size() + spare_.size() + (maker_.busy() || complete_ ? 1 : 0) < kKept + kSpare)
    add_spare();
}

Keyframe KeyframeProducer::reusable() {
  if (spare_.empty()) return {};
  Keyframe key = std::move(spare_.back());
  spare_.pop_back();
  return key;
}

void KeyframeProducer::forget() {
  RILIEVO_EXPECTS(!options_.beside);
  if (maker_.busy() || std::exchange(complete_, false)) keep_memory(maker_.give_up());
  for (Keyframe& key : ready_) keep_memory(std::move(key));
  ready_.clear(), chosen_.clear(), left_out_.clear(), also_hidden_.clear();
}

bool KeyframeProducer::has_two() const {
  return std::count_if(ready_.begin(), ready_.end(),
                       [](const Keyframe& key) { return !key.coarse; }) >= 2;
}

bool KeyframeProducer::has_all() const {
  return has_two() || (any() && stands_at(frame_) && has_one_of(frame_));
}

KeyframeMargin KeyframeProducer::margin() const {
  const auto along = [&](double turning) {
    return options_.margin * (turning >= kTurning ? kTurningMargin : 1.0);
  };
  return {along(prediction_.turning_sideways()), along(prediction_.turning_upwards())};
}

// Is a keyframe for this eye one of where the frame's eye is, and stays?
bool KeyframeProducer::stands_at(const Camera& eye) const {
  const Camera standing = plain(frame_);
  return same_view(plain(eye), standing) && same_view(plain(prediction_.after(1)), standing);
}

// An eye that stands gets a sharp one.
bool KeyframeProducer::has_one_of(const Camera& eye) const {
  const Camera camera = plain(eye);
  const bool stands = stands_at(eye);
  return std::ranges::any_of(ready_, [&](const Keyframe& key) {
    return !key.coarse && (key.sharp || !stands) && same_view(key.camera, camera);
  });
}

// Of a fine keyframe.
KeyframeRequest KeyframeProducer::request_for(const Camera& camera) const {
  KeyframeRequest request;
  request.camera = camera, request.objects = objects_;
  request.samples = options_.samples;
  request.time = time_, request.sky = options_.sky;
  return request;
}

void KeyframeProducer::begin(const Camera& eye, double texels) {
  KeyframeRequest request = request_for(plain(eye));
  if (texels < 1) request.camera = keyframe_camera(request.camera, {1, 1}, texels);
  request.light_rays = options_.light_rays;
  request.sharp = texels == 1 && stands_at(eye);
  if (near_) {
    near_->choose(request.camera, frame_);
    // No objects would mean all.
    if (!near_->near().empty() && !near_->rest().empty()) {
      request.objects = near_->rest(), request.left_out = near_->near();
    }
  }
  // Its memory is that of a later one, too, when the eye may turn.
  if (spare_.empty() && options_.keyframe_ms > 0) add_spare();
  maker_.begin(request, reusable());
}

void KeyframeProducer::add(Keyframe keyframe) {
  if (options_.keyframe_ms == 0) typical_z_ = typical_depth(keyframe);
  // A coarse one is made where the others show little.
  std::size_t kept = keyframe.coarse ? 0 : kKept - 1;
  for (std::size_t i = ready_.size(); i-- > 0;) {
    // Of the others the newest stay; a coarse one until two others are there.
    if (kept > 0) {
      --kept;
      continue;
    }
    keep_memory(std::move(ready_[i]));
    ready_.erase(ready_.begin() + std::ptrdiff_t(i));
  }
  keyframe.number = ++made_;
  ready_.push_back(std::move(keyframe));
  if (near_ || !also_hidden_.empty()) hide_objects_of_all();
  while (spare_.size() > kSpare && ready_.size() + spare_.size() > kKept + kSpare)
    spare_.erase(spare_.begin());
}

// What one keyframe does not show is drawn as polygons: none may show it.
void KeyframeProducer::hide_objects_of_all() {
  left_out_.clear();
  for (const Keyframe& key : ready_)
    left_out_.insert(left_out_.end(), key.left_out.begin(), key.left_out.end());
  std::ranges::sort(left_out_);
  left_out_.erase(std::unique(left_out_.begin(), left_out_.end()), left_out_.end());
  scratch_.clear();
  std::ranges::set_union(left_out_, also_hidden_, std::back_inserter(scratch_));
  for (Keyframe& key : ready_) {
    hidden_.clear();
    std::ranges::set_difference(scratch_, key.left_out, std::back_inserter(hidden_));
    hide_objects(key, hidden_);
  }
}

void KeyframeProducer::hide(std::span<const std::uint32_t> objects) {
  if (std::ranges::equal(objects, also_hidden_)) return;
  also_hidden_.assign(objects.begin(), objects.end());
  hide_objects_of_all();
}

Result<> KeyframeProducer::make_whole() {
  begin(frame_);
  // A source that captures in parts takes its memory for these now, not when frames are timed,
  // whose steps are smaller.
  const int columns =
      maker_.takes_parts(source_) ? maker_.camera().width / kFirstSteps + 1 : 1 << 20;
  while (maker_.busy())
    if (Result<> made = maker_.step(source_, columns); !made) return made.error();
  add(maker_.take());
  ++done_.completed;
  if (!(options_.keyframe_ms > 0)) return Done{};
  while (spare_.size() < kSpare) add_spare();
  coarse_.take_memory(frame_, objects_, time_);
  return Done{};
}

std::span<const WarpedKeyframe> KeyframeProducer::choose_for(const Camera& eye) {
  frame_ = eye;
  choose();
  return chosen_;
}

Result<std::span<const WarpedKeyframe>> KeyframeProducer::make_now() {
  const Stopwatch watch;
  const bool coarse = options_.beside || (options_.keyframe_ms > 0 && any());
  if (ordered_) {
    // For where the eye was: the sooner it ends the better.
    stop_.request_stop();
  } else if ((maker_.busy() || complete_) && (!coarse || prediction_.jumped())) {
    // Beside a coarse one it goes on: else an eye that moves fast would never get another.
    complete_ = false;
    keep_memory(maker_.give_up());
  }
  if (coarse) {
    Result<Keyframe> made = coarse_.make(frame_, objects_, time_);
    if (!made) return made.error();
    add(std::move(*made));
    ++done_.coarse;
  } else {
    if (Result<> made = make_whole(); !made) return made.error();
  }
  done_.ms += watch.ms();
  choose();
  return {std::span<const WarpedKeyframe>(chosen_)};
}

// With twice the time a keyframe comes twice as soon, and frames have half as many holes: both
// together take the least if they take the same.
double KeyframeProducer::ms_a_frame() const {
  return std::max({options_.keyframe_ms, holes_ms_, allowed_ms_, share_ms_});
}

// Where time does not count an eye that moves fast gets a keyframe after fewer frames: else it
// would have gone half around what it looks at before the next one is there.
int KeyframeProducer::interval_at_speed() const {
  if (options_.keyframe_ms > 0 || !prediction_.speed_known() || !(typical_z_ > 0))
    return options_.interval;
  const double step = glm::length(prediction_.after(1).position() - frame_.position());
  return int(std::clamp(options_.most_travel * typical_z_ / std::max(step, 1e-300), 1.0,
                        double(options_.interval)));
}

// The median depth of what its blocks show nearest; 0: it shows the sky alone.
double KeyframeProducer::typical_depth(const Keyframe& keyframe) {
  nearest_.clear();
  for (const InverseRange& block : keyframe.blocks.texels())
    if (!block.empty()) nearest_.push_back(block.nearest);
  if (nearest_.empty()) return 0;
  const auto middle = nearest_.begin() + std::ptrdiff_t(nearest_.size() / 2);
  std::ranges::nth_element(nearest_, middle);
  return 1 / double(*middle);
}

KeyframeProducer::Columns KeyframeProducer::columns_a_frame() const {
  constexpr int kBand = KeyframeMaker::kBand;
  const int width = camera_with(frame_, margin()).width;
  const auto of_frames = [&](int frames) {
    const int columns = (width + frames - 1) / frames;
    return (columns + kBand - 1) / kBand * kBand;
  };
  // No more than needed; but an eye soon is where a keyframe that takes too many frames shows
  // little.
  const int interval = interval_at_speed();
  const int most = of_frames(allowed_ms_ > 0 ? std::min(interval, kAllowedInterval) : interval),
            least = std::min(of_frames(kMostInterval), most);
  int expected = most;
  double a_frame = most;
  if (options_.keyframe_ms > 0 && ms_per_column_ > 0) {
    const double in_time = std::min(ms_a_frame() / ms_per_column_, 1e6);
    expected = std::clamp(int(in_time) / kBand * kBand, least, most);
    a_frame = maker_.in_parts() ? std::clamp(in_time, double(least), double(most)) : expected;
  }
  const double frames = std::ceil(width / a_frame);
  if (at_once_) {
    // One that was begun may be wider.
    const int all = std::max(width, maker_.busy() ? maker_.columns_left() : 0);
    return {least, all, all, frames};
  }
  return {least, most, expected, frames};
}

// Makes a part of a keyframe; returns how many columns.
Result<int> KeyframeProducer::step(const Columns& columns, const Stopwatch& watch) {
  const int before = maker_.columns_left();
  const auto done = [&] { return before - maker_.columns_left(); };
  if (options_.keyframe_ms > 0 && maker_.takes_parts(source_)) maker_.start(source_);
  if (!maker_.in_parts() || !(options_.keyframe_ms > 0)) {
    if (Result<> made = maker_.step(source_, columns.expected); !made) return made.error();
    return done();
  }
  // Parts of a keyframe take different times: what counts is that all of it takes not too many
  // frames, by what the last one took. Of one that takes more, each frame makes its share.
  const double whole_ms = measured_ ? ms_per_column_ * maker_.camera().width : 0;
  const double wanted_ms = at_once_ ? kAtOnce : std::max(ms_a_frame(), whole_ms / kMostInterval);
  // To start takes as long as several parts.
  const int least = made_frames_ == 0 ? 0 : made_frames_ < kMostInterval ? 1 : columns.least;
  ++made_frames_;
  double last_ms = 0;
  while (maker_.busy() && done() < columns.most) {
    // As near to the time as whole parts come.
    const double begun_ms = watch.ms();
    if (done() >= least && begun_ms + last_ms / 2 >= wanted_ms) break;
    if (Result<> made = maker_.step(source_, std::min(kPart, columns.most - done())); !made)
      return made.error();
    last_ms = watch.ms() - begun_ms;
  }
  return done();
}

// Of what is made at once the first one is for the eye as it is, and the second one for where it
// will be when a third one is complete.
double KeyframeProducer::frames_ahead(const Columns& columns) const {
  if (at_once_) return any() ? columns.frames : 0;
  return 2 * columns.frames;
}

Result<> KeyframeProducer::work(double holes_ms, double allowed_ms, double share_ms) {
  if (options_.beside) return work_beside();
  // What is made at once says nothing of those that come then.
  at_once_ = allowed_ms == kAtOnce, allowed_ms_ = at_once_ ? 0 : allowed_ms;
  holes_ms_ += (holes_ms - holes_ms_) * kNewestHoles, share_ms_ = share_ms;
  // Beside frames this thread makes all of it, and waits for them. Frames that go on with it take
  // its processor time, on all threads. A part says nothing: the first ones take the longest.
  const bool by_frames = !beside_frames();
  if (by_frames && processor_columns_ > 0) {
    if (processor_columns_ >= frame_.width) ms_per_column_ = processor_ms_ / processor_columns_;
    processor_ms_ = 0, processor_columns_ = 0;
  }
  const Columns columns = columns_a_frame();
  if (maker_.busy() && turn_between(maker_.camera(), frame_) > kElsewhere)
    keep_memory(maker_.give_up());
  const Stopwatch watch;
  const ThreadWatch processor;
  if (!maker_.busy()) {
    const Camera eye = prediction_.after(frames_ahead(columns));
    if (!prediction_.speed_known() || has_one_of(eye)) return Done{};
    begin(eye);
    made_ms_ = made_visibility_ms_ = 0, made_columns_ = 0, made_frames_ = 0;
  }
  const bool shaded = maker_.shades();
  const Result<int> made = step(columns, watch);
  if (!made) return made.error();
  const double ms = watch.ms();
  done_.ms += ms;
  note_cost(ms, *made, shaded ? 0 : ms);
  if (!by_frames)
    processor_ms_ += processor.ms() / threads_of_frames(), processor_columns_ += *made;
  if (!maker_.busy()) complete_ = true, ++done_.completed;
  return Done{};
}

void KeyframeProducer::note_cost(double ms, int columns, double visibility_ms) {
  made_ms_ += ms, made_columns_ += columns, made_visibility_ms_ += visibility_ms;
  if (made_columns_ == 0) return;
  if (!measured_ || (maker_.in_parts() && !maker_.busy()))
    // What is visible is found first, and shaded then: only the whole says what a column takes.
    ms_per_column_ = made_ms_ / made_columns_;
  else if (!maker_.in_parts())
    ms_per_column_ += (ms / columns - ms_per_column_) * kNewestCost;
  measured_ = measured_ || !maker_.busy();
  if (maker_.busy()) return;
  visibility_ms_ = made_visibility_ms_, shading_ms_ = made_ms_ - made_visibility_ms_;
}

void KeyframeProducer::take_complete() {
  RILIEVO_EXPECTS(!options_.beside);
  if (!std::exchange(complete_, false)) return;
  add(maker_.take());
  choose();
}

// What is visible takes a source as long for a frame's samples as for a keyframe's quarters, of
// what is in view. But each quarter is shaded by itself, and of most pixels one sample.
double KeyframeProducer::frame_ms() const {
  if (visibility_ms_ + shading_ms_ == 0) return 0;
  const Camera key = camera_with(frame_, margin());
  const double pixels = double(frame_.width) * frame_.height;
  const double texels = double(key.width) * key.height;
  const int shaded = makes_quarters(options_.samples) ? 4 : 1;
  return visibility_ms_ * std::sqrt(pixels / texels) + shading_ms_ * pixels / (texels * shaded);
}

}  // namespace rilievo
