#include "rilievo/keyframes/keyframe_producer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <mutex>
#include <semaphore>
#include <thread>
#include <utility>

#include "rilievo/capture/forwarding_source.h"
#include "rilievo/capture/raster_source.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

struct ProducerStage {
  BuiltinScene made = *make_builtin("builtin:stonehenge?triangles=20000");
  PlacedScene placed{made.scene};
  RasterSource source{placed};

  static Camera eye(double x, double turn = 0) {
    const glm::dvec3 at(x, 1.7, 12);
    return look_at(at, at + glm::dvec3(std::sin(turn), 0, -std::cos(turn)), {0, 1, 0}, 0.9, 96, 64,
                   0.1, 200);
  }
};

TEST(EyePrediction, ASteadyEyeGoesOnAndAJumpIsNoMotion) {
  EyePrediction prediction;
  for (int i = 0; i < 20; ++i) prediction.follow(ProducerStage::eye(0.02 * i, 0.01 * i));
  EXPECT_FALSE(prediction.jumped());
  const double turning =
      EyePrediction::kTurningFrames * (1 - std::exp(-10 / EyePrediction::kTurningFrames));
  EXPECT_GT(turning, 8);
  const Camera ahead = prediction.after(10),
               expected = ProducerStage::eye(0.02 * 29, 0.19 + 0.01 * turning);
  EXPECT_NEAR(glm::length(ahead.position() - expected.position()), 0, 1e-9);
  EXPECT_NEAR(glm::length(ahead.forward() - expected.forward()), 0, 1e-9);
  EXPECT_TRUE(validate(ahead));
  prediction.follow(ProducerStage::eye(30));
  EXPECT_TRUE(prediction.jumped());
  EXPECT_EQ(prediction.after(10).position(), ProducerStage::eye(30).position());
}

TEST(EyePrediction, AFrameThatTakesLongTellsNothingOfTheEyesSpeed) {
  EyePrediction prediction;
  // The first frame of a walk takes as long as twenty others, and a later one takes as long as six.
  double at = 0;
  for (int i = 0; i < 40; ++i) {
    prediction.follow(ProducerStage::eye(at, at / 2));
    at += i == 0 ? 0.4 : i == 30 ? 0.12 : 0.02;
    EXPECT_EQ(prediction.speed_known(), i != 1);
    if (i < 2) continue;
    const Camera now = ProducerStage::eye(at - (i == 30 ? 0.12 : 0.02)),
                 ahead = prediction.after(10);
    EXPECT_NEAR(ahead.position().x - now.position().x, 0.2, 0.2 * 0.2) << i;
  }
}

TEST(EyePrediction, AnEyeThatMovesOrTurnsInEverySecondFrameOnlyDoesSo) {
  EyePrediction turns, moves;
  for (int i = 0; i < 60; ++i) {
    turns.follow(ProducerStage::eye(0.02 * i, 0.01 * (i / 2)));
    moves.follow(ProducerStage::eye(0.02 * (i / 2)));
    if (i <= 2) continue;
    EXPECT_EQ(moves.speed_known(), i % 2 == 0) << i;
    if (i % 2 == 0) {
      EXPECT_NEAR(moves.after(1).position().x - 0.02 * (i / 2), 0.02, 1e-9) << i;
    }
  }
  // Half of 0.01 a frame.
  EXPECT_NEAR(turns.turning_sideways(), 0.005, 0.001);
}

// What begins with the second frame asks where the eye goes.
TEST(EyePrediction, TheFirstStepSaysWhereTheEyeGoes) {
  EyePrediction prediction;
  for (const int at : {0, 1}) prediction.follow(ProducerStage::eye(at));
  EXPECT_EQ(prediction.after(10).position(), ProducerStage::eye(11).position());
}

TEST(KeyframeProducer, TheEyeOfASteadyWalkIsBetweenTwoKeyframes) {
  ProducerStage stage;
  KeyframeProducer producer(stage.source, stage.source, {.samples = 1, .interval = 4});
  int between = 0;
  for (int i = 0; i < 40; ++i) {
    const Camera frame = ProducerStage::eye(0.02 * i);
    if (producer.follow(frame, 0).empty()) {
      ASSERT_TRUE(producer.make_now());
    }
    if (producer.chosen().size() == 2) {
      const double a = producer.chosen()[0].keyframe->camera.position().x,
                   b = producer.chosen()[1].keyframe->camera.position().x;
      between += std::min(a, b) <= frame.position().x + 1e-9 &&
                 frame.position().x <= std::max(a, b) + 1e-9;
    }
    ASSERT_TRUE(producer.work());
  }
  EXPECT_GE(between, 30);
}

