#include "rilievo/keyframes/make_keyframe.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "rilievo/capture/forwarding_source.h"
#include "rilievo/capture/raster_source.h"
#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/core/color.h"
#include "rilievo/core/random.h"
#include "rilievo/keyframes/warp_keyframes.h"
#include "rilievo/method/test_source_test_helpers.h"
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
  std::uint32_t bytes = kWholeTexel;
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

// A line of a pixel is a texel wide, which is two quarters, wherever it lies between texels.
TEST(MakeKeyframe, LinesAreAsWideAsInFrames) {
  Scene scene;
  Mesh mesh;
  mesh.primitive = Primitive::lines;
  mesh.positions = {{0, -5, 0}, {0, 5, 0}};
  mesh.indices = {0, 1};
  mesh.material = 0;
  Material& red = scene.materials.emplace_back();
  red.base_color = {1, 0, 0, 1}, red.unlit = true;
  scene.meshes.push_back(mesh);
  scene.models.emplace_back().parts = {Part{0}};
  scene.objects.emplace_back();
  finish(scene);
  PlacedScene placed(scene);
  RasterSource source(placed);
  for (const bool in_parts : {true, false}) {
    for (int i = 0; i < 8; ++i) {
      const Camera camera =
          look_at({0.01 * i, 0, 4}, {0.01 * i, 0, 0}, {0, 1, 0}, 0.9, 60, 40, 0.1, 100);
      // Sixteen samples are never captured in parts.
      const auto key = make_keyframe(source, {camera, {}, in_parts ? 4 : 16});
      ASSERT_TRUE(key);
      ASSERT_TRUE(key->quarters());
      for (int y = 0; y < 80; ++y) {
        int wide = 0;
        for (int x = 0; x < 120; ++x) {
          const std::uint32_t color = key->color(x, y);
          wide += (color & 255) > (color >> 8 & 255) + 16;
        }
        // Of four samples a quarter, those at the line's sides are hit in part.
        EXPECT_GE(wide, 2) << y;
        EXPECT_LE(wide, 3) << y;
      }
    }
  }
}

