#include "rilievo/method/relief_impostors.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "rilievo/render/draw_list.h"

namespace rilievo {
namespace {

// A picture, its warp, the picture again if the first was for another eye, and its warp.
constexpr int kSettleRounds = 6;
// A frame that took longer says nothing of the next, seconds.
constexpr double kLongestFrame = 0.5;
// Over this time speeds and turns are averaged, as frames are not alike; seconds.
constexpr double kSmooth = 0.15;

// The camera at capture of an object that has moved since.
Camera camera_before(const Camera& camera, const glm::dmat4& motion) {
  Camera before = camera;
  before.world_from_eye = glm::inverse(motion) * camera.world_from_eye;
  for (int k = 0; k < 3; ++k)
    before.world_from_eye[k] = glm::dvec4(glm::normalize(glm::dvec3(before.world_from_eye[k])), 0);
  return before;
}

// The turn from one step to the next, as a rotation vector.
glm::dvec3 turn_between(const glm::dvec3& before, const glm::dvec3& now) {
  const glm::dvec3 axis = glm::cross(before, now);
  const double sine = glm::length(axis);
  return sine > 0 ? axis / sine * std::atan2(sine, glm::dot(before, now)) : glm::dvec3(0);
}

}  // namespace

ImpostorChooser::ImpostorChooser(const PlacedScene& placed, std::unique_ptr<PrewarpedBoards> boards,
                                 ImpostorContent content, const ImpostorFramesOptions& options)
    : content_(std::move(content)),
      options_(options),
      drawable_(std::make_unique<ImpostorDrawable>(std::move(boards), content_.impostors.size())) {
  const std::size_t objects = placed.scene().objects.size();
  impostor_of_.assign(objects, -1);
  polygons_.assign(objects, 0);
  std::vector<CaptureSource*> sources;
  for (const auto& source : content_.sources) sources.push_back(source.get());
  std::vector<ImpostorObject> shown;
  for (const ShadedImpostor& impostor : content_.impostors) {
    for (const std::uint32_t object : impostor.objects) impostor_of_[object] = int(shown.size());
    Followed followed;
    followed.place.objects = impostor.objects;
    // What stands for several objects stays where it is.
    if (impostor.objects.size() == 1)
      followed.place.object_from_capture =
          glm::inverse(glm::dmat4(placed.poses()[impostor.objects[0]]));
    followed_.push_back(std::move(followed));
    statuses_.push_back({impostor.objects.empty() ? 0 : impostor.objects[0], false, {}});
    shown.push_back(impostor.shown);
  }
  workers_ =
      std::make_unique<ImpostorWorkers>(std::move(sources), std::move(shown), options.workers);
}

void ImpostorChooser::add_sets(FrameContent& content) {
  content.sets.push_back({drawable_.get(), {}});
}

bool ImpostorChooser::shows_blended(std::uint32_t object) const {
  return impostor_of_[object] >= 0 && !polygons_[object];
}

// None if the object cannot be moved back to where it was captured.
std::optional<ImpostorEye> ImpostorChooser::eye_of(std::size_t impostor, const Camera& camera,
                                                   const PlacedScene& placed) {
  Followed& followed = followed_[impostor];
  if (followed.place.objects.size() == 1) {
    const auto motion = motion_of(followed.place, placed.poses()[followed.place.objects[0]]);
    if (!motion) return std::nullopt;
    followed.motion = *motion;
  }
  const Camera before = camera_before(camera, followed.motion);
  const FrameView view = follow(followed.eyes, before);
  ImpostorEye eye = impostor_eye(before);
  if (content_.impostors[impostor].shown.deforms > 0) eye.time = placed.time();
  // Where frames wait, pictures are for their own eyes: nothing depends on the clock.
  if (options_.background && frame_s_ > 0) {
    const glm::dvec3 step = followed.eyes.step;
    const double rate = glm::length(step) / frame_s_, share = 1 - std::exp(-frame_s_ / kSmooth);
    // A jump is not a motion: follow() gives it no velocity.
    const bool jumps = glm::length(view.velocity) < 0.25 * glm::length(step);
    if (!jumps) {
      followed.speed += share * (rate - followed.speed);
      followed.turn += share * (turn_between(followed.step, step) / frame_s_ - followed.turn);
      if (rate > 0) eye.velocity = step * (followed.speed / (rate * frame_s_));
      eye.turn = followed.turn;
    }
    followed.step = step;
  }
  followed.eye = eye;
  return eye;
}

// Until nothing is ordered any more for what is in view; what fails stays as it is.
void ImpostorChooser::settle() {
  for (int round = 0; round < kSettleRounds; ++round) {
    workers_->wait_until_idle();
    bool done = true;
    for (std::size_t i = 0; i < statuses_.size(); ++i) {
      if (!statuses_[i].in_view) continue;
      ImpostorFrame& frame = statuses_[i].frame;
      frame = workers_->frame(i, followed_[i].eye);
      done = done && !frame.warping && !frame.rendering;
    }
    if (done) return;
  }
  workers_->wait_until_idle();
}

Result<> ImpostorChooser::choose(const Camera& camera, const PlacedScene& placed,
                                 FrameContent& content, FrameStats& stats) {
  content.outlines = options_.outlines;
  if (options_.background) workers_->begin_frame();
  const double frame_s = since_frame_.ms() / 1e3;
  frame_s_ = frame_s < kLongestFrame ? frame_s : 0;
  since_frame_ = Stopwatch();

  const Frustum frustum = frustum_of(camera);
  for (std::size_t i = 0; i < statuses_.size(); ++i) {
    ImpostorStatus& status = statuses_[i];
    status.frame = {};
    const std::optional<ImpostorEye> eye = eye_of(i, camera, placed);
    status.in_view =
        eye && !workers_->bounds(i).empty() &&
        may_touch(frustum, transformed(glm::mat4(followed_[i].motion), workers_->bounds(i)));
    if (status.in_view) status.frame = workers_->frame(i, *eye);
  }
  if (!options_.background) settle();

  drawable_->begin();
  for (std::size_t i = 0; i < statuses_.size(); ++i) {
    ImpostorStatus& status = statuses_[i];
    ImpostorFrame& frame = status.frame;
    const bool polygons = content_.impostors[i].shown.drawable;
    if (frame.board && !drawable_->show(i, frame))
      frame.shown = polygons ? ImpostorShown::object : ImpostorShown::nothing;
    else if (frame.board)
      content.sets[0].instances.push_back(
          {followed_[i].motion, std::uint32_t(i), status.object + 1});
    for (const std::uint32_t object : content_.impostors[i].objects)
      polygons_[object] = polygons && frame.shown == ImpostorShown::object;
  }
  placed.cull(camera, content.polygons);
  std::erase_if(content.polygons, [&](std::uint32_t object) {
    return impostor_of_[object] >= 0 && !polygons_[object];
  });

  const std::uint64_t rendered = content_.rendered();
  stats.captures = int(rendered - std::exchange(rendered_, rendered));
  const double render_ms = workers_->stats().render_ms;
  const double taken = render_ms - std::exchange(render_ms_, render_ms);
  // In the background they are in no frame.
  stats.capture_ms = options_.background ? 0 : taken;
  stats.picture_bytes = drawable_->bytes();
  return Done{};
}

void ImpostorChooser::drawn(const FrameWork*, FrameStats&) { workers_->end_frame(); }

Result<ImpostorFrames> make_impostor_frames(Backend& backend, ImpostorContent content,
                                            const ImpostorFramesOptions& options) {
  Result<std::unique_ptr<PrewarpedBoards>> boards = backend.make_boards();
  if (!boards) return boards.error();
  auto chooser = std::make_unique<ImpostorChooser>(backend.placed(), std::move(*boards),
                                                   std::move(content), options);
  ImpostorFrames made;
  made.chooser = chooser.get();
  Result<std::unique_ptr<FrameSource>> frames = backend.make_frames(std::move(chooser));
  if (!frames) return frames.error();
  made.frames = std::move(*frames);
  return made;
}

}  // namespace rilievo
