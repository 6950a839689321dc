#include "rilievo/keyframes/software/keyframe_frames.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <thread>

#include "rilievo/capture/forwarding_source.h"
#include "rilievo/capture/ray_source.h"
#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/core/color.h"
#include "rilievo/keyframes/frame_difference_test_helpers.h"
#include "rilievo/method/test_source_test_helpers.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

constexpr int kWidth = 160, kHeight = 100;

TEST(KeyframeFrames, AWalkLooksLikeDirectFrames) {
  const BuiltinScene made = *make_builtin("builtin:bridge?triangles=100000");
  KeyframeFramesOptions options;
  options.keyframes.interval = 6;
  auto frames = KeyframeFrames::create(made.scene, options);
  ASSERT_TRUE(frames);
  // Frames of this walk have 0.1 to 0.31 %, all of it at the railing.
  constexpr double kMostWrong = 0.0035;
  TestSource direct = software_direct(made.scene, 4);
  for (int i = 0; i < 30; ++i) {
    const double time = frame_time(made.path, i);
    const Camera camera = camera_at(made.path, time, kWidth, kHeight);
    ASSERT_TRUE((*frames)->draw(camera, time));
    if (i % 4 != 1) continue;
    ASSERT_TRUE(direct.draw(camera, time));
    EXPECT_GT(psnr_of((*frames)->software_target()->color(), direct.software_target()->color()), 28)
        << i;
    ASSERT_TRUE((*frames)->draw_objects());
    ASSERT_TRUE(direct.draw_objects());
    EXPECT_LT(
        wrong_share((*frames)->software_target()->objects(), direct.software_target()->objects()),
        kMostWrong);
    EXPECT_LT(
        wrong_share(direct.software_target()->objects(), (*frames)->software_target()->objects()),
        kMostWrong);
  }
}

// Nothing there has to be polygons.
TEST(KeyframeFrames, AFrameThatIsTooLargeForTheRasteriserIsWarped) {
  const BuiltinScene made = *make_builtin("builtin:stonehenge?triangles=20000");
  auto frames = KeyframeFrames::create(made.scene, {});
  ASSERT_TRUE(frames);
  for (int i = 0; i < 3; ++i) {
    const double time = frame_time(made.path, i);
    const Result<> drawn = (*frames)->draw(camera_at(made.path, time, 4200, 40), time);
    ASSERT_TRUE(drawn) << drawn.error().message();
  }
  EXPECT_EQ((*frames)->software_target()->width(), 4200);
}

TEST(KeyframeFrames, WithALimitOfTimeFramesAreRightWhicheverWayTheyAreDrawn) {
  // Few triangles: polygons are cheaper, if anything is. What is drawn when depends on the machine.
  const BuiltinScene made = *make_builtin("builtin:stonehenge?triangles=20000");
  KeyframeFramesOptions options;
  options.keyframes.interval = 4, options.keyframes.keyframe_ms = 50;
  auto frames = KeyframeFrames::create(made.scene, options);
  ASSERT_TRUE(frames);
  TestSource direct = software_direct(made.scene, 4);
  for (int i = 0; i < 150; ++i) {
    const double time = frame_time(made.path, i);
    const Camera camera = camera_at(made.path, time, kWidth, kHeight);
    ASSERT_TRUE((*frames)->draw(camera, time));
    const KeyframeShares& shares = (*frames)->shares();
    EXPECT_EQ((*frames)->stats().count("keyframe") == 0, shares.direct);
    EXPECT_EQ((*frames)->stats().bound_px == 0, shares.direct);
    if (i % 7 != 1) continue;
    ASSERT_TRUE(direct.draw(camera, time));
    const double psnr =
        psnr_of((*frames)->software_target()->color(), direct.software_target()->color());
    EXPECT_GT(psnr, shares.direct ? 60 : 28) << i;
    ASSERT_TRUE((*frames)->draw_objects());
    ASSERT_TRUE(direct.draw_objects());
    // Keyframes come when the machine is ready: edges are two pixels off where they are old.
    EXPECT_LT(
        wrong_share(direct.software_target()->objects(), (*frames)->software_target()->objects()),
        0.008);
  }
}