TEST(MakeKeyframe, ShowsWhatTheSourceCaptures) {
  MakerStage stage;
  const Camera camera = keyframe_camera(stage.frame, 1.2);
  const auto key = make_keyframe(stage.source, {camera, {}, 4, true});
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

// A source that captures at once, whatever the other one can do.
struct AtOnce final : ForwardingSource {
  using ForwardingSource::ForwardingSource;
};

TEST(MakeKeyframe, BandsAreTheSameAsAllAtOnceButForTheRoundingOfTheirCameras) {
  MakerStage stage;
  const KeyframeRequest request{keyframe_camera(stage.frame, 1.2), {}, 4};
  const auto whole = make_keyframe(stage.source, request);
  ASSERT_TRUE(whole);
  AtOnce bands(stage.source);
  KeyframeMaker maker;
  maker.begin(request);
  int steps = 0;
  for (; maker.busy(); ++steps) ASSERT_TRUE(maker.step(bands, 20));
  EXPECT_FALSE(maker.in_parts());
  EXPECT_EQ(steps, (request.camera.width + 31) / 32);
  const Keyframe key = maker.take();
  // A band's camera is another window: samples on an edge may fall to the other side.
  int others = 0;
  for (std::size_t i = 0; i < key.object.texels().size(); ++i)
    others += key.object.texels()[i] != whole->object.texels()[i];
  EXPECT_LE(others, int(key.object.texels().size()) / 2000);
  expect_ranges(key);
}

TEST(MakeKeyframe, PartsAreTheSameAsAllAtOnce) {
  MakerStage stage;
  KeyframeMaker maker;
  KeyframeRequest request{keyframe_camera(stage.frame, 1.2), {}, 4};
  // The maker keeps its memory: a smaller one, and one of some objects, come after a large one.
  const std::vector<std::uint32_t> some = {0, 2, 3, 5, 8};
  for (int round = 0; round < 3; ++round) {
    if (round == 1) request.objects = some;
    if (round == 2) request.camera = keyframe_camera(stage.frame, 1);
    const auto whole = make_keyframe(stage.source, request);
    ASSERT_TRUE(whole);
    maker.begin(request);
    while (maker.busy()) ASSERT_TRUE(maker.step(stage.source, 7));
    EXPECT_TRUE(maker.in_parts());
    const Keyframe key = maker.take();
    // Of surfaces that are equally near the first one stays, and near objects come first.
    int others = 0;
    for (std::size_t i = 0; i < key.object.texels().size(); ++i)
      others += key.object.texels()[i] != whole->object.texels()[i];
    EXPECT_LE(others, int(key.object.texels().size()) / 5000);
    int colors = 0;
    for (std::size_t i = 0; i < key.color.texels().size(); ++i)
      colors += most_apart(key.color.texels()[i], whole->color.texels()[i]) > 1;
    EXPECT_LE(colors, int(key.color.texels().size()) / 2000);
    expect_ranges(key);
  }
}

TEST(MakeKeyframe, OfASourceWithoutPartsBandsAreCaptured) {
  MakerStage stage;
  AtOnce source(stage.source);
  const KeyframeRequest request{keyframe_camera(stage.frame, 1.2), {}, 4};
  KeyframeMaker maker;
  maker.begin(request);
  while (maker.busy()) ASSERT_TRUE(maker.step(source, 48));
  EXPECT_FALSE(maker.in_parts());
  const Keyframe key = maker.take();
  const auto whole = make_keyframe(source, request);
  int others = 0;
  for (std::size_t i = 0; i < key.object.texels().size(); ++i)
    others += key.object.texels()[i] != whole->object.texels()[i];
  EXPECT_LE(others, int(key.object.texels().size()) / 2000);
  expect_ranges(key);
}

TEST(MakeKeyframe, WhatIsTooLargeForPartsIsCapturedInBands) {
  MakerStage stage;
  KeyframeMaker maker;
  Camera camera = keyframe_camera(stage.frame, 1);
  camera.width = 2100, camera.height = 20;
  maker.begin({camera, {}, 4});
  while (maker.busy()) ASSERT_TRUE(maker.step(stage.source, 700));
  EXPECT_FALSE(maker.in_parts());
  expect_ranges(maker.take());
  // What cannot be captured either way says why.
  camera.height = 4000;
  maker.begin({camera, {}, 4});
  const Result<> made = maker.step(stage.source, 16);
  ASSERT_FALSE(made);
  EXPECT_NE(made.error().reason.find("texels a side"), std::string::npos);
}

// Frames of any size have keyframes: of high ones with fewer texels, of wide ones in bands.
TEST(MakeKeyframe, LargeFramesHaveKeyframesTheRasteriserCanCapture) {
  MakerStage stage;
  for (const glm::ivec2 size : {glm::ivec2(3840, 2160), {1080, 1920}, {40, 6000}, {2200, 30}}) {
    for (const double margin : {1.0, 1.2, 1.44}) {
      Camera frame = stage.frame;
      frame.width = size.x, frame.height = size.y;
      const Camera camera = keyframe_camera(frame, margin, 1, Keyframe::kMostRowsWithQuarters);
      EXPECT_LE(camera.height, Keyframe::kMostRowsWithQuarters);
      // Its window holds the margin, and its texels are square where pixels are.
      const auto wide = [](const Camera& c) { return c.window.right - c.window.left; };
      const auto high = [](const Camera& c) { return c.window.top - c.window.bottom; };
      EXPECT_GE(wide(camera), margin * wide(frame) * (1 - 1e-9));
      EXPECT_GE(high(camera), margin * high(frame) * (1 - 1e-9));
      EXPECT_NEAR(wide(camera) / camera.width * frame.width / wide(frame),
                  high(camera) / camera.height * frame.height / high(frame), 1e-9);
    }
  }
  Camera frame = stage.frame;
  frame.width = 2200, frame.height = 30;
  const Camera camera = keyframe_camera(frame, 1.2);
  const Result<Keyframe> key = make_keyframe(stage.source, {camera, {}, 4});
  ASSERT_TRUE(key) << key.error().reason;
  EXPECT_TRUE(key->quarters());
  // As in bands of a few columns, but for the rounding of their cameras.
  KeyframeMaker maker;
  maker.begin({camera, {}, 4});
  while (maker.busy()) ASSERT_TRUE(maker.step(stage.source, 160));
  const Keyframe narrow = maker.take();
  ASSERT_EQ(key->color.width(), narrow.color.width());
  std::size_t differ = 0;
  for (std::size_t i = 0; i < key->color.texels().size(); ++i)
    differ += key->color.texels()[i] != narrow.color.texels()[i];
  EXPECT_LT(double(differ), 0.02 * double(key->color.texels().size()));
}

// What was before it is elsewhere in a frame of another eye.
TEST(MakeKeyframe, OfTheSkyAwayFromEdgesNothingElseIsShown) {
  Scene scene;
  test_shapes::add(scene, test_shapes::sphere(1), {0.9f, 0.05f, 0.05f});
  finish(scene);
  const PlacedScene placed(scene);
  RasterSource source(placed);
  const Camera eye = look_at({0, 0, 4}, {0, 0, 0}, {0, 1, 0}, 0.9, 160, 120, 0.1, 50);
  const Result<Keyframe> key = make_keyframe(source, {keyframe_camera(eye, 1.3), {}, 4});
  ASSERT_TRUE(key);
  const WarpedKeyframe one{&*key, 1};
  int looked_at = 0;
  for (const double aside : {0.15, 0.5, 1.1}) {
    Camera frame = eye;
    frame.world_from_eye[3].x += aside;
    WarpedFrame out;
    warp_keyframes({&one, 1}, frame, out);
    for (int y = 2; y < frame.height - 2; ++y)
      for (int x = 2; x < frame.width - 2; ++x) {
        bool sky = true;
        for (int i = 0; i < 25; ++i) sky = sky && out.inverse_z(x + i % 5 - 2, y + i / 5 - 2) == 0;
        if (!sky || out.hole(x, y)) continue;
        ++looked_at;
        const std::uint32_t color = out.color(x, y);
        ASSERT_LT(int(color & 255) - int(color >> 16 & 255), 40) << x << " " << y;
      }
  }
  EXPECT_GT(looked_at, 30000);
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
  int in_part = 0;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      float inverse[4];
      for (int i = 0; i < 4; ++i) {
        const float depth = captured->picture.depth(2 * x + i % 2, 2 * y + i / 2);
        inverse[i] = depth == kNoDepth ? 0.0f : 1 / depth;
      }
      std::sort(inverse, inverse + 4);
      EXPECT_LE(std::abs(key->inverse_z(x, y) - inverse[2]), 0.03f * inverse[2]);
      for (int i = 0; i < 4; ++i) {
        const int from_x = 2 * x + i % 2, from_y = 2 * y + i / 2;
        const float depth = captured->picture.depth(from_x, from_y);
        const float one = depth == kNoDepth ? 0.0f : 1 / depth;
        const bool same = std::abs(one - inverse[2]) <= 0.03f * inverse[2];
        const Quarter shows = same               ? Quarter::own
                              : one > inverse[2] ? Quarter::nearer
                                                 : Quarter::farther;
        std::uint32_t same_beside = 0, nearer_beside = 0;
        for (int side = 0; side < 4; ++side) {
          const int at_x = from_x + (side < 2 ? 2 * side - 1 : 0),
                    at_y = from_y + (side < 2 ? 0 : 2 * side - 5);
          const bool within =
              at_x >= 0 && at_y >= 0 && at_x < 2 * camera.width && at_y < 2 * camera.height;
          const float there = within ? captured->picture.depth(at_x, at_y) : depth;
          const float beside = there == kNoDepth ? 0.0f : 1 / there;
          const bool alike = std::abs(beside - one) <= 0.03f * one;
          same_beside += alike, nearer_beside += !alike && beside > one;
        }
        EXPECT_EQ(key->color(from_x, from_y) & 0xff000000u,
                  quarter_code(shows, same_beside, nearer_beside));
        EXPECT_LE(most_apart(key->color(from_x, from_y) & 0xffffffu,
                             bytes_of_color(captured->picture.color(from_x, from_y)) & 0xffffffu),
                  1);
        in_part += !same;
      }
    }
  EXPECT_GT(in_part, 100);
}

