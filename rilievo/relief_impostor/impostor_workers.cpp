#include "rilievo/relief_impostor/impostor_workers.h"

#include <sched.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <thread>

#include "rilievo/capture/picture_camera.h"
#include "rilievo/core/box_distance.h"
#include "rilievo/core/box_view.h"
#include "rilievo/core/on_this_thread.h"
#include "rilievo/relief_impostor/critical_points.h"
#include "rilievo/relief_impostor/frame_gate.h"
#include "rilievo/relief_impostor/impostor_slot.h"

namespace rilievo {
namespace {

// Of this thread alone. Niceness does not do: where each core is taken, by the frame or by a nice
// worker, the frame's threads that wake up may come to share one, and wait for each other.
void give_way() {
  const sched_param none{};
  (void)sched_setscheduler(0, SCHED_IDLE, &none);
}

// How much too coarse the picture's texels are for the eye; below 1, they are too fine. No finer
// ones can be had than `size` texels for the whole.
double coarseness(const PictureGeometry& picture, const PlaneWarp& warp, double focal_px,
                  const WorkerOptions& options) {
  const Camera& camera = picture.capture;
  const double texel = (camera.window.right - camera.window.left) / camera.width * picture.plane_z;
  const double finest = texel * std::max(camera.width, camera.height) / options.size;
  return texel / std::max(finest, warp.height / focal_px / options.texels_per_px);
}

// The widest that a picture may reach beside the frame's axis, tangents: 68 degrees.
constexpr double kWidest = 2.5;

// A camera with the frame's rotation whose texels lie on the frame's pixels, so that a frame that
// shows the picture from its own eye need not resample it. None where the bounds reach too far
// beside the axis, or need more than `max_size` texels.
std::optional<Camera> camera_on_pixels(const Box& bounds, const ImpostorEye& eye, double texel,
                                       int max_size) {
  if (!eye.grid) return std::nullopt;
  Camera camera;
  camera.projection = Projection::perspective;
  camera.world_from_eye = glm::dmat4(eye.grid->world_from_eye);
  camera.world_from_eye[3] = glm::dvec4(eye.position, 1);
  const BoxView view = view_of_box(eye_from_world(camera), bounds, camera.projection);
  const ImageWindow& w = view.window;
  if (!(view.nearest > 0) || !(view.nearest > 1e-3 * view.farthest) ||
      std::max({-w.left, w.right, -w.bottom, w.top}) >= kWidest)
    return std::nullopt;
  // In doubles first: a narrow view has more texels than an int counts.
  if (std::max(w.right - w.left, w.top - w.bottom) > max_size * texel) return std::nullopt;
  camera.window = w;
  align_to_texels(eye.grid->corner.x, texel, camera.window.left, camera.window.right, camera.width);
  align_to_texels(eye.grid->corner.y, texel, camera.window.bottom, camera.window.top,
                  camera.height);
  if (std::max(camera.width, camera.height) > max_size) return std::nullopt;
  // So that single precision does not cut off what lies on the box.
  camera.z_near = view.nearest * (1 - 1e-4), camera.z_far = view.farthest * (1 + 1e-4);
  return camera;
}

}  // namespace

Result<Camera> impostor_camera(const Box& bounds, const ImpostorEye& eye,
                               const WorkerOptions& options) {
  if (const auto camera =
          camera_on_pixels(bounds, eye, 1 / (eye.focal_px * options.texels_per_px), options.size))
    return *camera;
  Result<Camera> camera = tight_camera(Projection::perspective, eye.position, eye.up, bounds);
  if (!camera) return camera;
  const ImageWindow& w = camera->window;
  const double across = w.right - w.left, down = w.top - w.bottom;
  const double texel =
      std::max(std::max(across, down) / options.size, 1 / (eye.focal_px * options.texels_per_px));
  camera->width = std::max(1, int(std::ceil(across / texel - 1e-9)));
  camera->height = std::max(1, int(std::ceil(down / texel - 1e-9)));
  return camera;
}

namespace {

// The newest value. The last one before it that is finished goes to `before`.
template <class Value>
void take_newest(TripleBuffer<Value>& buffer, Value& before) {
  if (!buffer.has_news()) return;
  if (buffer.front().final) std::swap(buffer.front(), before);
  (void)buffer.update();
}

}  // namespace

struct ImpostorWorkers::State {
  WorkerOptions options;
  std::vector<CaptureSource*> sources;
  std::vector<std::unique_ptr<ImpostorSlot>> slots;
  // Rises with each order, and when something is done: what sleeping workers watch.
  std::atomic<std::uint32_t> warp_bell{0}, render_bell{0}, done_bell{0};
  std::atomic<bool> ends{false};
  FrameGate gate;
  std::stop_source shutdown;
  std::atomic<std::uint64_t> warps{0}, pictures{0}, coarse{0}, cancelled{0}, failed{0};
  std::atomic<double> warp_ms{0}, render_ms{0};
  mutable std::mutex error_mutex;  // of failed captures; the frame's thread does not take it
  std::string error;
  std::vector<std::thread> threads;

