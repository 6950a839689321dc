// Do the bounds of keyframes hold for what is drawn?
#include "rilievo/keyframes/keyframe_bound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <memory>
#include <string>

#include "rilievo/compare/compare.h"
#include "rilievo/compare/drawn_error.h"
#include "rilievo/keyframes/software/keyframe_frames.h"
#include "rilievo/method/test_source_test_helpers.h"
#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/scene/position_colors.h"

namespace rilievo {
namespace {

struct BoundedWalk {
  std::uint64_t measured = 0, violations = 0, frames = 0;
  double largest_px = 0, bound_px = 0;
};

// Walks through the scene in colours that tell positions, by steps of two frames, with an eye
// that looks so many pixels past where it should.
BoundedWalk walk_bounded(const std::string& spec, int samples, double past_px) {
  constexpr int kAcross = 256, kDown = 144, kFrames = 24;
  const BuiltinScene made = *make_builtin(spec);
  CompareOptions options;
  options.width = kAcross, options.height = kDown, options.frames = kFrames;
  const auto walk = [&](int frame) {
    const double time = frame_time(made.path, 2 * frame);
    return WalkFrame{camera_at(made.path, time, kAcross, kDown), time};
  };
  TestSource direct = software_direct(made.scene, 4);
  const auto half_periods = choose_half_periods(made.scene, direct, walk, options);
  EXPECT_TRUE(half_periods.ok());
  const Scene coded = with_position_colors(made.scene, *half_periods);
  TestSource truth = software_direct(coded, 4);
  KeyframeFramesOptions keyframes;
  keyframes.keyframes.interval = 6, keyframes.keyframes.samples = samples;
  const auto shown = KeyframeFrames::create(coded, keyframes);
  EXPECT_TRUE(shown.ok());
  BoundedWalk walked;
  for (int i = 0; i < kFrames; ++i) {
    const WalkFrame frame = walk(i);
    const Result<DrawnFrame> right = draw_frame(truth, DrawTargets(), frame);
    WalkFrame past = frame;
    ImageWindow& window = past.camera.window;
    const double by = past_px * (window.right - window.left) / kAcross;
    window.left += by, window.right += by;
    const Result<DrawnFrame> seen = draw_frame(**shown, DrawTargets(), past);
    EXPECT_TRUE(right.ok() && seen.ok());
    EXPECT_GT(seen->stats.bound_px, 0);
    DrawnErrors errors;
    // Texels mix within two of them.
    const Image<PixelState> states = find_measurable(coded, *half_periods, frame, *right, 3);
    add_drawn_errors(coded, *half_periods, frame, *right, states, *seen, errors);
    walked.measured += errors.shown - errors.boundary - errors.mixed - errors.unresolved;
    walked.violations += errors.violations;
    walked.largest_px = std::max(walked.largest_px, errors.largest_px);
    walked.bound_px = std::max(walked.bound_px, seen->stats.bound_px.value());
    ++walked.frames;
  }
  return walked;
}

TEST(KeyframeBound, HoldsForEveryPixelThatIsMeasured) {
  std::uint64_t measured = 0;
  for (const char* spec : {"builtin:bridge?triangles=100000", "builtin:stonehenge?triangles=20000",
                           "builtin:teapots?triangles=20000"})
    for (const int samples : {1, 4}) {
      SCOPED_TRACE(spec);
      const BoundedWalk walked = walk_bounded(spec, samples, 0);
      EXPECT_EQ(walked.violations, 0u);
      EXPECT_GT(walked.measured, 10000u);
      measured += walked.measured;
      // Loose: everything is taken to be as near as the nearest thing. Of the largest error that
      // was drawn it is less than so many times.
      EXPECT_LT(walked.bound_px, 11 * walked.largest_px);
    }
  EXPECT_GT(measured, 1000000u);
}

TEST(KeyframeBound, TheSameComparisonFindsWhatIsFartherOff) {
  // More than the bound, and less than a quarter of the code's period, which looks like less.
  EXPECT_GT(walk_bounded("builtin:stonehenge?triangles=20000", 4, 6.2).violations, 1000u);
}

TEST(KeyframeBound, GrowsWithTheWayFromTheKeyframe) {
  const BuiltinScene made = *make_builtin("builtin:stonehenge?triangles=20000");
  Keyframe key;
  const Camera eye = camera_at(made.path, 0, 256, 144);
  resize(key, keyframe_camera(eye, 1.2));
  std::fill(key.inverse_z.texels().begin(), key.inverse_z.texels().end(), 0.1f);
  find_ranges(key, 0, key.camera.width);
  const WarpedKeyframe one{&key, 1};
  double before = 0;
  for (const double way : {0.0, 0.01, 0.1, 1.0}) {
    Camera frame = eye;
    frame.world_from_eye[3].x += way;
    const KeyframeBound bound = bound_keyframes({&one, 1}, frame);
    EXPECT_GT(bound.error_px, before);
    before = bound.error_px;
    // From the keyframe's own eye nothing is hidden.
    EXPECT_EQ(bound.gap_px > 0, way > 0);
  }
}

// A keyframe bounds no gap of what it does not look at.
TEST(KeyframeBound, TheGapIsThatOfAKeyframeThatSeesAllOfTheFrame) {
  const auto eye_at = [](double x, double turn) {
    const glm::dvec3 at(x, 0, 0), forward(std::sin(turn), 0, -std::cos(turn));
    return look_at(at, at + forward, {0, 1, 0}, 0.9, 256, 144, 0.1, 100);
  };
  const auto keyframe_of = [&](double x, double turn) {
    Keyframe key;
    resize(key, keyframe_camera(eye_at(x, turn), 1.2));
    std::fill(key.inverse_z.texels().begin(), key.inverse_z.texels().end(), 0.1f);
    find_ranges(key, 0, key.camera.width);
    return key;
  };
  const Camera frame = eye_at(0, 0);
  const Keyframe near = keyframe_of(0.01, 0), aside = keyframe_of(0.01, 0.3),
                 far = keyframe_of(-0.5, 0);
  const auto gap = [&](std::initializer_list<const Keyframe*> keys) {
    std::vector<WarpedKeyframe> all;
    for (const Keyframe* key : keys) all.push_back({key, 1});
    return bound_keyframes(all, frame).gap_px;
  };
  EXPECT_GT(gap({&far}), 10 * gap({&near}));
  EXPECT_EQ(gap({&near, &far}), gap({&near}));
  EXPECT_EQ(gap({&aside, &far}), gap({&far}));
  EXPECT_EQ(gap({&aside, &near}), gap({&near}));
}

}  // namespace
}  // namespace rilievo