double mean_difference(const WarpedFrame& frame, const Rgba8Image& truth) {
  double sum = 0;
  for (int y = 0; y < truth.height(); ++y)
    for (int x = 0; x < truth.width(); ++x)
      for (int c = 0; c < 3; ++c) {
        const double d = double(frame.color(x, y) >> (8 * c) & 255) - double(truth(x, y)[c]);
        sum += d * d;
      }
  return sum / double(truth.texels().size());
}

TEST(MakeKeyframe, QuartersLoseLessInAWarpThanWholeTexelsDo) {
  const BuiltinScene made = *make_builtin("builtin:teapots?triangles=20000");
  PlacedScene placed(made.scene);
  RasterSource source(placed);
  const Camera frame = camera_at(made.path, 0.5, 480, 300);
  // The truth: 36 samples a pixel, averaged as frames average theirs.
  TestSource direct = software_direct(made.scene, 4);
  Camera finer = frame;
  finer.width *= 3, finer.height *= 3;
  ASSERT_TRUE(direct.draw(finer, 0));
  const Rgba8Image& all = direct.software_target()->color();
  Rgba8Image truth(frame.width, frame.height);
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x) {
      glm::ivec4 sum(4);
      for (int i = 0; i < 9; ++i) sum += glm::ivec4(all(3 * x + i % 3, 3 * y + i / 3));
      truth(x, y) = glm::u8vec4(sum / 9);
    }
  // Turned by some texels and a part of one, different everywhere.
  Camera turned = keyframe_camera(frame, 1.3);
  const glm::dmat4 turn = glm::rotate(glm::dmat4(1), 0.023, glm::dvec3(0.3, 1, 0.6));
  for (int c = 0; c < 3; ++c) turned.world_from_eye[c] = turn * frame.world_from_eye[c];
  const auto loss = [&](int samples, bool whole_texels) {
    const auto key = make_keyframe(source, {turned, {}, samples, whole_texels});
    EXPECT_TRUE(key);
    EXPECT_EQ(key->quarters(), samples == 16 || !whole_texels);
    WarpedFrame out;
    const WarpedKeyframe one{&*key, 1};
    warp_keyframes({&one, 1}, frame, out);
    return mean_difference(out, truth);
  };
  const double of_texels = loss(4, true), of_quarters = loss(4, false), of_more = loss(16, false);
  EXPECT_LT(of_quarters, 0.8 * of_texels) << of_texels << " " << of_quarters << " " << of_more;
  EXPECT_LT(of_more, 0.8 * of_texels);
}

