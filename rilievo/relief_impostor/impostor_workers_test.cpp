#include "rilievo/relief_impostor/impostor_workers.h"

#include <gtest/gtest.h>
#include <sched.h>

#include <atomic>
#include <cmath>
#include <memory>
#include <random>
#include <thread>

#include "rilievo/capture/callable_source.h"
#include "rilievo/core/triple_buffer.h"
#include "rilievo/relief_impostor/frame_gate.h"

namespace rilievo {
namespace {

// A ball of radius 1 with a coloured half, shaded on the spot.
CapturedPicture ball_picture(const Camera& camera, float blue, double radius = 1) {
  CapturedPicture made;
  DepthImage& picture = made.picture;
  picture.camera = camera;
  picture.depth_kind = DepthKind::eye_z;
  picture.color = ColorImage(camera.width, camera.height);
  picture.depth = Image<float>(camera.width, camera.height);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const glm::dvec3 at = camera.position();
      const glm::dvec3 way = world_from_raster(camera, {x + 0.5, y + 0.5}, 1) - at;
      const double a = glm::dot(way, way), b = glm::dot(way, at),
                   c = glm::dot(at, at) - radius * radius;
      const double root = b * b - a * c;
      const bool hit = root > 0;
      picture.depth(x, y) = hit ? float((-b - std::sqrt(root)) / a) : kNoDepth;
      picture.color(x, y) = hit ? glm::vec4(0.8f, 0.4f, blue, 1) : glm::vec4(0);
    }
  return made;
}

const Box kBall{glm::vec3(-1), glm::vec3(1)};

CallableSource quick_ball() {
  return {"ball", kBall, [](const CaptureRequest& request) -> Result<CapturedPicture> {
            if (request.control && request.control->refined)
              request.control->refined(ball_picture(request.camera, 0.9f));
            return ball_picture(request.camera, 0.1f);
          }};
}

ImpostorEye eye_at(double angle, double distance = 4) {
  return {.position = distance * glm::dvec3(std::sin(angle), 0.2, std::cos(angle))};
}

// As many frames as it takes until nothing more happens.
ImpostorFrame settle(ImpostorWorkers& workers, std::size_t object, const ImpostorEye& eye) {
  ImpostorFrame frame;
  for (int i = 0; i < 8; ++i) {
    frame = workers.frame(object, eye);
    workers.wait_until_idle();
  }
  return workers.frame(object, eye);
}

TEST(ImpostorWorkers, that_give_way_run_only_where_no_other_thread_does) {
  for (const bool gives_way : {false, true}) {
    std::atomic<int> policy{-1};
    CallableSource source("ball", kBall,
                          [&](const CaptureRequest& request) -> Result<CapturedPicture> {
                            policy = sched_getscheduler(0);
                            return ball_picture(request.camera, 0.1f);
                          });
    ImpostorWorkers workers({&source}, {{}}, {.gives_way = gives_way});
    EXPECT_TRUE(settle(workers, 0, eye_at(0)).board);
    EXPECT_EQ(policy, gives_way ? SCHED_IDLE : sched_getscheduler(0));
  }
}

// Whatever else the machine does, only lower limits of time are tested.
TEST(FrameGate, work_waits_for_the_end_of_a_frame_but_not_for_ever) {
  FrameGate gate;
  BackgroundWork work(gate);
  work.wait({});
  EXPECT_EQ(work.waited_ms(), 0);

  gate.begin_frame();
  const Stopwatch watch;
  work.wait({});
  EXPECT_GE(watch.ms(), BackgroundWork::kFirstWait);
  EXPECT_GE(work.waited_ms(), BackgroundWork::kFirstWait);
  // Of the next thirty milliseconds, it is at work for ten and waits twice as long.
  for (const Stopwatch working; working.ms() < 10;) {
  }
  work.wait({});
  EXPECT_GE(work.waited_ms(), BackgroundWork::kFirstWait + 20);

  BackgroundWork waiting(gate), stopped(gate);
  std::stop_source stop;
  stop.request_stop();
  stopped.wait(stop.get_token());
  EXPECT_LT(stopped.waited_ms(), BackgroundWork::kFirstWait);
  gate.end_frame();
  waiting.wait({});
  EXPECT_EQ(waiting.waited_ms(), 0);
}

TEST(ImpostorWorkers, that_give_way_wait_for_the_end_of_a_frame_with_a_picture_but_not_for_ever) {
  for (const bool gives_way : {false, true}) {
    std::atomic<double> waited_ms{-1};
    CallableSource source("ball", kBall,
                          [&](const CaptureRequest& request) -> Result<CapturedPicture> {
                            EXPECT_EQ(bool(request.control->give_way), gives_way);
                            const Stopwatch watch;
                            if (gives_way) request.control->give_way();
                            waited_ms = watch.ms();
                            return ball_picture(request.camera, 0.1f);
                          });
    ImpostorWorkers workers({&source}, {{}}, {.gives_way = gives_way});
    workers.begin_frame();
    EXPECT_TRUE(settle(workers, 0, eye_at(0)).board);  // though the frame does not end
    EXPECT_GE(waited_ms, gives_way ? BackgroundWork::kFirstWait : 0);
    workers.end_frame();
  }
}

TEST(TripleBuffer, the_reader_gets_the_newest_whole_result) {
  struct Both {
    int a = 0, b = 0;
  };
  TripleBuffer<Both> buffer;
  EXPECT_FALSE(buffer.update());
  std::atomic<bool> done{false};
  std::thread writer([&] {
    for (int i = 1; i <= 20'000; ++i) {
      buffer.back() = {i, -i};
      buffer.publish();
    }
    done = true;
  });
  int last = 0;
  while (true) {
    const bool finished = done;
    if (buffer.update()) {
      EXPECT_GT(buffer.front().a, last);
      last = buffer.front().a;
    }
    EXPECT_EQ(buffer.front().b, -buffer.front().a);
    if (finished) break;
  }
  writer.join();
  EXPECT_EQ(last, 20'000);
}

TEST(ImpostorWorkers, an_object_is_drawn_itself_until_its_impostor_is_there) {
  CallableSource ball = quick_ball();
  ImpostorWorkers workers({&ball}, {{}}, {.size = 64});
  EXPECT_EQ(workers.frame(0, eye_at(0)).shown, ImpostorShown::object);
  const ImpostorFrame frame = settle(workers, 0, eye_at(0));
  EXPECT_EQ(frame.shown, ImpostorShown::fresh);
  ASSERT_NE(frame.board, nullptr);
  // The final picture, not the coarse one.
  const glm::u8vec4 middle = frame.board->color[std::size_t(
      frame.board->height() / 2 * frame.board->width() + frame.board->width() / 2)];
  EXPECT_LT(middle.b, middle.g);
  EXPECT_EQ(frame.board->geometry.capture.position(), eye_at(0).position);
  EXPECT_EQ(workers.stats().coarse, 1u);
  EXPECT_EQ(workers.stats().pictures, 1u);
}

TEST(ImpostorWorkers, nothing_moved_zero_warps) {
  CallableSource ball = quick_ball();
  ImpostorWorkers workers({&ball}, {{}}, {.size = 64});
  (void)settle(workers, 0, eye_at(0));
  const WorkerStats before = workers.stats();
  for (int i = 0; i < 100; ++i) {
    const ImpostorFrame frame = workers.frame(0, eye_at(0));
    EXPECT_EQ(frame.shown, ImpostorShown::fresh);
    EXPECT_FALSE(frame.changed);
  }
  workers.wait_until_idle();
  EXPECT_EQ(workers.stats().warps, before.warps);
  EXPECT_EQ(workers.stats().pictures, before.pictures);
}

TEST(ImpostorWorkers, a_walk_around_warps_before_it_renders) {
  CallableSource ball = quick_ball();
  ImpostorWorkers workers({&ball}, {{}}, {.size = 96});
  int impostors_shown = 0;
  for (int i = 0; i <= 120; ++i)
    impostors_shown += settle(workers, 0, eye_at(i * 0.0523)).shown == ImpostorShown::fresh;
  const WorkerStats stats = workers.stats();
  EXPECT_EQ(impostors_shown, 121);
  EXPECT_GT(stats.pictures, 3u);
  EXPECT_LT(stats.pictures, 60u);
  EXPECT_GT(stats.warps, 100u);
  EXPECT_EQ(stats.failed, 0u);
}

TEST(ImpostorWorkers, pictures_are_made_for_where_the_eye_will_be) {
  std::atomic<double> last_x{0};
  CallableSource slow("ball", kBall, [&](const CaptureRequest& request) -> Result<CapturedPicture> {
    last_x = request.camera.position().x;
    return ball_picture(request.camera, 0.1f);
  });
  ImpostorWorkers workers({&slow}, {{}}, {.size = 32});
  ImpostorEye eye = eye_at(0);
  eye.velocity = {10, 0, 0};
  (void)workers.frame(0, eye);
  workers.wait_until_idle();
  // Before the first picture, one is assumed to take a tenth of a second; and so the next, until
  // which this one is shown.
  EXPECT_NEAR(last_x, 2.0, 1e-9);
}

// A ball that is seen from the front alone.
TEST(ImpostorWorkers, what_shows_nothing_is_not_rendered_again_until_something_changes) {
  constexpr double kBehind = 3.14;
  for (const bool drawable : {true, false}) {
    std::atomic<int> begun{0};
    CallableSource ball("ball", kBall,
                        [&](const CaptureRequest& request) -> Result<CapturedPicture> {
                          ++begun;
                          const bool front = request.camera.position().z > 0;
                          return ball_picture(request.camera, 0.1f, front ? 1 : 0);
                        });
    ImpostorWorkers workers({&ball}, {{.drawable = drawable, .deforms = 0.3}}, {.size = 64});
    const ImpostorShown otherwise = drawable ? ImpostorShown::object : ImpostorShown::nothing;
    ImpostorEye eye = eye_at(kBehind);
    EXPECT_EQ(settle(workers, 0, eye).shown, otherwise);
    EXPECT_EQ(begun, 1);
    // Hardly another eye; and one for which it says nothing.
    EXPECT_EQ(settle(workers, 0, eye_at(kBehind + 0.002)).shown, otherwise);
    EXPECT_EQ(begun, 1);
    EXPECT_EQ(settle(workers, 0, eye_at(kBehind + 0.1)).shown, otherwise);
    EXPECT_EQ(begun, 2);
    eye = eye_at(kBehind + 0.1);
    eye.time = 0.1;  // it may have deformed
    EXPECT_EQ(settle(workers, 0, eye).shown, otherwise);
    EXPECT_EQ(begun, 3);
    eye.position = eye_at(0).position;
    EXPECT_EQ(settle(workers, 0, eye).shown, ImpostorShown::fresh);
    EXPECT_EQ(begun, 4);
    eye.position = eye_at(kBehind).position;
    EXPECT_EQ(settle(workers, 0, eye).shown, otherwise);
    EXPECT_EQ(begun, 5);
  }
}

// A ball that shrinks by 0.3 metres a second.
TEST(ImpostorWorkers, what_deforms_is_shown_for_no_longer_than_it_is_right) {
  const auto radius = [](double time) { return 1 - 0.3 * time; };
  CallableSource ball("ball", kBall, [&](const CaptureRequest& request) -> Result<CapturedPicture> {
    return ball_picture(request.camera, 0.1f, radius(request.time));
  });
  ImpostorWorkers workers({&ball}, {{.deforms = 0.3}}, {.size = 64});
  ImpostorEye eye = eye_at(0);
  EXPECT_EQ(settle(workers, 0, eye).shown, ImpostorShown::fresh);
  EXPECT_EQ(workers.stats().pictures, 1u);
  const double away = glm::length(eye.position);
  // Where the silhouette is seen, pixels from the middle.
  const auto silhouette_px = [&](double time) {
    return eye.focal_px * std::tan(std::asin(radius(time) / away));
  };
  double shown_time = 0;
  std::uint64_t pictures = 1;
  for (const double time : {0.002, 0.05, 0.051, 0.06, 0.9, 1.3}) {
    eye.time = time;
    const ImpostorFrame frame = workers.frame(0, eye);
    // It is never off by more than it says.
    EXPECT_GE(frame.deformed_px + 1e-9, silhouette_px(shown_time) - silhouette_px(time)) << time;
    // Nearest to the eye, a metre is 500 / 3 pixels.
    const double most = 0.3 * (time - shown_time) * eye.focal_px / (away - 1.5);
    EXPECT_LE(frame.deformed_px, most) << time;
    EXPECT_EQ(frame.shown, frame.deformed_px <= 0.5 ? ImpostorShown::fresh
                           : frame.deformed_px <= 8 ? ImpostorShown::stale
                                                    : ImpostorShown::object)
        << time;
    EXPECT_EQ(frame.rendering, frame.deformed_px > 0.5) << time;
    const bool renewed = frame.rendering;
    const ImpostorFrame then = settle(workers, 0, eye);
    EXPECT_EQ(then.shown, ImpostorShown::fresh);
    pictures += renewed;
    EXPECT_EQ(workers.stats().pictures, pictures);
    if (renewed) {
      EXPECT_EQ(then.deformed_px, 0);
      shown_time = time;
    }
  }
  EXPECT_EQ(pictures, 4u);
}

TEST(ImpostorWorkers, a_picture_for_an_eye_left_behind_is_given_up) {
  std::atomic<int> begun{0}, stopped{0};
  // Never ends by itself.
  CallableSource endless("ball", kBall,
                         [&](const CaptureRequest& request) -> Result<CapturedPicture> {
                           ++begun;
                           request.control->refined(ball_picture(request.camera, 0.9f));
                           while (!request.control->stop.stop_requested())
                             std::this_thread::yield();
                           ++stopped;
                           return Error{"ball", std::string(kCaptureStopped)};
                         });
  {
    ImpostorWorkers workers({&endless}, {{.drawable = false}}, {.size = 64});
    // The coarse picture is shown meanwhile.
    while (workers.frame(0, eye_at(0)).shown != ImpostorShown::fresh) std::this_thread::yield();
    EXPECT_EQ(begun, 1);
    while (begun < 2) {
      (void)workers.frame(0, eye_at(2.5));
      std::this_thread::yield();
    }
    EXPECT_GE(stopped, 1);
    EXPECT_GE(workers.stats().cancelled + 0u, 1u);
  }
  // The end stops the last one, too.
  EXPECT_EQ(begun, stopped);
}

TEST(ImpostorWorkers, a_shader_that_fails_leaves_the_object_drawn_and_its_reason) {
  CallableSource broken("broken", kBall, [](const CaptureRequest&) -> Result<CapturedPicture> {
    return Error{"broken", "has no colours"};
  });
  ImpostorWorkers workers({&broken}, {{}});
  EXPECT_EQ(settle(workers, 0, eye_at(0)).shown, ImpostorShown::object);
  EXPECT_NE(workers.last_error().find("has no colours"), std::string::npos);
}

// For ThreadSanitizer: several workers, objects, jumps, and early ends.
TEST(ImpostorWorkers, many_workers_and_jumping_eyes_do_not_race) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int round = 0; round < 4; ++round) {
    std::vector<std::unique_ptr<CallableSource>> balls;
    std::vector<CaptureSource*> sources;
    for (int i = 0; i <= round; ++i) {
      balls.push_back(std::make_unique<CallableSource>(
          "ball", kBall, [](const CaptureRequest& request) -> Result<CapturedPicture> {
            for (int k = 0; k < 3; ++k) {
              if (request.control->stop.stop_requested())
                return Error{"ball", std::string(kCaptureStopped)};
              request.control->refined(ball_picture(request.camera, 0.9f));
            }
            return ball_picture(request.camera, 0.1f);
          }));
      sources.push_back(balls.back().get());
    }
    ImpostorWorkers workers(sources, {{}, {.drawable = false}, {}}, {.size = 24});
    double angle = 0;
    for (int frame = 0; frame < 300; ++frame) {
      angle = any(rng) > 0.9 ? 3 * any(rng) : angle + 0.01;
      for (std::size_t object = 0; object < 3; ++object) {
        ImpostorEye eye = eye_at(angle + double(object), 4 + any(rng));
        eye.velocity = {any(rng), any(rng), any(rng)};
        const ImpostorFrame seen = workers.frame(object, eye);
        if (!seen.board) continue;
        // Whole: all planes have the size of their camera.
        const auto texels = std::size_t(seen.board->width()) * std::size_t(seen.board->height());
        EXPECT_EQ(seen.board->color.size(), texels);
        EXPECT_EQ(seen.board->delta.size(), texels);
      }
      if (frame % 10 == 0) std::this_thread::yield();
      if (frame == 150) workers.wait_until_idle();
    }
    EXPECT_NE(settle(workers, 0, eye_at(angle)).board, nullptr);
  }
}

}  // namespace
}  // namespace rilievo