  static void ring(std::atomic<std::uint32_t>& bell) {
    bell.fetch_add(1, std::memory_order_acq_rel);
    bell.notify_all();
  }

  // The most urgent work that nobody does.
  [[nodiscard]] ImpostorSlot* take(ImpostorWork ImpostorSlot::*work) {
    while (true) {
      ImpostorSlot* best = nullptr;
      double most = -1;
      for (const auto& slot : slots) {
        const ImpostorWork& of = (*slot).*work;
        if (!of.wanted.load(std::memory_order_acquire) || of.busy.load(std::memory_order_acquire))
          continue;
        const double priority = of.priority.load(std::memory_order_relaxed);
        if (priority > most) most = priority, best = slot.get();
      }
      if (!best || (best->*work).take()) return best;
    }
  }

  template <class Do>
  void serve(std::atomic<std::uint32_t>& bell, ImpostorWork ImpostorSlot::*work, Do&& what) {
    const OnThisThread alone;
    if (options.gives_way) give_way();
    while (!ends.load(std::memory_order_acquire)) {
      const std::uint32_t heard = bell.load(std::memory_order_acquire);
      if (ImpostorSlot* slot = take(work)) {
        what(*slot);
        (slot->*work).busy.store(false, std::memory_order_release);
        // What was ordered meanwhile could not be taken by others.
        ring(bell);
        ring(done_bell);
      } else {
        bell.wait(heard, std::memory_order_acquire);
      }
    }
  }

  void do_warp(ImpostorSlot& slot) {
    // It was ordered for the frame after the one that is drawn.
    if (options.gives_way) BackgroundWork(gate).wait(shutdown.get_token());
    slot.warp_eyes.update();
    take_newest(slot.pictures, slot.before);
    const NumberedImpostor &from = slot.pictures.front(), &before = slot.before;
    slot.warps_before.store(before.number, std::memory_order_relaxed);
    slot.warps_from.store(from.number, std::memory_order_release);
    ImpostorWarpResult& result = slot.boards.back();
    const Stopwatch watch;
    const glm::dvec3& eye = slot.warp_eyes.front();
    const ImpostorWarpOptions alone{.parallel = false};
    const auto counted =
        from.final && before.final && !options.alone && slot.object.deforms == 0
            ? warp_pair(from.picture, before.picture, eye, alone, slot.scratch, result.board)
            : warp_impostor(from.picture, eye, alone, slot.scratch.main, result.board);
    if (!counted) return;
    encode_prewarped(result.board, {0, 0, result.board.width(), result.board.height()},
                     result.encoded);
    result.interpolated = counted->share();
    result.picture = from.number;
    result.time = from.time;
    result.made = from.made;
    slot.boards.publish();
    warps.fetch_add(1, std::memory_order_relaxed);
    warp_ms.fetch_add(watch.ms(), std::memory_order_relaxed);
  }