TEST(MakeKeyframe, AnEyeThatStandsSeesTheMeanOfTheSamplesOfAPixel) {
  const BuiltinScene made = *make_builtin("builtin:teapots?triangles=20000");
  PlacedScene placed(made.scene);
  RasterSource source(placed);
  const Camera frame = camera_at(made.path, 0.5, 480, 300);
  CaptureRequest finer;
  finer.camera = frame, finer.camera.width *= 2, finer.camera.height *= 2;
  finer.samples = 1, finer.staggered = true, finer.with_sky = true;
  const DepthImage picture = source.capture(finer)->picture;
  Rgba8Image truth(frame.width, frame.height);
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x) {
      glm::ivec4 sum(2);
      for (int i = 0; i < 4; ++i) {
        const std::uint32_t bytes = bytes_of_color(picture.color(2 * x + i % 2, 2 * y + i / 2));
        sum += glm::ivec4(bytes & 255, bytes >> 8 & 255, bytes >> 16 & 255, 255);
      }
      truth(x, y) = glm::u8vec4(sum / 4);
    }
  const auto loss = [&](bool sharp) {
    KeyframeRequest request{keyframe_camera(frame, 1.2), {}, 4};
    request.sharp = sharp;
    const auto key = make_keyframe(source, request);
    EXPECT_TRUE(key);
    WarpedFrame out;
    const WarpedKeyframe one{&*key, 1};
    warp_keyframes({&one, 1}, frame, out);
    return mean_difference(out, truth);
  };
  const double sharp = loss(true), smooth = loss(false);
  EXPECT_LT(sharp, 0.2 * smooth) << sharp << " " << smooth;
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