TEST(KeyframeProducer, AWalkWhoseFirstFrameTakesLongGetsItsSecondKeyframeAhead) {
  ProducerStage stage;
  KeyframeProducer producer(stage.source, stage.source, {.samples = 1, .interval = 4});
  double at = 0;
  for (int i = 0; i < 7; ++i) {
    if (producer.follow(ProducerStage::eye(at), 0).empty()) {
      ASSERT_TRUE(producer.make_now());
    }
    if (producer.chosen().size() == 2) break;
    ASSERT_TRUE(producer.work());
    at += i == 0 ? 0.4 : 0.02;
  }
  ASSERT_EQ(producer.chosen().size(), 2u);
  EXPECT_EQ(producer.chosen()[0].keyframe->camera.position().x, 0);
  // Eight frames from the third one.
  EXPECT_NEAR(producer.chosen()[1].keyframe->camera.position().x, 0.42 + 8 * 0.02, 1e-6);
}

// Around the middle of the stones, whose blocks are typically as far as the eye is.
TEST(KeyframeProducer, AFastEyeGetsAKeyframeAfterFewerFrames) {
  ProducerStage stage;
  const auto count_made = [&](double turn, double most_travel, double keyframe_ms) {
    KeyframeProducer producer(
        stage.source, stage.source,
        {.samples = 1, .interval = 16, .most_travel = most_travel, .keyframe_ms = keyframe_ms});
    int made = 0;
    for (int i = 0; i < 64; ++i) {
      const double angle = turn * i;
      const glm::dvec3 eye(20 * std::sin(angle), 3, 20 * std::cos(angle));
      const Camera frame = look_at(eye, {0, 1, 0}, {0, 1, 0}, 0.9, 96, 64, 0.1, 200);
      if (producer.follow(frame, 0).empty()) {
        EXPECT_TRUE(producer.make_now());
      }
      EXPECT_TRUE(producer.work());
      made += producer.take_work().completed;
    }
    return made;
  };
  // A quarter of the distance is 0.25 rad: one keyframe in 16 frames (in 10, as bands are rounded
  // up), and one in two to four.
  const int slow = count_made(0.005, 0.25, 0), fast = count_made(0.1, 0.25, 0),
            before = count_made(0.1, HUGE_VAL, 0), by_clock = count_made(0.1, 0.25, 1e-6);
  EXPECT_LE(slow, 64 / 8);
  EXPECT_LE(before, 64 / 8);
  EXPECT_GE(fast, 64 / 4);
  // Time goes first.
  EXPECT_LE(by_clock, 64 / 8);
}

// An eye that is looked from and not followed.
TEST(KeyframeProducer, AnEyeInTheMiddleIsShownByBothAlike) {
  ProducerStage stage;
  KeyframeProducer producer(stage.source, stage.source, {.samples = 1, .interval = 4});
  for (int i = 0; !producer.has_two(); ++i) {
    (void)producer.follow(ProducerStage::eye(0.02 * i), 0);
    ASSERT_TRUE(producer.work());
  }
  EXPECT_EQ(producer.frames_for_one(), 4);
  double middle = 0;
  for (const WarpedKeyframe& one : producer.choose_for(ProducerStage::eye(0)))
    middle += one.keyframe->camera.position().x / 2;
  std::vector<double> weights;
  for (const WarpedKeyframe& one : producer.choose_for(ProducerStage::eye(middle)))
    weights.push_back(one.weight);
  ASSERT_EQ(weights.size(), 2u);
  EXPECT_NEAR(weights[0], weights[1], 1e-3);
}

// What begins a keyframe finds its memory there.
TEST(KeyframeProducer, MemoryThatWasTakenSuffices) {
  ProducerStage stage;
  KeyframeProducer producer(stage.source, stage.source, {.samples = 1, .interval = 4});
  producer.reserve(ProducerStage::eye(0), 0);
  EXPECT_FALSE(producer.any());
  const std::size_t taken = producer.bytes();
  EXPECT_GT(taken, 0u);
  for (int i = 0; i < 40; ++i) {
    (void)producer.follow(ProducerStage::eye(0.02 * i), 0);
    ASSERT_TRUE(producer.work());
    EXPECT_LE(producer.bytes(), taken);
    const std::size_t before = producer.bytes();
    producer.take_memory();
    EXPECT_EQ(producer.bytes(), before) << i;
  }
  EXPECT_TRUE(producer.has_two());
}