// Objects of which the true frame shows more than so many pixels, and the other one none: of fewer
// an edge that is a pixel off may leave none.
int missing_objects(TestSource& truth, KeyframeFrames& shown, const Scene& scene) {
  EXPECT_TRUE(truth.draw_objects() && shown.draw_objects());
  const auto a = truth.software_target()->objects().texels();
  const auto b = shown.software_target()->objects().texels();
  int missing = 0;
  for (std::uint32_t object = 1; object <= scene.objects.size(); ++object)
    missing +=
        std::count(a.begin(), a.end(), object) > 20 && std::count(b.begin(), b.end(), object) == 0;
  return missing;
}

// Every frame after a cut, and while the eye turns by 180 degrees in 0.3 s, shows all that is
// there; the first ones may be coarse, which they say, and some keyframes later none is.
TEST(KeyframeFrames, CutsAndSuddenTurnsAreCompleteAndFineSomeKeyframesLater) {
  const BuiltinScene made = *make_builtin("builtin:stonehenge?triangles=20000");
  KeyframeFramesOptions options;
  options.keyframes.keyframe_ms = 4;
  options.polygons_where_cheaper = false;
  auto frames = KeyframeFrames::create(made.scene, options);
  ASSERT_TRUE(frames);
  TestSource direct = software_direct(made.scene, 4);
  const glm::dvec3 middle(world_bounds(made.scene).center());
  // Away from the middle at first, so that a turn ends where there is something to see.
  double angle = 0;
  const auto eye = [&](double turn) {
    const Camera first = camera_at(made.path, 0, kWidth, kHeight);
    const double distance = glm::length(first.position() - middle);
    const glm::dvec3 at = middle + distance * glm::dvec3(std::cos(angle), 0.2, std::sin(angle));
    const glm::dvec3 ahead =
        glm::rotate(glm::dmat4(1), turn, glm::dvec3(0, 1, 0)) * glm::dvec4(middle - at, 0);
    return look_at(at, at + ahead, {0, 1, 0}, 0.9, kWidth, kHeight, first.z_near, first.z_far);
  };
  int coarse = 0;
  // A keyframe takes at most 32 frames, whatever the time; two of them, and one that was given up.
  const int settles = 3 * 32 + 3;
  for (int event = 0; event < 10; ++event) {
    const bool turns = event % 2 == 1;
    angle += turns ? 0.0 : 2.2;
    const double from = turns ? 3.14159265 : 0;
    for (int i = 0; i < settles + 18; ++i) {
      const double turn = turns ? std::max(0.0, from * (1 - i / 18.0)) : 0;
      const Camera camera = eye(turn);
      ASSERT_TRUE((*frames)->draw(camera, 0));
      coarse += (*frames)->stats().late > 0;
      if (i % 6 == 0 && i <= 18) {
        ASSERT_TRUE(direct.draw(camera, 0));
        EXPECT_EQ(missing_objects(direct, **frames, made.scene), 0) << event << " " << i;
      }
    }
    EXPECT_EQ((*frames)->stats().late, 0) << event;
    ASSERT_TRUE(direct.draw(eye(0), 0));
    // An eye that stands has one keyframe of its own: its 4 samples and those of direct drawing
    // differ where things are finer than pixels.
    EXPECT_GT(psnr_of((*frames)->software_target()->color(), direct.software_target()->color()), 25)
        << event;
  }
  EXPECT_GT(coarse, 0);
}

