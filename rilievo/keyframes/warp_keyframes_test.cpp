#include "rilievo/keyframes/warp_keyframes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

#include "rilievo/core/random.h"
#include "rilievo/keyframes/random_keyframes_test_helpers.h"
#include "rilievo/keyframes/slow_warp_test_helpers.h"

namespace rilievo {
namespace {

TEST(WarpKeyframes, AreTheSameBytesAsByTheSlowDefinition) {
  Random random(41);
  std::size_t closed = 0;
  for (int i = 0; i < 48; ++i) {
    // Of these the texels of neighbouring pixels lie beside each other; of the last ones slanted
    // surfaces have cracks.
    const bool steep = i >= 36;
    const double apart = steep ? 5 : i < 24 ? 1 : 0.03;
    const Camera frame = random_eye(random, (steep ? 170 : 70) + 7 * (i % 5),
                                    (steep ? 125 : 45) + 11 * (i % 4), apart);
    std::vector<Keyframe> keys;
    for (int k = 0; k < 1 + i % 7; ++k)
      keys.push_back(
          random_keyframe(random,
                          keyframe_camera(random_eye(random, frame.width, frame.height, apart), 1.2,
                                          k == 2 ? 0.5 : 1),
                          (i + k) % 3 > 0, steep));
    std::vector<WarpedKeyframe> warped;
    for (const Keyframe& key : keys)
      warped.push_back({&key, float(random.between(0.1, 2)), warped.size() % 2 == 1 && i % 2 == 1});
    if (i % 3 == 2)
      for (Keyframe& key : keys) hide_objects(key, std::vector<std::uint32_t>{3, 17, 30, 38});
    // Some of it before, some of it behind what is warped; in whole vectors, and in parts of one.
    Image<float> cover(frame.width, frame.height);
    for (int y = 10; y < 30; ++y)
      for (int x = 5; x < 60; ++x)
        if (random.between(0, 1) < 0.05 * x) cover(x, y) = float(1 / random.between(1, 60));
    const WarpCover some{&cover, i % 8 == 3 ? 0.2f : 2.0f};
    const WarpCover* covers = i % 4 == 3 ? &some : nullptr;
    WarpedFrame out;
    warp_keyframes(warped, frame, out, covers);
    SlowWarp slow{warped, frame, covers, true, {}};
    Image<std::uint32_t> color;
    Image<float> inverse_z;
    slow.draw(color, inverse_z);
    EXPECT_EQ(out.inverse_z, inverse_z) << i;
    EXPECT_EQ(out.color, color) << i;
    std::size_t holes = 0;
    for (const std::uint32_t one : color.texels()) holes += one == 0;
    EXPECT_EQ(out.holes(), holes);
    if (steep) {
      SlowWarp open{warped, frame, covers, false, {}};
      open.draw(color, inverse_z);
      for (std::size_t pixel = 0; pixel < color.texels().size(); ++pixel)
        closed += color.texels()[pixel] != out.color.texels()[pixel];
      continue;
    }
    // Many may show all, and so may near ones.
    if (keys.size() <= 3 && apart == 1) {
      EXPECT_GT(holes, 0u);
    }
    EXPECT_LT(holes, color.texels().size() / 2);
  }
  EXPECT_GT(closed, 1000u);
}

TEST(WarpKeyframes, PlainSkyIsLeftToWhoeverDrawsItAndAllElseIsTheSame) {
  Random random(43);
  std::size_t plain = 0, sky = 0;
  for (int i = 0; i < 24; ++i) {
    const Camera frame = random_eye(random, 230 + 9 * (i % 3), 130, 0.2);
    std::vector<Keyframe> keys;
    for (int k = 0; k < 1 + i % 2; ++k) {
      Keyframe& key = keys.emplace_back(random_keyframe(
          random, keyframe_camera(random_eye(random, frame.width, frame.height, 0.2), 1.3),
          i % 3 > 0));
      // Things in the lower left, and one alone in the sky.
      for (int y = 0; y < key.camera.height; ++y)
        for (int x = 0; x < key.camera.width; ++x)
          if ((y < key.camera.height / 2 || x > key.camera.width / 2) &&
              !(k == 0 && std::abs(x - 200) < 3 && std::abs(y - 40) < 3))
            key.inverse_z(x, y) = 0, key.object(x, y) = kNoObject;
      // Of the sky there is nothing in front, nor behind.
      const int finer = key.quarters() ? 2 : 1;
      for (int y = 0; y < key.color.height(); ++y)
        for (int x = 0; x < key.color.width(); ++x)
          if (key.inverse_z(x / finer, y / finer) == 0)
            key.color(x, y) = (key.color(x, y) & 0xffffffu) | kWholeTexel;
      find_ranges(key, 0, key.camera.width);
    }
    const bool hides = i % 8 == 7;
    if (hides)
      for (Keyframe& key : keys) hide_objects(key, std::vector<std::uint32_t>{3, 17, 30, 38});
    std::vector<WarpedKeyframe> warped;
    for (const Keyframe& key : keys) warped.push_back({&key, 1.0f});
    Image<float> cover(frame.width, frame.height);
    for (int y = 20; y < 50; ++y)
      for (int x = 33; x < 140; ++x) cover(x, y) = random.between(0, 1) < 0.5 ? 0.1f : 0.0f;
    const WarpCover some{&cover, 2.0f};
    WarpedFrame whole, left;
    warp_keyframes(warped, frame, whole, i % 4 == 2 ? &some : nullptr);
    warp_keyframes(warped, frame, left, i % 4 == 2 ? &some : nullptr, true);
    EXPECT_EQ(left.inverse_z, whole.inverse_z);
    EXPECT_EQ(left.holes(), whole.holes());
    for (int y = 0; y < frame.height; ++y)
      for (int x = 0; x < frame.width; ++x) {
        if (left.color(x, y) != kPlainSky) {
          EXPECT_EQ(left.color(x, y), whole.color(x, y)) << i << " " << x << " " << y;
          sky += whole.inverse_z(x, y) == 0 && whole.color(x, y) > kPlainSky;
          continue;
        }
        ++plain, ++sky;
        EXPECT_FALSE(hides);
        EXPECT_EQ(whole.inverse_z(x, y), 0);
        // Neither a hole nor covered.
        EXPECT_GT(whole.color(x, y), kPlainSky);
        // And no texel shows something there, by the definition.
        const bool seen = std::ranges::any_of(keys, [&](const Keyframe& key) {
          const RasterMap map = raster_map(key.camera, frame);
          const float px = float(x) + 0.5f, py = float(y) + 0.5f, z = apply(map.z, px, py, 0);
          const int ix = int(apply(map.x, px, py, 0) / z - 0.5f),
                    iy = int(apply(map.y, px, py, 0) / z - 0.5f);
          for (int k = 0; k < 4; ++k)
            if (key.inverse_z(ix + k % 2, iy + k / 2) != 0) return false;
          return true;
        });
        EXPECT_TRUE(seen);
      }
  }
  // Strips and segments are coarse, and the frames small: of 1280 x 720 most is.
  EXPECT_GT(plain, sky / 4);
}

TEST(WarpKeyframes, HiddenObjectsAreShownAgain) {
  Random random(12);
  const Camera frame = random_eye(random, 120, 80);
  Keyframe key = random_keyframe(random, frame, true);
  const Keyframe whole = key;
  hide_objects(key, std::vector<std::uint32_t>{4, 20});
  int hidden = 0;
  for (int y = 0; y < 80; ++y)
    for (int x = 0; x < 120; ++x) {
      const bool hides = whole.object(x, y) == 5 || whole.object(x, y) == 21;
      EXPECT_EQ(key.inverse_z(x, y), hides ? -whole.inverse_z(x, y) : whole.inverse_z(x, y));
      hidden += hides;
    }
  EXPECT_GT(hidden, 0);
  for (int y = 0; y < 80; ++y)
    for (int column = 0; column < key.segments.width(); ++column) {
      InverseRange expected;
      constexpr int kColumns = Keyframe::kColumns;
      for (int x = kColumns * column; x < std::min(kColumns * (column + 1), 120); ++x)
        expected.add(key.inverse_z(x, y));
      EXPECT_EQ(key.segments(column, y).nearest, expected.nearest);
      EXPECT_EQ(key.segments(column, y).farthest, expected.farthest);
    }
  WarpedFrame out;
  const WarpedKeyframe one{&key, 1};
  warp_keyframes({&one, 1}, frame, out);
  Image<std::uint32_t> objects;
  warp_objects({&one, 1}, frame, out, objects);
  for (const std::uint32_t object : objects.texels()) EXPECT_TRUE(object != 5 && object != 21);
  hide_objects(key, {});
  EXPECT_EQ(key.inverse_z, whole.inverse_z);
  EXPECT_TRUE(std::ranges::equal(key.blocks.texels(), whole.blocks.texels(),
                                 [](const InverseRange& a, const InverseRange& b) {
                                   return a.nearest == b.nearest && a.farthest == b.farthest;
                                 }));
}

TEST(WarpKeyframes, AnEyeThatCameTooNearSeesHolesAndNotWhatIsBehind) {
  const Camera at = look_at(glm::dvec3(0), {0, 0, -1}, {0, 1, 0}, 1, 100, 80, 0.01, 100);
  Keyframe key;
  resize(key, at, false);
  // A wall 40 m away, and before it a board, 2 m away and 10 texels wide and high, which is
  // slanted, so that its texels' depths differ.
  std::ranges::fill(key.inverse_z.texels(), 1 / 40.0f);
  std::ranges::fill(key.color.texels(), kWholeTexel | 0x0000ffu);
  for (int y = 35; y < 45; ++y)
    for (int x = 45; x < 55; ++x)
      key.inverse_z(x, y) = 0.5f - 0.004f * float(x - 45), key.color(x, y) = kWholeTexel;
  find_ranges(key, 0, at.width);
  for (const double times : {2.0, 3.9, 4.1, 6.0, 20.0}) {
    Camera frame = at;
    frame.world_from_eye[3].z = -2 + 2 / times;
    WarpedFrame out;
    const WarpedKeyframe one{&key, 1};
    warp_keyframes({&one, 1}, frame, out);
    // Well within the board, of which the right end is farthest away and grows least.
    const double least = 2.15 / (2 / times + 0.15);
    const int half = std::max(1, int(std::min(5 * least, 40.0)) - 2);
    for (int y = 40 - half; y < 40 + half; ++y)
      for (int x = 50 - half; x < 50 + half; ++x) {
        const std::uint32_t color = out.color(x, y);
        if (times < kMostMagnified)
          ASSERT_EQ(color, kOpaque) << times << " " << x;
        else if (least > kMostMagnified)
          ASSERT_EQ(color, 0) << times << " " << x;
        else
          ASSERT_TRUE(color == 0 || color == kOpaque) << times << " " << x;
      }
  }
}

// The side of a block, seen along it by the keyframe, and from the front by the frame, where its
// texels are several pixels apart: nothing of the ground behind it, which another keyframe shows.
TEST(WarpKeyframes, AnEyeAsideOfASlantedSurfaceSeesNothingBetweenItsTexels) {
  const Camera at = look_at(glm::dvec3(0), {0, 0, -1}, {0, 1, 0}, 1, 320, 240, 0.01, 100);
  Keyframe key, behind;
  resize(key, at, false);
  std::ranges::fill(key.inverse_z.texels(), 1 / 40.0f);
  std::ranges::fill(key.color.texels(), kWholeTexel | 0x0000ffu);
  find_ranges(key, 0, at.width);
  behind = key;
  // Depths from 2 m on, by 2.5 % a texel.
  for (int y = 80; y < 160; ++y)
    for (int x = 150; x < 190; ++x) {
      key.inverse_z(x, y) = 0.5f * std::pow(0.975f, float(x - 150));
      key.color(x, y) = kWholeTexel | 0x00ff00u;
    }
  find_ranges(key, 0, at.width);
  // Away from its ends, where pixels are holes.
  const auto on_side = [&](int x) {
    return world_from_raster(at, {x + 0.5, 120.5}, 2 / std::pow(0.975, x - 150.0));
  };
  const glm::dvec3 near_end = on_side(152), far_end = on_side(186);
  const glm::dvec3 middle = 0.5 * (near_end + far_end);
  int seen = 0;
  for (const double angle : {0.3, 0.5, 0.7, 0.9}) {
    // Around the middle, to where it is seen from the front.
    const glm::dvec3 eye = middle + 4.0 * glm::dvec3(-std::sin(angle), 0, std::cos(angle));
    const Camera frame = look_at(eye, middle, {0, 1, 0}, 1, 320, 240, 0.01, 100);
    const double left = raster_from_world(frame, near_end).x,
                 right = raster_from_world(frame, far_end).x;
    const WarpedKeyframe both[] = {{&key, 1}, {&behind, 1}};
    WarpedFrame out;
    warp_keyframes(both, frame, out);
    for (int y = 110; y < 130; ++y)
      for (int x = int(std::min(left, right)) + 1; x < int(std::max(left, right)); ++x) {
        ASSERT_EQ(out.color(x, y), kOpaque | 0x00ff00u) << angle << " " << x << " " << y;
        ++seen;
      }
  }
  EXPECT_GT(seen, 4000);
}

TEST(WarpKeyframes, AtItsOwnEyeAKeyframeIsItself) {
  Random random(2);
  const Camera frame = random_eye(random, 120, 80);
  const Keyframe key = random_keyframe(random, keyframe_camera(frame, 1.1), false);
  const int x0 = (key.camera.width - frame.width) / 2, y0 = (key.camera.height - frame.height) / 2;
  WarpedFrame out;
  const WarpedKeyframe one{&key, 1};
  warp_keyframes({&one, 1}, frame, out);
  EXPECT_EQ(out.holes(), 0u);
  Image<std::uint32_t> objects;
  warp_objects({&one, 1}, frame, out, objects);
  int others = 0;
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x) {
      const bool same = out.color(x, y) == (key.color(x + x0, y + y0) | kOpaque);
      others += !same;
      if (same && out.inverse_z(x, y) > 0) {
        EXPECT_EQ(objects(x, y), key.object(x + x0, y + y0));
      }
    }
  EXPECT_EQ(others, 0);
}

TEST(WarpKeyframes, AnEyeThatStandsSeesTheMeanOfAllQuarters) {
  Random random(4);
  const Camera frame = random_eye(random, 120, 80);
  const Keyframe key = random_keyframe(random, keyframe_camera(frame, 1.1), true);
  Camera aside = key.camera;
  aside.world_from_eye[3].x += 0.1;
  const Keyframe other = random_keyframe(random, aside, true);
  const int x0 = (key.camera.width - frame.width) / 2, y0 = (key.camera.height - frame.height) / 2;
  WarpedFrame out;
  const WarpedKeyframe both[] = {{&other, 1}, {&key, 1}};
  warp_keyframes(both, frame, out);
  EXPECT_EQ(out.holes(), 0u);
  for (int y = 0; y < frame.height; ++y)
    for (int x = 0; x < frame.width; ++x) {
      std::uint32_t mean = kOpaque;
      for (int c = 0; c < 24; c += 8) {
        std::uint32_t sum = 2;
        for (int i = 0; i < 4; ++i)
          sum += key.color(2 * (x + x0) + i % 2, 2 * (y + y0) + i / 2) >> c & 255;
        mean |= sum / 4 << c;
      }
      ASSERT_EQ(out.color(x, y), mean);
      ASSERT_EQ(out.inverse_z(x, y), key.inverse_z(x + x0, y + y0));
    }
  // Not of a spare one, and not half a pixel aside.
  const WarpedKeyframe spare[] = {{&other, 1}, {&key, 1, true}};
  WarpedFrame mixed;
  warp_keyframes(spare, frame, mixed);
  EXPECT_NE(mixed.color, out.color);
  Camera turned = frame;
  turned.window.left += 0.5 / frame.width, turned.window.right += 0.5 / frame.width;
  warp_keyframes(both, turned, mixed);
  EXPECT_NE(mixed.color, out.color);
}

TEST(WarpKeyframes, MapsAreThoseOfCameras) {
  Random random(3);
  for (int i = 0; i < 100; ++i) {
    const Camera from = random_eye(random, 640, 480), to = random_eye(random, 320, 200);
    const RasterMap map = raster_map(to, from);
    const glm::dvec2 at(random.between(0, 640), random.between(0, 480));
    const double eye_z = random.between(3, 50);
    const glm::dvec3 expected = raster_from_world(to, world_from_raster(from, at, eye_z));
    const float w = float(1 / eye_z), x = float(at.x), y = float(at.y);
    const float z = apply(map.z, x, y, w);
    // Single precision of coordinates of hundreds.
    EXPECT_NEAR(apply(map.x, x, y, w) / z, expected.x, 2e-3);
    EXPECT_NEAR(apply(map.y, x, y, w) / z, expected.y, 2e-3);
    EXPECT_NEAR(z / w / expected.z, 1, 1e-5);
  }
}

}  // namespace
}  // namespace rilievo
