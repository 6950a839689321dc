// OpenGL's warp against the processors', which has a slow twin of its own.
#include "rilievo/keyframes/gl/keyframe_warper.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <vector>

#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/keyframes/random_keyframes_test_helpers.h"
#include "rilievo/render/opengl/frame_target.h"

namespace rilievo {
namespace {

// Pixels that differ in kind (hole, covered, plain sky, colour), by more than a step of a colour,
// or in depth.
struct Difference {
  std::size_t kind = 0, color = 0, depth = 0, pixels = 0;

  void add(const WarpedFrame& a, const WarpedFrame& b) {
    ASSERT_EQ(a.color.width(), b.color.width());
    ASSERT_EQ(a.color.height(), b.color.height());
    for (std::size_t i = 0; i < a.color.texels().size(); ++i) {
      const std::uint32_t first = a.color.texels()[i], second = b.color.texels()[i];
      ++pixels;
      if (first >> 24 != second >> 24) {
        ++kind;
        continue;
      }
      const float w = a.inverse_z.texels()[i];
      depth += std::abs(w - b.inverse_z.texels()[i]) > 1e-4f * w;
      const auto step = [&](int shift) {
        return std::abs(int(first >> shift & 255) - int(second >> shift & 255));
      };
      color += std::max({step(0), step(8), step(16)}) > 1;
    }
  }
};

class KeyframeWarperTest : public gl::ContextTest {
 protected:
  void SetUp() override {
    gl::ContextTest::SetUp();
    Result<KeyframeWarper> made = KeyframeWarper::create();
    ASSERT_TRUE(made.ok()) << made.error().message();
    warper_ = std::move(*made);
  }
  void warp(std::span<const WarpedKeyframe> keys, const Camera& frame, WarpedFrame& out,
            const WarpCoverTexture* cover = nullptr, bool leaves_sky = false) {
    const Result<> done = warper_->warp(keys, frame, cover, leaves_sky, out);
    ASSERT_TRUE(done.ok()) << done.error().message();
    EXPECT_TRUE(gl::check_errors("warp").ok());
  }