// Away from things nothing is warped.
TEST(KeyframeFrames, ThePlainSkyIsThatOfDirectFrames) {
  const BuiltinScene made = *make_builtin("builtin:stonehenge?triangles=20000");
  auto frames = KeyframeFrames::create(made.scene, {});
  ASSERT_TRUE(frames);
  TestSource direct = software_direct(made.scene, 4);
  const auto eye = [](int i) {
    const glm::dvec3 at(0.1 * i, 1.7, 30);
    return look_at(at, at + glm::dvec3(0.01 * i, 0.5, -1), {0, 1, 0}, 0.9, 640, 360, 0.1, 200);
  };
  for (int i = 0; i < 12; ++i) {
    ASSERT_TRUE((*frames)->draw(eye(i), 0));
    if (i % 4 != 3) continue;
    ASSERT_TRUE(direct.draw(eye(i), 0));
    ASSERT_TRUE(direct.draw_objects());
    const Image<std::uint32_t>& objects = direct.software_target()->objects();
    const Rgba8Image &shown = (*frames)->software_target()->color(),
                     &expected = direct.software_target()->color();
    int sky = 0, others = 0;
    // The upper half of the frame.
    for (int y = 0; y < 180; ++y)
      for (int x = 0; x < 640; ++x) {
        if (objects(x, y) != kNoObject) continue;
        ++sky;
        others += shown(x, y) != expected(x, y);
      }
    EXPECT_GT(sky, 640 * 180 / 2);
    // Beside stones it is warped, and a step of a byte may be rounded.
    EXPECT_LT(others, sky / 5) << i;
  }
}

TEST(KeyframeFrames, HolesAreFilled) {
  // Keyframes without a margin and an eye that turns: a strip at the border is in none of them.
  const BuiltinScene made = *make_builtin("builtin:stonehenge?triangles=20000");
  KeyframeFramesOptions options;
  options.keyframes.margin = 1, options.keyframes.interval = 100;
  auto frames = KeyframeFrames::create(made.scene, options);
  ASSERT_TRUE(frames);
  TestSource direct = software_direct(made.scene, 4);
  const Camera before = camera_at(made.path, 0, kWidth, kHeight);
  Camera camera = before;
  const glm::dmat4 turn = glm::rotate(glm::dmat4(1), 0.05, glm::dvec3(0, 1, 0));
  for (int c = 0; c < 3; ++c) camera.world_from_eye[c] = turn * before.world_from_eye[c];
  ASSERT_TRUE((*frames)->draw(before, 0));
  ASSERT_TRUE((*frames)->draw(camera, 0));
  EXPECT_GT((*frames)->shares().filled, 0.02);
  EXPECT_EQ((*frames)->stats().filled_share, (*frames)->shares().filled);
  EXPECT_EQ((*frames)->stats().captures, 0);
  ASSERT_TRUE(direct.draw(camera, 0));
  // The strip, pixel by pixel: rays and triangles differ on edges only.
  const Rgba8Image &a = (*frames)->software_target()->color(),
                   &b = direct.software_target()->color();
  int apart = 0, count = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < 4; ++x, ++count)
      for (int c = 0; c < 3; ++c) {
        EXPECT_EQ(a(x, y).a, 255);
        if (std::abs(int(a(x, y)[c]) - int(b(x, y)[c])) > 3) {
          ++apart;
          break;
        }
      }
  EXPECT_LE(apart, count / 20);
}

