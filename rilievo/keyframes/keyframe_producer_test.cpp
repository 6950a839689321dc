#include "rilievo/keyframes/keyframe_producer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <optional>
#include <thread>
#include <utility>

#include "rilievo/capture/forwarding_source.h"
#include "rilievo/core/on_this_thread.h"
#include "rilievo/keyframes/producer_stage_test_helpers.h"

namespace rilievo {
namespace {

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

// Waits in each part, as a thread of the lowest priority does beside frames.
class WaitsInParts final : public ForwardingSource {
 public:
  using ForwardingSource::ForwardingSource;
  std::unique_ptr<PictureInParts> in_parts() override {
    struct Parts final : PictureInParts {
      Result<> begin(const CaptureRequest& request) override { return parts->begin(request); }
      int advance(double share) override {
        std::this_thread::sleep_for(std::chrono::milliseconds(15));
        return parts->advance(share);
      }
      void read(int from, int to, DepthImage& picture) override { parts->read(from, to, picture); }
      std::unique_ptr<PictureInParts> parts;
    };
    auto made = std::make_unique<Parts>();
    made->parts = source_.in_parts();
    return made;
  }
};

// What is made beside frames waits for them. Frames that go on with it do not: they would have
// taken that time for each of the next one's parts.
TEST(KeyframeProducer, WhatWasMadeBesideFramesIsNotTakenToTakeAsLong) {
  if (threads_of_frames() == 1) GTEST_SKIP() << "one thread makes frames as well";
  double frames[2] = {};
  for (const bool beside : {false, true}) {
    ProducerStage stage;
    WaitsInParts source(stage.source);
    // 16 ms a frame for what takes some milliseconds, and 15 more for each part.
    KeyframeProducer producer(source, source, {.samples = 4, .interval = 2, .keyframe_ms = 16});
    std::optional<OnThisThread> alone;
    if (beside) alone.emplace();
    for (int i = 0; i < 200 && !producer.has_two(); ++i) {
      (void)producer.follow(ProducerStage::eye(0.02 * i), 0);
      ASSERT_TRUE(producer.work());
      producer.take_complete();
    }
    ASSERT_TRUE(producer.has_two());
    alone.reset();
    ASSERT_TRUE(producer.work());
    frames[beside ? 1 : 0] = producer.frames_for_one();
  }
  EXPECT_GE(frames[0], 2 * frames[1]);
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

// But no sooner than its interval allows. In bands, whose time is below any that is known.
TEST(KeyframeProducer, AShareOfFramesMakesAKeyframeInItsInterval) {
  int took[2] = {};
  for (const bool shared : {false, true}) {
    ProducerStage stage;
    KeyframeProducer producer(stage.source, stage.source,
                              {.samples = 1, .interval = 16, .keyframe_ms = 1e-9});
    int& frames = took[shared ? 1 : 0];
    for (int completed = 0; completed < 3 && frames < 200; ++frames) {
      const glm::dvec3 at(0.01 * frames, 1.7, 12);
      (void)producer.follow(
          look_at(at, at + glm::dvec3(0, 0, -1), {0, 1, 0}, 0.3, 800, 40, 0.1, 200), 0);
      ASSERT_TRUE(producer.work(0, 0, shared ? 1e6 : 0));
      completed += producer.take_work().completed;
    }
  }
  // Whole bands: of 16 frames that a keyframe takes at least 15 are needed, of 32 two fewer.
  EXPECT_NEAR(took[1], 3 * 15.5, 3);
  EXPECT_NEAR(took[0], 2 * took[1], 3);
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