  // A picture is complete: to the frame and to the warping worker.
  void publish(ImpostorSlot& slot, const DepthImage& picture, bool final,
               const ImpostorEye& order) {
    NumberedImpostor& to = slot.pictures.back();
    to.picture = impostor_picture(picture);
    if (to.picture.empty()) {
      if (!final) return;
      // There is nothing to warp, but the frame must know, or it would order the same for ever.
      slot.empties.back() = {order.position, order.time,
                             slot.published.load(std::memory_order_relaxed)};
      slot.empties.publish();
      pictures.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    to.final = final;
    to.time = order.time;
    to.number = slot.published.fetch_add(1, std::memory_order_relaxed) + 1;
    ImpostorJudgement& judged = slot.judgements.back();
    judged.geometry = to.picture.geometry;
    judged.pairs = critical_pairs(to.picture, options.regions);
    judged.final = final;
    judged.time = order.time;
    judged.picture = to.number;
    judged.made = to.made = Stopwatch();
    slot.pictures.publish();
    // After the picture: who knows of it can have it warped.
    slot.judgements.publish();
    (final ? pictures : coarse).fetch_add(1, std::memory_order_relaxed);
  }

  void fail(const Error& why) {
    failed.fetch_add(1, std::memory_order_relaxed);
    const std::lock_guard lock(error_mutex);
    error = why.message();
  }

  void do_render(ImpostorSlot& slot, CaptureSource& source) {
    slot.render_orders.update();
    const ImpostorEye order = slot.render_orders.front();
    // The frame may stop this one from now on.
    std::stop_source stop;
    slot.stops.back() = stop;
    slot.stops.publish();
    const std::stop_callback at_the_end(shutdown.get_token(), [&] { stop.request_stop(); });
    const Result<Camera> camera = impostor_camera(slot.bounds, order, options);
    if (!camera) return fail(camera.error());
    CaptureControl control;
    control.stop = stop.get_token();
    control.refined = [&](const CapturedPicture& coarser) {
      if (stop.stop_requested() || !slot.coarse_helps.load(std::memory_order_relaxed)) return;
      if (control.give_way) control.give_way();
      publish(slot, coarser.picture, false, order);
    };
    BackgroundWork work(gate);
    if (options.gives_way) control.give_way = [&] { work.wait(control.stop); };
    CaptureRequest request;
    request.camera = *camera;
    request.objects = slot.object.objects;
    request.samples = options.samples;
    request.identifiers = false;
    request.control = &control;
    request.time = order.time;
    const Stopwatch watch;
    const Result<CapturedPicture> captured = source.capture(request);
    const double took = watch.ms();
    render_ms.fetch_add(took, std::memory_order_relaxed);
    if (stop.stop_requested()) {
      // It takes longer than that; twice as long finds the right time soon.
      if (2e-3 * took > slot.render_s.load(std::memory_order_relaxed))
        slot.render_s.store(2e-3 * took, std::memory_order_relaxed);
      cancelled.fetch_add(1, std::memory_order_relaxed);
      return;
    }
    if (!captured) return fail(captured.error());
    slot.render_s.store(took / 1e3, std::memory_order_relaxed);
    if (control.give_way) control.give_way();
    publish(slot, captured->picture, true, order);
  }
};

ImpostorWorkers::ImpostorWorkers(std::vector<CaptureSource*> sources,
                                 std::vector<ImpostorObject> objects, const WorkerOptions& options)
    : state_(std::make_unique<State>()) {
  RILIEVO_EXPECTS(!sources.empty() && options.size > 0 && options.regions > 0);
  State& s = *state_;
  s.options = options;
  s.sources = std::move(sources);
  for (ImpostorObject& object : objects) {
    auto slot = std::make_unique<ImpostorSlot>();
    slot->bounds = s.sources.front()->bounds(object.objects);
    slot->object = std::move(object);
    s.slots.push_back(std::move(slot));
  }
  s.threads.emplace_back([&s] {
    s.serve(s.warp_bell, &ImpostorSlot::warp, [&](ImpostorSlot& slot) { s.do_warp(slot); });
  });
  for (CaptureSource* source : s.sources)
    s.threads.emplace_back([&s, source] {
      s.serve(s.render_bell, &ImpostorSlot::render,
              [&](ImpostorSlot& slot) { s.do_render(slot, *source); });
    });
}

ImpostorWorkers::~ImpostorWorkers() {
  State& s = *state_;
  s.ends.store(true, std::memory_order_release);
  s.shutdown.request_stop();
  State::ring(s.warp_bell);
  State::ring(s.render_bell);
  for (std::thread& thread : s.threads) thread.join();
}

void ImpostorWorkers::begin_frame() { state_->gate.begin_frame(); }
void ImpostorWorkers::end_frame() { state_->gate.end_frame(); }
bool ImpostorWorkers::drawing_frame() const { return state_->gate.drawing(); }

ImpostorFrame ImpostorWorkers::frame(std::size_t object, const ImpostorEye& eye) {
  State& s = *state_;
  RILIEVO_EXPECTS(object < s.slots.size());
  ImpostorSlot& slot = *s.slots[object];
  // Read before the results: what is no longer pending then has its result here.
  ImpostorSituation now;
  now.warping = slot.warp.pending();
  now.rendering = slot.render.pending();
  take_newest(slot.judgements, slot.judged_before);
  const bool changed = slot.boards.update();
  slot.boards_seen += changed;
  slot.empties.update();
  slot.stops.update();

  constexpr double kNever = std::numeric_limits<double>::infinity();
  const ImpostorJudgement &judged = slot.judgements.front(), &before = slot.judged_before;
  const ImpostorWarpResult& board = slot.boards.front();
  now.drawable = slot.object.drawable;
  now.picture = judged.picture > 0;
  now.final = judged.final;
  const auto stretch_of_one = [&](const ImpostorJudgement& of, const glm::dvec3& from) {
    const auto warp = plane_warp(of.geometry, from);
    if (!warp || !std::isfinite(largest_move(of.geometry, *warp))) return kNever;
    const double coarse = coarseness(of.geometry, *warp, eye.focal_px, s.options);
    // Texels that are up to 1.5 times too small are only slow.
    return stretch_of(of.geometry, of.pairs, *warp).mean *
           std::max({1.0, coarse, 1 / (1.5 * coarse)});
  };
  // Of two pictures, the better one; but the warping worker may have missed one of those that the
  // frame has seen, and have another one before.
  const bool missed = slot.warps_from.load(std::memory_order_acquire) == judged.picture &&
                      slot.warps_before.load(std::memory_order_relaxed) != before.picture;
  const bool pair =
      judged.final && before.final && !missed && !s.options.alone && slot.object.deforms == 0;
  const auto stretch_from = [&](const glm::dvec3& from) {
    const double one = stretch_of_one(judged, from);
    return pair ? std::min(one, stretch_of_one(before, from)) : one;
  };
  now.stretch = now.picture ? stretch_from(eye.position) : kNever;
  slot.coarse_helps.store(!(judged.final && now.stretch <= s.options.limits.drop),
                          std::memory_order_relaxed);
  now.warped = board.picture > 0;
  if (now.warped) {
    const PictureGeometry& geometry = board.board.geometry;
    const auto warp = plane_warp(geometry, eye.position);
    const double texel =
        (geometry.capture.window.right - geometry.capture.window.left) / geometry.capture.width;
    now.moved_px = warp ? largest_move(geometry, *warp) * texel * eye.focal_px : kNever;
    // A newer picture is there: what is shown is not what could be.
    if (board.picture < judged.picture)
      now.moved_px = std::max(now.moved_px, 1.01 * s.options.limits.still_px);
  }
  // What deforms has moved by so much since, at the nearest place where it can be.
  const double nearest = std::max(1e-9, distance_to(slot.bounds, eye.position));
  const auto deformed_px = [&](double since) {
    const ImpostorObject& of = slot.object;
    double metres = of.deforms * std::abs(eye.time - since);
    if (of.period > 0)
      metres +=
          of.jump * std::abs(std::floor(eye.time / of.period) - std::floor(since / of.period));
    return metres / nearest * eye.focal_px;
  };
  if (now.picture) now.deformed_px = deformed_px(judged.time);
  if (now.warped) now.shown_deformed_px = deformed_px(board.time);
  // Of a picture that is on its way, the relief is not known yet: as stretched as this one would be
  // if it had been taken as far from where the eye is when it is done.
  const double render_s =
      std::min(slot.render_s.load(std::memory_order_relaxed), s.options.predict_s);
  // Pictures are for the end of their time, so that the eye is between the last two of them.
  const double ahead_s = std::min(2 * render_s, s.options.predict_s), lead_s = ahead_s - render_s;
  if (now.picture) now.later_stretch = stretch_from(predicted_eye(eye, render_s));
  // Without a relief, as far as the eye has gone of the way to the object.
  const auto stretch_beside = [&](const glm::dvec3& beside) {
    return 1 + glm::length(beside) /
                   std::max(1e-9, glm::length(eye.position - glm::dvec3(slot.bounds.center())));
  };
  const ImpostorEmpty& empty = slot.empties.front();
  // What an empty picture says of other eyes is nothing: it serves the one that it was made for,
  // give or take a hundredth of the way to the object, and not even that where the picture before
  // it fits better.
  constexpr double kSameEye = 1.01;
  const double from_empty = stretch_beside(eye.position - empty.eye);
  now.empty =
      empty.after == judged.picture && deformed_px(empty.time) <= s.options.limits.still_px &&
      std::max(from_empty, stretch_beside(predicted_eye(eye, render_s) - empty.eye)) <= kSameEye &&
      !(now.picture && now.stretch <= from_empty);
  if (now.rendering) {
    const double remaining = std::max(0.0, render_s - slot.ordered.ms() / 1e3);
    const glm::dvec3 beside = predicted_eye(eye, remaining + lead_s) - slot.ordered_eye;
    now.rendered_stretch = now.picture
                               ? stretch_of_one(judged, judged.geometry.capture.position() + beside)
                               : stretch_beside(beside);
  }

  const ImpostorStep step = next_step(now, s.options.limits);
  if (step.cancel_render) slot.stops.front().request_stop();
  if (step.order_render) {
    slot.ordered_eye = predicted_eye(eye, ahead_s);
    slot.ordered = Stopwatch();
    slot.render_orders.back() = eye;
    slot.render_orders.back().position = slot.ordered_eye;
    if (!slot.needed) slot.needed.emplace();
    slot.render_orders.publish();
    slot.render.priority.store(render_priority(now), std::memory_order_relaxed);
    slot.render.wanted.store(true, std::memory_order_release);
    State::ring(s.render_bell);
  }
  if (step.order_warp) {
    slot.warp_eyes.back() = eye.position;
    slot.warp_eyes.publish();
    slot.warp.priority.store(std::min(now.moved_px, 1e9), std::memory_order_relaxed);
    slot.warp.wanted.store(true, std::memory_order_release);
    State::ring(s.warp_bell);
  }
  ImpostorFrame frame;
  frame.shown = step.shown;
  frame.picture = judged.picture;
  frame.final = judged.final;
  frame.warping = step.order_warp || now.warping;
  frame.rendering = step.order_render || now.rendering;
  if (step.shown == ImpostorShown::fresh || step.shown == ImpostorShown::stale) {
    frame.board = &board.board;
    frame.encoded = &board.encoded;
    frame.age_ms = board.made.ms();
    if (board.picture > slot.shown && slot.needed) {
      frame.latency_ms = slot.needed->ms();
      slot.needed.reset();
    }
    slot.shown = board.picture;
  }
  frame.changed = changed;
  frame.board_number = slot.boards_seen;
  frame.stretch = now.stretch;
  frame.moved_px = now.moved_px;
  frame.deformed_px = now.shown_deformed_px;
  frame.interpolated = board.interpolated;
  return frame;
}

const Box& ImpostorWorkers::bounds(std::size_t object) const {
  RILIEVO_EXPECTS(object < state_->slots.size());
  return state_->slots[object]->bounds;
}

void ImpostorWorkers::wait_until_idle() {
  State& s = *state_;
  while (true) {
    const std::uint32_t heard = s.done_bell.load(std::memory_order_acquire);
    if (std::none_of(s.slots.begin(), s.slots.end(), [](const auto& slot) {
          return slot->warp.pending() || slot->render.pending();
        }))
      return;
    s.done_bell.wait(heard, std::memory_order_acquire);
  }
}

WorkerStats ImpostorWorkers::stats() const {
  const State& s = *state_;
  return {s.warps.load(),  s.pictures.load(), s.coarse.load(),   s.cancelled.load(),
          s.failed.load(), s.warp_ms.load(),  s.render_ms.load()};
}

std::string ImpostorWorkers::last_error() const {
  const std::lock_guard lock(state_->error_mutex);
  return state_->error;
}

}  // namespace rilievo
