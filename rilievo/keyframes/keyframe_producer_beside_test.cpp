// Sources that take long, beside the frames.
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <mutex>
#include <semaphore>
#include <thread>
#include <vector>

#include "rilievo/core/stopwatch.h"
#include "rilievo/keyframes/keyframe_producer.h"
#include "rilievo/keyframes/producer_stage_test_helpers.h"

namespace rilievo {
namespace {

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

}  // namespace
}  // namespace rilievo