  std::optional<KeyframeWarper> warper_;
};

TEST_F(KeyframeWarperTest, FramesAreThoseOfProcessors) {
  Random random(5);
  Difference of_plain, of_covered, of_sky;
  for (int i = 0; i < 24; ++i) {
    const Camera frame = random_eye(random, 130 + 7 * (i % 3), 90 + i % 5);
    std::vector<Keyframe> keys;
    for (int k = 0; k < 1 + i % 4; ++k)
      keys.push_back(random_keyframe(
          random,
          keyframe_camera(random_eye(random, frame.width, frame.height), 1.2, k == 2 ? 0.5 : 1),
          (i + k) % 3 > 0));
    if (i % 3 == 2)
      for (Keyframe& key : keys) hide_objects(key, std::vector<std::uint32_t>{3, 17, 30, 38});
    if (i % 4 == 1)
      for (float& w : keys[0].inverse_z.texels()) w = std::abs(w) > 0.02f ? w : 0;
    find_ranges(keys[0], 0, keys[0].camera.width);
    std::vector<WarpedKeyframe> warped;
    for (const Keyframe& key : keys)
      warped.push_back({&key, float(random.between(0.1, 2)), warped.size() % 2 == 1 && i % 2 == 1});

    // Of blocks: the GPU takes the farthest of the nine pixels around each.
    Image<float> cover(frame.width, frame.height);
    for (int y = 10; y < 60; ++y)
      for (int x = 5; x < 90; ++x)
        cover(x, y) = x / 12 % 2 == y / 9 % 2 ? 0.0f : 1 / (1.0f + float(x));
    Image<float> window_z(frame.width, frame.height), covers(frame.width, frame.height);
    for (int y = 0; y < frame.height; ++y)
      for (int x = 0; x < frame.width; ++x) {
        const double n = frame.z_near, f = frame.z_far;
        window_z(x, frame.height - 1 - y) =
            cover(x, y) > 0 ? float((1 - n * double(cover(x, y))) * f / (f - n)) : 1.0f;
        float least = 1e30f;
        for (int k = 0; k < 9; ++k)
          least = std::min(least, cover(std::clamp(x + k % 3 - 1, 0, frame.width - 1),
                                        std::clamp(y + k / 3 - 1, 0, frame.height - 1)));
        covers(x, y) = least;
      }
    const gl::Texture texture = gl::make_texture_2d(GL_R32F, frame.width, frame.height);
    glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
    glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
    glTextureSubImage2D(texture, 0, 0, 0, frame.width, frame.height, GL_RED, GL_FLOAT,
                        window_z.texels().data());

    WarpedFrame expected, drawn;
    warp_keyframes(warped, frame, expected);
    warp(warped, frame, drawn);
    of_plain.add(expected, drawn);
    EXPECT_NEAR(double(drawn.holes()), double(expected.holes()), 0.01 * frame.width * frame.height);
    const float nearest = i % 2 ? 0.2f : 2.0f;
    const WarpCover some{&covers, nearest};
    warp_keyframes(warped, frame, expected, &some);
    const WarpCoverTexture on_gpu{texture, nearest};
    warp(warped, frame, drawn, &on_gpu);
    of_covered.add(expected, drawn);
    warp_keyframes(warped, frame, expected, nullptr, true);
    warp(warped, frame, drawn, nullptr, true);
    of_sky.add(expected, drawn);
  }
  // A product and a sum that are rounded once, not twice, place a texel's square a pixel farther
  // now and then.
  for (const Difference& one : {of_plain, of_covered, of_sky}) {
    const double pixels = double(one.pixels);
    EXPECT_LT(double(one.kind) / pixels, 2e-3);
    EXPECT_LT(double(one.depth) / pixels, 5e-3);
    EXPECT_LT(double(one.color) / pixels, 5e-3);
  }
}

TEST_F(KeyframeWarperTest, AnEyeThatStandsSeesTheTexels) {
  Random random(6);
  const Camera frame = random_eye(random, 128, 90);
  const Keyframe key = random_keyframe(random, keyframe_camera(frame, 1.25), true);
  const WarpedKeyframe one{&key, 1};
  WarpedFrame expected, drawn;
  warp_keyframes({&one, 1}, frame, expected);
  warp({&one, 1}, frame, drawn);
  EXPECT_EQ(drawn.color, expected.color);
  EXPECT_EQ(drawn.inverse_z, expected.inverse_z);
  EXPECT_EQ(drawn.holes(), 0u);
}

TEST_F(KeyframeWarperTest, KeyframesAreUploadedOnce) {
  Random random(7);
  const Camera frame = random_eye(random, 128, 90);
  std::vector<Keyframe> keys;
  for (std::uint64_t i = 1; i <= 3; ++i) {
    keys.push_back(
        random_keyframe(random, keyframe_camera(random_eye(random, 128, 90), 1.2), true));
    keys.back().number = i;
  }
  const std::size_t depths = keys[0].inverse_z.texels().size_bytes(),
                    colors = keys[0].color.texels().size_bytes();
  WarpedFrame expected, drawn;
  const auto uploaded = [&](std::size_t first, std::size_t second) {
    const WarpedKeyframe two[] = {{&keys[first], 1}, {&keys[second], 2}};
    warp_keyframes(two, frame, expected);
    warp(two, frame, drawn);
    Difference all;
    all.add(expected, drawn);
    EXPECT_LT(double(all.kind + all.color + all.depth), 0.01 * double(all.pixels));
    return warper_->uploaded();
  };
  EXPECT_EQ(uploaded(0, 1), 2 * (colors + depths));
  EXPECT_EQ(uploaded(0, 1), 0u);
  EXPECT_EQ(uploaded(1, 0), 0u);
  // The third one takes the place of the one that is not used.
  EXPECT_EQ(uploaded(1, 2), colors + depths);
  hide_objects(keys[1], std::vector<std::uint32_t>{4, 20});
  EXPECT_EQ(uploaded(1, 2), depths);
  EXPECT_EQ(uploaded(1, 2), 0u);
  EXPECT_EQ(uploaded(0, 2), colors + depths);
}

TEST_F(KeyframeWarperTest, WhatIsFilledIsShownWithItsDepth) {
  Random random(8);
  const Camera frame = random_eye(random, 128, 90);
  const Keyframe key =
      random_keyframe(random, keyframe_camera(random_eye(random, 128, 90), 1.2), true);
  const WarpedKeyframe one{&key, 1};
  WarpedFrame drawn;
  warp({&one, 1}, frame, drawn);
  std::vector<FilledHole> holes;
  for (std::uint32_t y = 0; y < 90; ++y)
    for (std::uint32_t x = 0; x < 128; ++x) {
      if (!drawn.hole(int(x), int(y))) continue;
      FilledHole hole{x, y, 0xff000000u | (x << 8 | y), float(random.between(0.02, 5))};
      // Some stay holes, which are left to the sky.
      if (random.between(0, 1) < 0.2) hole.color = kPlainSky, hole.inverse_z = 0;
      holes.push_back(hole);
      drawn.color(int(x), int(y)) = hole.color, drawn.inverse_z(int(x), int(y)) = hole.inverse_z;
    }
  EXPECT_GT(holes.size(), 100u);
  warper_->fill(holes);
  Result<FrameTarget> target = FrameTarget::create(128, 90, 4);
  target->begin();
  warper_->show(frame);
  target->resolve();
  EXPECT_TRUE(gl::check_errors("show").ok());
  const Rgba8Image shown = target->read();
  const Image<float> eye_z = target->read_eye_z(frame);
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 128; ++x) {
      const std::uint32_t color = drawn.color(x, y);
      const bool opaque = color >> 24 == 255;
      const glm::u8vec4 expected(color & 255, color >> 8 & 255, color >> 16 & 255, 255);
      EXPECT_EQ(shown(x, y), opaque ? expected : glm::u8vec4(0, 0, 0, 255)) << x << " " << y;
      const float w = drawn.inverse_z(x, y);
      if (opaque && w > 0) {
        // 24 bits of depth.
        EXPECT_NEAR(1 / eye_z(x, y), w, 1e-4) << x << " " << y;
      }
    }
}

}  // namespace
}  // namespace rilievo
