#include "rilievo/method/auto_keyframes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

TEST(AutoKeyframes, frames_begin_with_one_alone_that_loses_little_and_the_second_one_comes_soon) {
  const auto built = make_builtin("builtin:stonehenge?triangles=20000");
  ASSERT_TRUE(built.ok());
  KeyframeFramesOptions options;
  options.polygons_where_cheaper = false;
  const auto camera = [&](int i) {
    return camera_at(built->path, frame_time(built->path, i), 160, 90);
  };
  constexpr double kAny = 1000;
  for (const AloneLoss& may_lose :
       {AloneLoss{kAny, kAny}, AloneLoss{kAny, -kAny}, AloneLoss{-kAny, -kAny}}) {
    const bool begins = may_lose.most > 0, alone = may_lose.alone > 0;
    const auto frames = KeyframeFrames::create(built->scene, options);
    ASSERT_TRUE(frames.ok() && (*frames)->prepare_first(camera(0), 0).ok());
    EyePrediction eye;
    eye.follow(camera(0));
    eye.follow(camera(1));
    const Result<BegunKeyframes> begun = begin_keyframes(eye, 0, may_lose, **frames);
    ASSERT_TRUE(begun.ok());
    EXPECT_TRUE(begun->loss_db);
    EXPECT_EQ(begun->begun, begins);
    EXPECT_EQ(begun->alone, alone);
    EXPECT_EQ((*frames)->prepared(), begins && !alone);
    // The frames go on from what there is.
    int made_in = 0;
    for (int i = 1; i < 60 && made_in == 0; ++i) {
      ASSERT_TRUE((*frames)->draw(camera(i), 0).ok());
      if ((*frames)->prepared()) made_in = i;
    }
    if (begins && !alone) continue;
    // At most 16 frames from the third one on, and one until it is taken.
    EXPECT_GT(made_in, 3);
    EXPECT_LE(made_in, 19);
  }
}

TEST(AutoKeyframes, an_eye_tells_how_many_frames_nobody_took) {
  SharedEye shared;
  for (const int frames : {1, 3, 2}) {
    for (int i = 0; i < frames; ++i) shared.post({}, 0);
    EXPECT_EQ(shared.next()->frames, frames);
  }
  shared.post({}, 0);
  shared.forget();
  shared.post({}, 0);
  EXPECT_EQ(shared.next()->frames, 1);
}

// Keyframes are made for an eye some steps ahead; if a frame that was missed were a step of their
// own they would be made for one as many times as far.
TEST(AutoKeyframes, frames_that_go_by_send_no_keyframe_farther_ahead) {
  constexpr int kParts = 3, kAhead = 60;
  const auto camera = [](double frame) {
    // It turns a little, too: by at most 0.2 rad.
    return look_at({0.01 * frame, 2, 30}, {0.01 * frame + 6 * std::sin(0.005 * frame), 2, 0},
                   {0, 1, 0}, 1, 160, 90, 1, 200);
  };
  EyePrediction predicted;
  for (int frame = 0; frame < 40; ++frame) predicted.follow(camera(-900 + 9 * frame));
  int now = 0;
  for (const int frames : {1, 7, 1, 2, 40, 3, 5}) {
    now += frames;
    const bool anew = frames == now;
    double last = -HUGE_VAL;
    for (const double at : way_to_frame(frames, kParts, anew)) {
      EXPECT_GT(at, last);
      if (!anew) {
        EXPECT_GT(at, -frames);
      }
      last = at;
      predicted.follow(camera(now + at));
    }
    EXPECT_EQ(last, 0);
    // Where the eye was 20 frames ago, as far as it can know.
    const Camera before = predicted.after(-20);
    EXPECT_GT(glm::dot(before.forward(), camera(now - 20).forward()), std::cos(0.1)) << now;
    const double ahead = (predicted.after(kAhead).position().x - camera(now).position().x) / 0.01;
    EXPECT_LT(ahead, 1.05 * kAhead) << now;
    EXPECT_GT(ahead, kAhead / 3.0 - 1) << now;
  }
}

}  // namespace
}  // namespace rilievo
