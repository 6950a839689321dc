// OpenGL's warp against the processors', which has a slow twin of its own.
#include "rilievo/keyframes/gl/keyframe_warper.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>
#include <vector>

#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/keyframes/gl/cover_target.h"
#include "rilievo/keyframes/gl/unfiltered_texture.h"
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

// Depths as OpenGL draws them, a number for each sample: the samples of a pixel are drawn one after
// the other.
class DrawnDepths {
 public:
  static constexpr int kSamples = 4;

  DrawnDepths(const Camera& frame, const std::vector<Image<float>>& inverse_z)
      : target_(std::move(*CoverTarget::create(frame.width, frame.height, kSamples))) {
    const auto program = gl::make_program("depths", R"(#version 450
void main() {
  gl_Position = vec4(vec2(gl_VertexID & 1, gl_VertexID >> 1) * 4.0 - 1.0, 0.0, 1.0);
}
)",
                                          R"(#version 450
layout(binding = 0) uniform sampler2D window_z;
layout(location = 0) uniform int chosen;
void main() {
  gl_SampleMask[0] = 1 << chosen;
  gl_FragDepth = texelFetch(window_z, ivec2(gl_FragCoord.xy), 0).r;
}
)");
    EXPECT_TRUE(program.ok());
    const gl::VertexArray none = gl::make_vertex_array();
    target_.begin();
    glUseProgram(*program);
    glBindVertexArray(none);
    glEnable(GL_DEPTH_TEST);
    glDepthFunc(GL_ALWAYS);
    for (int s = 0; s < kSamples; ++s) {
      Image<float> window_z(frame.width, frame.height);
      const double n = frame.z_near, f = frame.z_far;
      for (int y = 0; y < frame.height; ++y)
        for (int x = 0; x < frame.width; ++x) {
          const double w = double(inverse_z[std::size_t(s)](x, y));
          window_z(x, frame.height - 1 - y) = w > 0 ? float((1 - n * w) * f / (f - n)) : 1.0f;
        }
      const gl::Texture texture = make_unfiltered(GL_R32F, frame.width, frame.height);
      glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
      glTextureSubImage2D(texture, 0, 0, 0, frame.width, frame.height, GL_RED, GL_FLOAT,
                          window_z.texels().data());
      glBindTextureUnit(0, texture);
      glUniform1i(0, s);
      glDrawArrays(GL_TRIANGLES, 0, 3);
    }
    glFinish();
  }
  [[nodiscard]] WarpCoverTexture cover(float nearest) const {
    return {target_.depth(), target_.samples(), nearest};
  }

 private:
  CoverTarget target_;
};

TEST_F(KeyframeWarperTest, FramesAreThoseOfProcessors) {
  Random random(5);
  Difference of_plain, of_covered, of_sky;
  std::size_t holes = 0, covered = 0, open_under_cover = 0, plain = 0;
  const auto count = [](const WarpedFrame& frame, std::uint32_t color) {
    return std::size_t(std::ranges::count(frame.color.texels(), color));
  };
  for (int i = 0; i < 32; ++i) {
    // Of the last ones slanted surfaces have cracks.
    const bool steep = i >= 24;
    const double apart = steep ? 5 : 0.5;
    const Camera frame = random_eye(random, 130 + 7 * (i % 3), 90 + i % 5, apart);
    std::vector<Keyframe> keys;
    for (int k = 0; k < 1 + i % 3; ++k) {
      Keyframe& key = keys.emplace_back(
          random_keyframe(random,
                          keyframe_camera(random_eye(random, frame.width, frame.height, apart), 1.4,
                                          k == 2 ? 0.5 : 1),
                          (i + k) % 3 > 0, steep));
      // Sky above things, in every other frame.
      if (i % 2 == 0) {
        const int finer = key.quarters() ? 2 : 1;
        for (int y = 0; y < 2 * key.camera.height / 3; ++y)
          for (int x = 0; x < key.camera.width; ++x) key.inverse_z(x, y) = 0;
        for (int y = 0; y < finer * 2 * key.camera.height / 3; ++y)
          for (std::uint32_t& color : key.color.row(y)) color = (color & 0xffffffu) | kWholeTexel;
        find_ranges(key, 0, key.camera.width);
      }
    }
    if (i % 3 == 2)
      for (Keyframe& key : keys) hide_objects(key, std::vector<std::uint32_t>{3, 17, 30, 38});
    std::vector<WarpedKeyframe> warped;
    for (const Keyframe& key : keys)
      warped.push_back({&key, float(random.between(0.1, 2)), warped.size() % 2 == 1 && i % 2 == 1});

    // Blocks, the border of each of which covers its pixels in part.
    std::vector<Image<float>> samples(4, Image<float>(frame.width, frame.height));
    Image<float> farthest(frame.width, frame.height);
    for (int y = 0; y < frame.height; ++y)
      for (int x = 0; x < frame.width; ++x) {
        const bool any = x / 12 % 2 != y / 9 % 2, inside = x % 12 != 0;
        for (std::size_t s = 0; s < 4; ++s)
          samples[s](x, y) = any && (inside || s < 2) ? 1 / (1 + 0.3f * float(x) + float(s)) : 0;
        farthest(x, y) = any && inside ? samples[3](x, y) : 0;
      }
    const DrawnDepths drawn_depths(frame, samples);

    WarpedFrame expected, drawn;
    warp_keyframes(warped, frame, expected);
    warp(warped, frame, drawn);
    of_plain.add(expected, drawn);
    holes += expected.holes();
    EXPECT_EQ(drawn.holes(), count(drawn, 0));
    const float nearest = i % 2 ? 0.06f : 2.0f;
    const WarpCover some{&farthest, nearest};
    const WarpCoverTexture on_gpu = drawn_depths.cover(nearest);
    warp_keyframes(warped, frame, expected, &some);
    warp(warped, frame, drawn, &on_gpu);
    of_covered.add(expected, drawn);
    covered += count(expected, kCoveredPixel);
    for (std::size_t k = 0; k < farthest.texels().size(); ++k)
      open_under_cover += farthest.texels()[k] > 0 && expected.color.texels()[k] == 0;
    warp_keyframes(warped, frame, expected, nullptr, true);
    warp(warped, frame, drawn, nullptr, true);
    of_sky.add(expected, drawn);
    plain += count(expected, kPlainSky);
  }
  for (const std::size_t occurs : {holes, covered, open_under_cover, plain})
    EXPECT_GT(occurs, 500u);
  // A product and a sum that are rounded once, not twice, place a texel's square a pixel farther
  // now and then. Mesa's software driver rounds as processors do.
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
  // A smaller one lies in the corner of a larger one's texture.
  keys.push_back(random_keyframe(random, keyframe_camera(random_eye(random, 128, 90), 0.7), true));
  keys.back().number = 4;
  EXPECT_EQ(uploaded(2, 3),
            keys[3].color.texels().size_bytes() + keys[3].inverse_z.texels().size_bytes());
  EXPECT_EQ(uploaded(3, 2), 0u);
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
  warper_->show_sky(frame);
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