// The widest picture that a source captured in parts.
class WidthOfParts final : public ForwardingSource {
 public:
  using ForwardingSource::ForwardingSource;
  std::unique_ptr<PictureInParts> in_parts() override {
    struct Parts final : PictureInParts {
      Result<> begin(const CaptureRequest& request) override {
        *widest = std::max(*widest, request.camera.width);
        return parts->begin(request);
      }
      int advance(double share) override { return parts->advance(share); }
      void read(int from, int to, DepthImage& picture) override { parts->read(from, to, picture); }
      std::unique_ptr<PictureInParts> parts;
      int* widest = nullptr;
    };
    auto made = std::make_unique<Parts>();
    made->parts = source_.in_parts(), made->widest = &widest;
    return made;
  }
  int widest = 0;
};

// A source's memory, too, though nothing is known yet of how the eye turns.
TEST(KeyframeProducer, WhatWasReservedSufficesForAnEyeThatTurnsSideways) {
  ProducerStage stage;
  WidthOfParts source(stage.source);
  KeyframeProducer producer(source, source, {.samples = 4, .interval = 4, .keyframe_ms = 1e-3});
  producer.reserve(ProducerStage::eye(0), 0);
  const int reserved = std::exchange(source.widest, 0);
  for (int i = 0; i < 200 && !producer.has_two(); ++i) {
    (void)producer.follow(ProducerStage::eye(0.02 * i, 0.01 * i), 0);
    ASSERT_TRUE(producer.work());
    producer.take_complete();
  }
  EXPECT_TRUE(producer.has_two());
  EXPECT_GT(source.widest, 0);
  EXPECT_LE(source.widest, reserved);
}

TEST(KeyframeProducer, AnEyeThatStandsFromTheFirstFrameOnGetsASharpOneAndNoOther) {
  ProducerStage stage;
  KeyframeProducer producer(stage.source, stage.source, {.samples = 4, .interval = 4});
  producer.reserve(ProducerStage::eye(0), 0);
  for (int i = 0; i < 20; ++i) {
    (void)producer.follow(ProducerStage::eye(0), 0);
    ASSERT_TRUE(producer.work());
  }
  ASSERT_EQ(producer.chosen().size(), 1u);
  EXPECT_TRUE(producer.chosen()[0].keyframe->sharp);
  EXPECT_EQ(producer.take_work().completed, 1);
}

TEST(KeyframeProducer, AnEyeThatTurnsGetsAWiderMarginAlongItsWay) {
  ProducerStage stage;
  for (const double turn : {0.0, 0.01}) {
    KeyframeProducer producer(stage.source, stage.source, {.samples = 1, .interval = 2});
    for (int i = 0; i < 12; ++i) {
      if (producer.follow(ProducerStage::eye(0.02 * i, turn * i), 0).empty()) {
        ASSERT_TRUE(producer.make_now());
      }
      ASSERT_TRUE(producer.work());
    }
    const Camera& made = producer.chosen().back().keyframe->camera;
    EXPECT_NEAR(made.width, 96 * (turn > 0 ? 1.44 : 1.2), 2);
    EXPECT_NEAR(made.height, 64 * 1.2, 2);
  }
}

TEST(KeyframeProducer, AnEyeThatStandsGetsItsOwnKeyframeAndThenNothingIsMade) {
  ProducerStage stage;
  KeyframeProducer producer(stage.source, stage.source, {.samples = 1, .interval = 2});
  for (int i = 0; i < 30; ++i) {
    if (producer.follow(ProducerStage::eye(std::min(i, 7) * 0.02), 0).empty()) {
      ASSERT_TRUE(producer.make_now());
    }
    ASSERT_TRUE(producer.work());
    if (i == 20) (void)producer.take_work();
  }
  EXPECT_EQ(producer.take_work().completed, 0);
  EXPECT_EQ(producer.chosen().back().keyframe->camera.position(),
            ProducerStage::eye(0.14).position());
}

