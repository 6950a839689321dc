#include "rilievo/keyframes/make_keyframe.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rilievo/capture/raster_source.h"
#include "rilievo/core/color.h"
#include "rilievo/core/random.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

struct MakerStage {
  BuiltinScene made = *make_builtin("builtin:stonehenge?triangles=20000");
  PlacedScene placed{made.scene};
  RasterSource source{placed};
  Camera frame = camera_at(made.path, 0.5, 200, 130);
};

std::uint32_t bytes_of_color(const glm::vec4& linear) {
  std::uint32_t bytes = 0xff000000u;
  for (int c = 0; c < 3; ++c)
    bytes |= std::uint32_t(srgb_from_linear(std::clamp(linear[c], 0.0f, 1.0f)) * 255 + 0.5f)
             << (8 * c);
  return bytes;
}

int most_apart(std::uint32_t a, std::uint32_t b) {
  int most = 0;
  for (int c = 0; c < 32; c += 8)
    most = std::max(most, std::abs(int(a >> c & 255) - int(b >> c & 255)));
  return most;
}

// Do the ranges hold all depths of their texels?
void expect_ranges(const Keyframe& key) {
  for (int y = 0; y < key.camera.height; ++y)
    for (int x = 0; x < key.camera.width; ++x) {
      const float w = key.inverse_z(x, y);
      if (w <= 0) continue;
      for (const InverseRange& range : {key.segments(x / Keyframe::kColumns, y),
                                        key.blocks(x / Keyframe::kColumns, y / Keyframe::kRows)}) {
        EXPECT_LE(range.farthest, w);
        EXPECT_GE(range.nearest, w);
      }
    }
}

TEST(MakeKeyframe, ShowsWhatTheSourceCaptures) {
  MakerStage stage;
  const Camera camera = keyframe_camera(stage.frame, 1.2);
  const auto key = make_keyframe(stage.source, {camera, {}, 4});
  ASSERT_TRUE(key);
  CaptureRequest request;
  request.camera = camera;
  request.with_sky = true;
  const auto captured = stage.source.capture(request);
  ASSERT_TRUE(captured);
  const DepthImage& picture = captured->picture;
  int sky = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      EXPECT_EQ(key->object(x, y), picture.object(x, y));
      const float depth = picture.depth(x, y);
      EXPECT_EQ(key->inverse_z(x, y), depth == kNoDepth ? 0.0f : 1 / depth);
      sky += depth == kNoDepth;
      // The table is good to a quarter of a byte: a rounding may go the other way.
      EXPECT_LE(most_apart(key->color(x, y), bytes_of_color(picture.color(x, y))), 1);
    }
  EXPECT_GT(sky, 0);
  EXPECT_LT(sky, camera.width * camera.height);
}

TEST(MakeKeyframe, BandsAreTheSameAsAllAtOnceButForTheRoundingOfTheirCameras) {
  MakerStage stage;
  const KeyframeRequest request{keyframe_camera(stage.frame, 1.2), {}, 4};
  const auto whole = make_keyframe(stage.source, request);
  ASSERT_TRUE(whole);
  KeyframeMaker maker;
  maker.begin(request);
  int steps = 0;
  for (; maker.busy(); ++steps) ASSERT_TRUE(maker.step(stage.source, 20));
  EXPECT_EQ(steps, (request.camera.width + 31) / 32);
  const Keyframe key = maker.take();
  // A band's camera is another window: samples on an edge may fall to the other side.
  int others = 0;
  for (std::size_t i = 0; i < key.object.texels().size(); ++i)
    others += key.object.texels()[i] != whole->object.texels()[i];
  EXPECT_LE(others, int(key.object.texels().size()) / 2000);
  expect_ranges(key);
}

TEST(MakeKeyframe, SixteenSamplesKeepTheSecondNearestOfFourDepths) {
  MakerStage stage;
  const Camera camera = keyframe_camera(stage.frame, 1);
  const auto key = make_keyframe(stage.source, {camera, {}, 16});
  ASSERT_TRUE(key);
  CaptureRequest request;
  request.camera = camera;
  request.camera.width *= 2, request.camera.height *= 2;
  request.with_sky = true;
  const auto captured = stage.source.capture(request);
  ASSERT_TRUE(captured);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      float inverse[4];
      for (int i = 0; i < 4; ++i) {
        const float depth = captured->picture.depth(2 * x + i % 2, 2 * y + i / 2);
        inverse[i] = depth == kNoDepth ? 0.0f : 1 / depth;
      }
      std::sort(inverse, inverse + 4);
      EXPECT_LE(std::abs(key->inverse_z(x, y) - inverse[2]), 0.03f * inverse[2]);
    }
}

TEST(MakeKeyframe, RangesHoldAllDepthsOfTheirTexels) {
  MakerStage stage;
  const auto key = make_keyframe(stage.source, {keyframe_camera(stage.frame, 1.3), {}, 1});
  ASSERT_TRUE(key);
  expect_ranges(*key);
}

TEST(KeyframeCamera, KeepsThePlacesOfTheFramesPixels) {
  MakerStage stage;
  const Camera key = keyframe_camera(stage.frame, 1.25);
  EXPECT_GE(key.width, 250);
  EXPECT_GE(key.height, 162);
  const int x0 = (key.width - 200) / 2, y0 = (key.height - 130) / 2;
  for (const glm::dvec2 at : {glm::dvec2(0, 0), glm::dvec2(200, 130), glm::dvec2(17.5, 101.5)}) {
    const glm::dvec3 there = raster_from_world(key, world_from_raster(stage.frame, at, 5));
    EXPECT_NEAR(there.x, at.x + x0, 1e-9);
    EXPECT_NEAR(there.y, at.y + y0, 1e-9);
  }
}

}  // namespace
}  // namespace rilievo