TEST(KeyframeFrames, WhatIsNearIsDrawnAsPolygonsAndNothingBehindItIsMissing) {
  // Through a ring of stones, fast. Without near objects, as a yardstick, nothing is near.
  const BuiltinScene made = *make_builtin("builtin:stonehenge?triangles=20000");
  struct Seen {
    double psnr = 0, wrong = 0, live = 0;
    int missing = 0;
  };
  TestSource direct = software_direct(made.scene, 4);
  const auto walk = [&](double triangles) {
    KeyframeFramesOptions options;
    options.keyframes.interval = 6, options.keyframes.most_travel = HUGE_VAL;
    options.near.triangles = triangles;
    auto frames = KeyframeFrames::create(made.scene, options);
    Seen seen;
    for (int i = 0; i < 60; ++i) {
      // Never at a keyframe's own eye, where its pixels are copied.
      const glm::dvec3 eye(-9 + 0.3 * i + 0.01 * (i % 3), 1.7, 6);
      const Camera camera =
          look_at(eye, eye + glm::dvec3(0.8, 0, -1), {0, 1, 0}, 0.9, kWidth, kHeight, 0.1, 200);
      EXPECT_TRUE((*frames)->draw(camera, 0));
      if (i < 20 || i % 4 != 1) continue;
      EXPECT_TRUE(direct.draw(camera, 0));
      seen.psnr +=
          0.1 * psnr_of((*frames)->software_target()->color(), direct.software_target()->color());
      seen.missing += missing_objects(direct, **frames, made.scene);
      seen.wrong += 0.1 * wrong_share(direct.software_target()->objects(),
                                      (*frames)->software_target()->objects());
      seen.live += 0.1 * (*frames)->stats().live_share;
    }
    return seen;
  };
  const Seen without = walk(0), with = walk(200'000);
  EXPECT_EQ(without.live, 0);
  EXPECT_GT(with.live, 0.02);
  EXPECT_GT(with.psnr, without.psnr);
  EXPECT_LT(with.wrong, without.wrong);
  EXPECT_LT(with.wrong, 0.002);
  EXPECT_EQ(with.missing, 0);
}

// Posts before bars. Through a slit between two posts the eye sees the same bars again three metres
// on, and the same part of the wall: keyframes are as far apart, and others are seen between them.
TEST(KeyframeFrames, WhatBothKeyframesHideIsNotMissing) {
  Scene scene;
  const auto add_box = [&](const glm::vec3& center, const glm::vec3& half) {
    test_shapes::add(scene, test_shapes::box(half), {0.6f, 0.6f, 0.6f},
                     glm::translate(glm::mat4(1), center));
  };
  add_box({0, 0, -13}, {60, 60, 1});
  for (int i = -20; i <= 20; ++i) add_box({float(i), 0, -4}, {0.35f, 5, 0.05f});
  for (int i = -20; i <= 20; ++i) add_box({float(i) + 0.5f, 0, -6}, {0.1f, 0.5f, 0.05f});
  finish(scene);
  KeyframeFramesOptions options;
  options.keyframes.interval = 12, options.keyframes.most_travel = HUGE_VAL;
  options.most_filled = 1, options.near.distance = 0;
  auto frames = KeyframeFrames::create(scene, options);
  ASSERT_TRUE(frames);
  TestSource direct = software_direct(scene, 4);
  int missing = 0, live = 0;
  for (int i = 0; i < 60; ++i) {
    const glm::dvec3 eye(-7 + 0.25 * i, 0.3, 0);
    const Camera camera =
        look_at(eye, eye + glm::dvec3(0, 0, -1), {0, 1, 0}, 0.9, kWidth, kHeight, 0.1, 200);
    ASSERT_TRUE((*frames)->draw(camera, 0));
    live += (*frames)->shares().live;
    ASSERT_TRUE(direct.draw(camera, 0));
    missing += missing_objects(direct, **frames, scene);
  }
  EXPECT_GT(live, 0);
  EXPECT_EQ(missing, 0);
}

TEST(KeyframeFrames, ManyHolesShowWhatRaysFoundBefore) {
  const BuiltinScene made = *make_builtin("builtin:forest?triangles=200000");
  KeyframeFramesOptions options;
  options.keyframes.interval = 60, options.most_filled = 1, options.most_fine = 200;
  options.near.distance = 0;
  auto frames = KeyframeFrames::create(made.scene, options);
  ASSERT_TRUE(frames);
  TestSource direct = software_direct(made.scene, 4);
  int many = 0, next = 0;
  double least_psnr = 100, most_wrong = 0, cast = 0, filled = 0;
  for (int i = 0; i < 24; ++i) {
    const double time = frame_time(made.path, 4 * i);
    const Camera camera = camera_at(made.path, time, 3 * kWidth, 3 * kHeight);
    ASSERT_TRUE((*frames)->draw(camera, time));
    const KeyframeShares& shares = (*frames)->shares();
    // The first of them casts all.
    if (shares.filled * 9 * kWidth * kHeight <= 200 || many++ == 0) continue;
    cast += shares.cast, filled += shares.filled;
    if (next++ % 4 != 0) continue;
    ASSERT_TRUE(direct.draw(camera, time));
    least_psnr = std::min(least_psnr, psnr_of((*frames)->software_target()->color(),
                                              direct.software_target()->color()));
    ASSERT_TRUE((*frames)->draw_objects());
    ASSERT_TRUE(direct.draw_objects());
    most_wrong = std::max(most_wrong, wrong_share((*frames)->software_target()->objects(),
                                                  direct.software_target()->objects()));
  }
  EXPECT_GT(many, 8);
  EXPECT_LT(cast, 0.4 * filled);
  EXPECT_GT(least_psnr, 26);
  EXPECT_LT(most_wrong, 0.01);
}

// The eye turns, then jumps: frames of points, and at once after them a keyframe.
TEST(KeyframeFrames, AJumpFromManyHolesIsShownWhole) {
  const BuiltinScene made = *make_builtin("builtin:stonehenge?triangles=20000");
  KeyframeFramesOptions options;
  options.keyframes.interval = 40, options.most_fine = 50, options.near.distance = 0;
  auto frames = KeyframeFrames::create(made.scene, options);
  ASSERT_TRUE(frames);
  TestSource direct = software_direct(made.scene, 4);
  double most_wrong = 0;
  int cast = 0, at_once = 0;
  for (int i = 0; i < 60; ++i) {
    Camera camera = camera_at(made.path, 0, kWidth, kHeight);
    // 1.5 degrees a frame, and a jump of 120 every fifteenth.
    const double turn = glm::radians(1.5 * i + 120.0 * (i / 15));
    camera.world_from_eye = camera.world_from_eye * glm::rotate(glm::dmat4(1), turn, {0, 1, 0});
    ASSERT_TRUE((*frames)->draw(camera, 0));
    cast += (*frames)->shares().cast > 0, at_once += i > 0 && (*frames)->stats().captures > 0;
    ASSERT_TRUE(direct.draw(camera, 0));
    ASSERT_TRUE((*frames)->draw_objects());
    ASSERT_TRUE(direct.draw_objects());
    most_wrong = std::max(most_wrong, wrong_share((*frames)->software_target()->objects(),
                                                  direct.software_target()->objects()));
  }
  EXPECT_GT(cast, 20);
  EXPECT_GE(at_once, 3);
  EXPECT_LT(most_wrong, 0.01);
}

// Rays in a quarter of the light, before the same sky.
class Dim final : public ForwardingSource {
 public:
  explicit Dim(const RayScene& rays) : ForwardingSource(own_), own_(rays) {}
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override {
    Result<CapturedPicture> captured = source_.capture(request);
    if (!captured) return captured;
    DepthImage& picture = captured->picture;
    for (int y = 0; y < picture.camera.height; ++y)
      for (int x = 0; x < picture.camera.width; ++x)
        if (picture.covered(x, y)) picture.color(x, y) *= glm::vec4(kLight, kLight, kLight, 1);
    return captured;
  }
  static constexpr float kLight = 0.25f;

 private:
  RaySource own_;
};

// The share of pixels within objects that are more than twice as bright as by Dim.
double too_bright_share(const KeyframeFrames& frames, TestSource& direct, const Camera& camera) {
  EXPECT_TRUE(direct.draw(camera, 0));
  EXPECT_TRUE(direct.draw_objects());
  const Image<std::uint32_t>& objects = direct.software_target()->objects();
  const Rgba8Image &shown = frames.software_target()->color(),
                   &bright = direct.software_target()->color();
  int too_bright = 0;
  for (int y = 1; y + 1 < kHeight; ++y)
    for (int x = 1; x + 1 < kWidth; ++x) {
      // An edge may be a pixel off, and the sky is as bright.
      const std::uint32_t object = objects(x, y);
      bool within = object != kNoObject;
      for (int n = 0; n < 9; ++n)
        within = within && objects(x - 1 + n % 3, y - 1 + n / 3) == object;
      bool any = false;
      for (int c = 0; c < 3; ++c) {
        const float linear = linear_of_srgb_bytes()[bright(x, y)[c]];
        any = any || float(shown(x, y)[c]) > 255 * srgb_from_linear(2 * Dim::kLight * linear);
      }
      too_bright += within && any;
    }
  return double(too_bright) / (kWidth * kHeight);
}

Camera eye_beside_stones(double x) {
  const glm::dvec3 eye(x, 1.7, 6);
  return look_at(eye, eye + glm::dvec3(0.8, -0.2, -1), {0, 1, 0}, 0.9, kWidth, kHeight, 0.1, 200);
}

Result<std::unique_ptr<CaptureSource>> make_dim(const RayScene& rays) {
  return {std::make_unique<Dim>(rays)};
}

TEST(KeyframeFrames, HolesAreFilledInTheLightOfTheSource) {
  const BuiltinScene made = *make_builtin("builtin:stonehenge?triangles=20000");
  KeyframeFramesOptions options;
  options.keyframes.interval = 12, options.keyframes.most_travel = HUGE_VAL;
  options.most_filled = 1;
  auto frames = KeyframeFrames::create(made.scene, make_dim, options);
  ASSERT_TRUE(frames);
  TestSource direct = software_direct(made.scene, 4);
  double filled = 0, most_bright = 0;
  for (int i = 0; i < 40; ++i) {
    const Camera camera = eye_beside_stones(-8 + 0.2 * i);
    ASSERT_TRUE((*frames)->draw(camera, 0));
    if (i % 3 != 1) continue;
    filled += (*frames)->shares().filled / 13;
    most_bright = std::max(most_bright, too_bright_share(**frames, direct, camera));
  }
  EXPECT_GT(filled, 0.05);
  // Silhouettes within an object, 0.010. Where holes have the light of rays it is 0.09.
  EXPECT_LT(most_bright, 0.02);
}

// Beside the frames another thread finds what its light is.
TEST(KeyframeFrames, HolesAreInTheLightOfASourceBesideTheFrames) {
  const BuiltinScene made = *make_builtin("builtin:stonehenge?triangles=20000");
  KeyframeFramesOptions options;
  options.keyframes.beside = true;
  options.most_filled = 1;
  auto frames = KeyframeFrames::create(made.scene, make_dim, options);
  ASSERT_TRUE(frames);
  TestSource direct = software_direct(made.scene, 4);
  int keyframes = 0;
  double at = -8;
  for (int i = 0; i < 10'000 && keyframes < 4; ++i, at += 0.002) {
    ASSERT_TRUE((*frames)->draw(eye_beside_stones(at), 0));
    keyframes += (*frames)->shares().completed;
    // The first frames show a coarse keyframe in the light of rays.
    if (i == 0) {
      EXPECT_GT(too_bright_share(**frames, direct, eye_beside_stones(at)), 0.3);
    }
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  ASSERT_EQ(keyframes, 4);
  // Half a metre on, where they do not show all.
  const Camera on = eye_beside_stones(at + 0.5);
  ASSERT_TRUE((*frames)->draw(on, 0));
  EXPECT_GT((*frames)->shares().filled, 0.01);
  EXPECT_LT(too_bright_share(**frames, direct, on), 0.02);
}

TEST(KeyframeFrames, WhatMovesIsDrawnAsPolygonsInFrontOfAndBehindWhatStands) {
  BuiltinScene made = *make_builtin("builtin:teapots?triangles=20000");
  bool any = false;
  for (const Object& object : made.scene.objects) any = any || object.moving;
  ASSERT_TRUE(any) << "the scene should have something that moves";
  auto frames = KeyframeFrames::create(made.scene, {});
  ASSERT_TRUE(frames);
  TestSource direct = software_direct(made.scene, 4);
  for (int i = 0; i < 8; ++i) {
    const double time = frame_time(made.path, 4 * i);
    const Camera camera = camera_at(made.path, time, kWidth, kHeight);
    ASSERT_TRUE((*frames)->draw(camera, time));
    ASSERT_TRUE(direct.draw(camera, time));
    EXPECT_GT((*frames)->shares().live, 0);
    EXPECT_EQ((*frames)->stats().live_share, (*frames)->live_share());
    EXPECT_GT((*frames)->stats().live_share, 0);
    EXPECT_GT(psnr_of((*frames)->software_target()->color(), direct.software_target()->color()),
              30);
  }
}

}  // namespace
}  // namespace rilievo