TEST(KeyframeProducer, WithALimitOfTimeAJumpGetsACoarseKeyframeAndThenFineOnes) {
  ProducerStage stage;
  KeyframeProducer producer(stage.source, stage.source,
                            {.samples = 1, .interval = 2, .keyframe_ms = 1000});
  (void)producer.follow(ProducerStage::eye(0), 0);
  ASSERT_TRUE(producer.make_now());
  EXPECT_EQ(producer.take_work().coarse, 0);  // the one for its memory is shown to nobody
  EXPECT_EQ(producer.chosen().size(), 1u);
  (void)producer.follow(ProducerStage::eye(5, 3), 0);
  const auto made = producer.make_now();
  ASSERT_TRUE(made);
  EXPECT_EQ(producer.take_work().coarse, 1);
  ASSERT_EQ(made->size(), 1u);
  EXPECT_TRUE((*made)[0].keyframe->coarse);
  for (int i = 0; i < 12; ++i) {
    (void)producer.follow(ProducerStage::eye(5 + 0.01 * i, 3), 0);
    ASSERT_TRUE(producer.work());
  }
  for (const WarpedKeyframe& one : producer.chosen()) EXPECT_FALSE(one.keyframe->coarse);
}

// Keyframes that so many frames complete, with next to no time for them.
int count_completed(int samples, int frames) {
  ProducerStage stage;
  KeyframeProducer producer(stage.source, stage.source,
                            {.samples = samples, .interval = 4, .keyframe_ms = 1e-6});
  const auto eye = [](int i) {
    const glm::dvec3 at(0.01 * i, 1.7, 12);
    // Wide enough for more bands than frames.
    return look_at(at, at + glm::dvec3(0, 0, -1), {0, 1, 0}, 0.3, 800, 40, 0.1, 200);
  };
  int completed = 0;
  for (int i = 0; i < frames; ++i) {
    if (producer.follow(eye(i), 0).empty()) {
      EXPECT_TRUE(producer.make_now());
      (void)producer.take_work();
    }
    EXPECT_TRUE(producer.work());
    completed += producer.take_work().completed;
  }
  return completed;
}

TEST(KeyframeProducer, AKeyframeTakesAFewFramesHoweverLittleTimeThereIs) {
  EXPECT_EQ(count_completed(1, 70), 2);
  // In parts at most twice as many, as the first one does.
  EXPECT_GE(count_completed(4, 140), 2);
}

// In bands, and any time suffices: what counts is the least number of frames.
TEST(KeyframeProducer, FramesThatAreAllowedMoreTimeMakeAKeyframeSooner) {
  int took[2] = {};
  for (const bool allowed : {false, true}) {
    ProducerStage stage;
    KeyframeProducer producer(stage.source, stage.source,
                              {.samples = 1, .interval = 16, .keyframe_ms = 1e6});
    const auto eye = [](int i) {
      const glm::dvec3 at(0.01 * i, 1.7, 12);
      return look_at(at, at + glm::dvec3(0, 0, -1), {0, 1, 0}, 0.3, 800, 40, 0.1, 200);
    };
    int& frames = took[allowed ? 1 : 0];
    for (; !producer.has_two() && frames < 100; ++frames) {
      (void)producer.follow(eye(frames), 0);
      ASSERT_TRUE(producer.work(0, allowed ? 1e6 : 0));
    }
    ASSERT_TRUE(producer.has_two());
  }
  // Of two keyframes; the second frame does not know how fast the eye is, and the last one takes
  // what the one before completed.
  EXPECT_LE(took[0], 2 * 16 + 2);
  EXPECT_LE(took[1], 2 * 8 + 2);
  EXPECT_GE(took[1], 8);
}

// There is no second one.
TEST(KeyframeProducer, AnEyeThatStandsHasAllWithOne) {
  ProducerStage stage;
  KeyframeProducer producer(stage.source, stage.source, {});
  int frames = 0;
  for (; !producer.has_all() && frames < 100; ++frames) {
    (void)producer.follow(ProducerStage::eye(0), 0);
    ASSERT_TRUE(producer.work());
  }
  EXPECT_LT(frames, 20);
  EXPECT_FALSE(producer.has_two());
  (void)producer.follow(ProducerStage::eye(0.1), 0);
  EXPECT_FALSE(producer.has_all());
}

