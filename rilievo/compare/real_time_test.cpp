#include "rilievo/compare/real_time.h"

#include <epoxy/gl.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <thread>

#include "rilievo/core/stopwatch.h"
#include "rilievo/gl/context_test_helpers.h"

namespace rilievo {
namespace {

// Draws nothing, for so many milliseconds; after a jump a bound is over its limit for two frames.
class Sleeper : public FrameSource {
 public:
  explicit Sleeper(int ms) : ms_(ms) {}
  Result<> draw(const Camera& camera, double) override {
    std::this_thread::sleep_for(std::chrono::milliseconds(ms_));
    const double x = camera.position().x;
    if (x > last_ + 50) bad_ = 2;
    last_ = x;
    stats_.bound_px = bad_ == 2 ? 3 : 0.5;
    stats_.gap_px = bad_ == 1 ? 2.5 : 2;
    bad_ -= bad_ > 0;
    stats_.captures = 1;
    eyes.push_back(x);
    return Done{};
  }
  Result<> draw_objects() override { return Done{}; }
  [[nodiscard]] const FrameStats& stats() const override { return stats_; }

  std::vector<double> eyes;

 private:
  FrameStats stats_;
  int ms_, bad_ = 0;
  double last_ = 0;
};

class RealTimeTest : public gl::ContextTest {
 protected:
  // The eye moves one metre in a second, and by a hundred at half a second.
  static WalkFrame walk(double seconds) {
    const double x = seconds + (seconds >= 0.5 ? 100.0 : 0.0);
    return {look_at({x, 0, 0}, {x, 0, -1}, {0, 1, 0}, 1, 16, 16, 0.1, 10), seconds};
  }
  static Result<RealTimeWalk> draw_walk(
      FrameSource& source, const RealTimeOptions& options,
      const std::function<WalkFrame(double seconds)>& eye = walk) {
    FrameSource* const sources[] = {&source};
    return walk_in_real_time(source, *DrawTargets::create(sources, 16, 16, 1), eye, options);
  }
};

TEST_F(RealTimeTest, frames_wait_for_the_display_where_they_are_to) {
  RealTimeOptions options;
  options.seconds = 0.2;
  options.kept = 1;
  options.waits = true;
  Sleeper quick(0);
  const Stopwatch watch;
  ASSERT_TRUE(draw_walk(quick, options).ok());
  // The last frame begins before the walk's end.
  EXPECT_GE(watch.ms(), 200 - 1000 / options.refresh);
}

// Sleeps take at least as long as they say, so that this depends on no clock from above.
TEST_F(RealTimeTest, a_slow_method_moves_further_from_frame_to_frame) {
  RealTimeOptions options;
  options.seconds = 0.9;
  options.kept = 4;
  options.refresh = 100;
  options.cuts = {0.5};
  Sleeper slow(30);
  const Result<RealTimeWalk> walked = draw_walk(slow, options);
  ASSERT_TRUE(walked.ok());
  EXPECT_GE(walked->first_frame_ms, 30);
  EXPECT_EQ(slow.eyes.size(), walked->frame_ms.size() + 1);
  EXPECT_LE(walked->frame_ms.size(), 31u);
  EXPECT_EQ(walked->captures, int(slow.eyes.size()));
  // The walk starts when the first frame is done.
  EXPECT_EQ(slow.eyes[0], 0.0);
  EXPECT_EQ(slow.eyes[1], 0.0);
  double clock = 0;
  for (std::size_t i = 1; i < slow.eyes.size(); ++i) {
    EXPECT_DOUBLE_EQ(slow.eyes[i], walk(clock).camera.position().x);
    clock += walked->frame_ms[i - 1] / 1000;
  }
  EXPECT_EQ(walked->kept.size(), 4u);
  // After the cut two frames are bad: up to the third one, if the walk gets there.
  double after_cut = 0;
  std::size_t bad = 0, seen = 0;
  for (std::size_t i = 1; i < slow.eyes.size(); ++i)
    if (slow.eyes[i] > 50 && ++seen <= 3) after_cut += walked->frame_ms[i - 1], bad += seen <= 2;
  EXPECT_EQ(walked->cut_fine_ms.has_value(), seen > 0);
  EXPECT_DOUBLE_EQ(walked->cut_fine_ms.value_or(0), after_cut);
  EXPECT_EQ(walked->cut_ms.has_value(), seen > 0);
  for (std::size_t i = slow.eyes.size(); i-- > 1;)
    if (slow.eyes[i] > 50 && slow.eyes[i - 1] < 50) {
      EXPECT_DOUBLE_EQ(walked->cut_ms.value_or(0), walked->frame_ms[i - 1]);
    }
  EXPECT_DOUBLE_EQ(walked->over_bound_share, double(bad) / double(slow.eyes.size()));
}

TEST_F(RealTimeTest, frames_in_a_row_follow_each_other) {
  RealTimeOptions options;
  options.seconds = 0.6;
  options.kept = 3, options.in_a_row = 2;
  options.refresh = 100;
  Sleeper slow(20);
  const Result<RealTimeWalk> walked = draw_walk(slow, options);
  ASSERT_TRUE(walked.ok());
  ASSERT_EQ(walked->kept.size(), 6u);
  EXPECT_EQ(walked->busy_ms.size() + 6, walked->frame_ms.size());
  const auto number_of = [&](std::size_t kept) {
    const double x = walked->kept[kept].first.camera.position().x;
    // The first two frames are of one eye.
    const auto found = std::find(slow.eyes.begin() + 1, slow.eyes.end(), x);
    return int(found - slow.eyes.begin());
  };
  for (std::size_t i = 0; i < 6; i += 2) {
    EXPECT_EQ(number_of(i + 1), number_of(i) + 1);
    EXPECT_GE(walked->kept[i].first.time, 0.2 * double(i / 2));
  }
}

TEST_F(RealTimeTest, a_fast_method_waits_for_the_display) {
  RealTimeOptions options;
  options.seconds = 0.4;
  options.kept = 2;
  options.refresh = 10;  // 100 ms: drawing nothing takes less
  Sleeper fast(0);
  const Result<RealTimeWalk> walked = draw_walk(fast, options);
  ASSERT_TRUE(walked.ok());
  EXPECT_LE(walked->frame_ms.size(), 5u);
  EXPECT_FALSE(walked->cut_ms);
  EXPECT_EQ(walked->over_bound_share, 0);
}

TEST_F(RealTimeTest, a_jump_there_and_back_between_two_frames_is_none) {
  RealTimeOptions options;
  options.seconds = 0.3;
  options.kept = 1;
  options.cuts = {0.1, 0.101};
  Sleeper slow(30);
  const auto stand = [](double seconds) {
    WalkFrame frame{walk(0).camera, seconds};
    frame.camera.world_from_eye[3].x += 1e-13 * seconds;  // rounding
    return frame;
  };
  const Result<RealTimeWalk> walked = draw_walk(slow, options, stand);
  ASSERT_TRUE(walked.ok());
  EXPECT_FALSE(walked->cut_ms);
  EXPECT_FALSE(walked->cut_fine_ms);
}

TEST(Cuts, are_where_two_keys_are_two_milliseconds_apart_or_less) {
  CameraPath path;
  for (const double time : {1.0, 1.5, 1.501, 2.0, 2.01})
    path.keys.push_back(look_key(time, {}, {0, 0, -1}, {0, 1, 0}, 1));
  EXPECT_EQ(cuts_of(path).size(), 1u);
  EXPECT_NEAR(cuts_of(path)[0], 0.501, 1e-12);
}

// Of 1.0 and 1.002 the difference is more than 0.002, if rounded.
TEST(Cuts, are_told_by_the_distance_of_keys_at_any_time) {
  CameraPath path;
  for (int i = 0; i < 100; ++i)
    for (const double time : {i + 0.0, i + 0.002, i + 0.5, i + 0.503})
      path.keys.push_back(look_key(time, {}, {0, 0, -1}, {0, 1, 0}, 1));
  EXPECT_EQ(cuts_of(path).size(), 100u);
}

}  // namespace
}  // namespace rilievo