// The first one for the eye as it is, the second one for where it will be.
TEST(KeyframeProducer, AKeyframeAtOnceTakesOneFrame) {
  for (const double limit_ms : {0.0, 0.5}) {  // in bands, and in parts
    ProducerStage stage;
    KeyframeProducer producer(stage.source, stage.source, {.keyframe_ms = limit_ms});
    for (int i = 0; i < 3; ++i) (void)producer.follow(ProducerStage::eye(0.02 * i), 0);
    ASSERT_TRUE(producer.work(0, KeyframeProducer::kAtOnce));
    EXPECT_EQ(producer.take_work().completed, 1);
    (void)producer.follow(ProducerStage::eye(0.06), 0);
    ASSERT_EQ(producer.chosen().size(), 1u);
    EXPECT_NEAR(producer.chosen()[0].keyframe->camera.position().x, 0.04, 1e-9);
    ASSERT_TRUE(producer.work(0, KeyframeProducer::kAtOnce));
    EXPECT_EQ(producer.take_work().completed, 1);
    (void)producer.follow(ProducerStage::eye(0.08), 0);
    EXPECT_TRUE(producer.has_two());
    const double ahead = producer.frames_for_one();
    EXPECT_EQ(ahead, 8);  // of 16 columns each
    ASSERT_EQ(producer.chosen().size(), 2u);
    double farthest = 0;
    for (const WarpedKeyframe& one : producer.chosen())
      farthest = std::max(farthest, one.keyframe->camera.position().x);
    EXPECT_NEAR(farthest, 0.06 + 0.02 * ahead, 1e-9);
    // Then one takes some frames again.
    ASSERT_TRUE(producer.work());
    EXPECT_EQ(producer.take_work().completed, 0);
  }
}

// A source that takes until it is told to go on.
class PatientSource final : public CaptureSource {
 public:
  explicit PatientSource(CaptureSource& source) : source_(source) {}
  std::string_view name() const override { return "patient"; }
  Box bounds(std::span<const std::uint32_t> objects) const override {
    return source_.bounds(objects);
  }
  Result<CapturedPicture> capture(const CaptureRequest& request) override {
    started_.release();
    go_on_.acquire();
    return source_.capture(request);
  }
  std::binary_semaphore started_{0}, go_on_{0};

 private:
  CaptureSource& source_;
};

TEST(KeyframeProducer, FramesDoNotWaitForASourceBesideThem) {
  ProducerStage stage;
  RasterSource quick(stage.placed);
  PatientSource slow(stage.source);
  KeyframeProducer producer(slow, quick, {.samples = 1, .beside = true});
  EXPECT_TRUE(producer.follow(ProducerStage::eye(0), 0).empty());
  ASSERT_TRUE(producer.make_now());
  ASSERT_TRUE(producer.work());
  slow.started_.acquire();
  for (int i = 0; i < 10; ++i) {
    (void)producer.follow(ProducerStage::eye(0), 0);
    ASSERT_EQ(producer.chosen().size(), 1u);
    EXPECT_TRUE(producer.chosen()[0].keyframe->coarse);
    ASSERT_TRUE(producer.work());
  }
  slow.go_on_.release();
  // As long as the other thread takes: its end is seen by a frame, and the next one is warped from
  // it.
  while (producer.take_work().completed == 0) {
    (void)producer.follow(ProducerStage::eye(0), 0);
    ASSERT_TRUE(producer.work());
    std::this_thread::yield();
  }
  (void)producer.follow(ProducerStage::eye(0), 0);
  ASSERT_EQ(producer.chosen().size(), 2u);
  EXPECT_FALSE(producer.chosen()[1].keyframe->coarse);
  EXPECT_GT(producer.chosen()[1].weight, producer.chosen()[0].weight);
}

// Takes at least so long for each texel; says how large its pictures are, and whether it was told
// to stop.
class TakesLong final : public CaptureSource {
 public:
  TakesLong(CaptureSource& source, double ms_per_texel) : source_(source), ms_(ms_per_texel) {}
  std::string_view name() const override { return "takes long"; }
  Box bounds(std::span<const std::uint32_t> objects) const override {
    return source_.bounds(objects);
  }
  Result<CapturedPicture> capture(const CaptureRequest& request) override {
    {
      const std::lock_guard lock(mutex_);
      widths_.push_back(request.camera.width);
    }
    const Stopwatch watch;
    while (watch.ms() < ms_ * request.camera.width * request.camera.height) {
      if (request.control->stop.stop_requested())
        return Error{"takes long", std::string(kCaptureStopped)};
      std::this_thread::yield();
    }
    return source_.capture(request);
  }
  // Of those begun.
  std::vector<int> widths() {
    const std::lock_guard lock(mutex_);
    return widths_;
  }

 private:
  CaptureSource& source_;
  double ms_;
  std::mutex mutex_;
  std::vector<int> widths_;
};

TEST(KeyframeProducer, BesideFramesAnEyeThatMovesGetsAsManyTexelsAsAreMadeInTime) {
  ProducerStage stage;
  // 116 x 77 texels would take 2.2 s.
  TakesLong slow(stage.source, 0.25);
  KeyframeProducer producer(slow, stage.source, {.samples = 1, .beside = true});
  (void)producer.follow(ProducerStage::eye(0), 0);
  ASSERT_TRUE(producer.make_now());
  int frame = 0, complete = 0;
  const auto draw_until = [&](bool moves, const auto& done) {
    while (!done()) {
      frame += moves;
      (void)producer.follow(ProducerStage::eye(0.02 * frame), 0);
      ASSERT_TRUE(producer.work());
      complete += producer.take_work().completed;
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
  };
  ASSERT_NO_FATAL_FAILURE(draw_until(true, [&] { return complete == 2; }));
  // A quarter of the size tells what they take. The second one has as many texels as the clock
  // says, which is at least what a texel takes.
  const std::vector<int> moving = slow.widths();
  EXPECT_NEAR(moving[0], 116 / 4, 2);
  EXPECT_GT(moving[1], 116 / 8 - 1);
  EXPECT_LT(moving[1], 116 * std::sqrt(700 / 2200.0) + 2);
  // An eye that stands gets a small one, and then a whole one; once it moves, that is given up.
  ASSERT_NO_FATAL_FAILURE(draw_until(false, [&] { return slow.widths().back() > 110; }));
  const std::size_t begun = slow.widths().size();
  EXPECT_LT(slow.widths()[begun - 2], 110);
  const int before = complete;
  ASSERT_NO_FATAL_FAILURE(draw_until(true, [&] { return slow.widths().size() > begun; }));
  EXPECT_EQ(complete, before);
  EXPECT_LT(slow.widths().back(), 110);
}

// Steps with pauses: small ones come all the time.
TEST(KeyframeProducer, BesideFramesAnEyeThatStopsAndGoesGetsKeyframes) {
  ProducerStage stage;
  // A whole one would take 18 s, and one of an eighth of the size 0.3 s.
  TakesLong slow(stage.source, 2);
  KeyframeProducer producer(slow, stage.source, {.samples = 1, .beside = true});
  (void)producer.follow(ProducerStage::eye(0), 0);
  ASSERT_TRUE(producer.make_now());
  (void)producer.take_work();
  int complete = 0;
  for (int i = 0; complete < 4; ++i) {
    (void)producer.follow(ProducerStage::eye(0.02 * (i / 3)), 0);
    ASSERT_TRUE(producer.work());
    complete += producer.take_work().completed;
    std::this_thread::sleep_for(std::chrono::milliseconds(2));
  }
  for (const int width : slow.widths()) EXPECT_LT(width, 110);
}

// It has fewer texels, and shades one where a keyframe shades four.
TEST(KeyframeProducer, AFrameAtOnceTakesLessThanAKeyframe) {
  ProducerStage stage;
  KeyframeOptions options;
  for (const double limit_ms : {0.0, 0.5}) {  // in bands, and in parts
    options.keyframe_ms = limit_ms;
    KeyframeProducer producer(stage.source, stage.source, options);
    EXPECT_TRUE(producer.follow(ProducerStage::eye(0), 0).empty());
    EXPECT_EQ(producer.frame_ms(), 0);
    ASSERT_TRUE(producer.make_now());
    (void)producer.take_work();
    double ms = 0;
    for (int i = 1; producer.frame_ms() == 0 && i < 100; ++i) {
      (void)producer.follow(ProducerStage::eye(0.02 * i), 0);
      ASSERT_TRUE(producer.work());
      ms += producer.take_work().ms;
    }
    EXPECT_GT(producer.frame_ms(), 0);
    EXPECT_LT(producer.frame_ms(), ms);
  }
}

}  // namespace
}  // namespace rilievo
