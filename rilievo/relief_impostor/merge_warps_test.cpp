#include "rilievo/relief_impostor/merge_warps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rilievo {
namespace {

// A ball before a wall: the depth along a ray, and what is hit.
struct BallHit {
  double distance = 0;  // multiples of `way`
  bool ball = false;
};
BallHit hit_ball(const glm::dvec3& eye, const glm::dvec3& way) {
  const double a = glm::dot(way, way), b = glm::dot(way, eye), c = glm::dot(eye, eye) - 0.25;
  const double inside = b * b - a * c;
  if (inside > 0) return {(-b - std::sqrt(inside)) / a, true};
  return {(-1.5 - eye.z) / way.z, false};
}

// As a capture from an eye that looks a little past the ball; `tint` is its red.
DepthImage picture_of_ball(const glm::dvec3& eye, float tint, bool wall = true) {
  DepthImage picture;
  picture.camera = look_at(eye, {0.1, 0, 0}, {0, 1, 0}, 0.6, 180, 150, 1.0, 9.0);
  picture.depth_kind = DepthKind::eye_z;
  picture.color = ColorImage(180, 150);
  picture.depth = Image<float>(180, 150, kNoDepth);
  for (int y = 0; y < 150; ++y)
    for (int x = 0; x < 180; ++x) {
      const glm::dvec3 way = world_from_raster(picture.camera, {x + 0.5, y + 0.5}, 1) - eye;
      const BallHit hit = hit_ball(eye, way);
      if (!hit.ball && !wall) continue;
      picture.depth(x, y) = float(hit.distance);
      picture.color(x, y) = {tint, hit.ball ? 1 : 0, 0, 1};
    }
  return picture;
}

// Where a result shows something that is not there.
struct Judged {
  int wrong = 0, shown = 0;
};
Judged judge(const Prewarped& result) {
  Judged judged;
  const Camera& camera = result.geometry.capture;
  for (int y = 2; y + 2 < result.height(); ++y)
    for (int x = 2; x + 2 < result.width(); ++x) {
      const std::uint16_t code = result.delta[std::size_t(y * result.width() + x)];
      if (code == kEmptyWarped) continue;
      const glm::dvec2 raster(x + 0.5, y + 0.5);
      const glm::dvec3 way = world_from_raster(camera, raster, 1) - camera.position();
      const double z =
          eye_z_from(DepthKind::window_z, double(decode_delta(code, 16)), camera, raster);
      ++judged.shown;
      // Where the ball is seen at a grazing angle, a texel is several of its own widths deep.
      judged.wrong += std::abs(z - hit_ball(camera.position(), way).distance) > 0.12;
    }
  return judged;
}

TEST(MergeWarps, what_one_picture_does_not_know_the_other_shows_where_it_is) {
  const glm::dvec3 left(-0.5, 0.1, 3), right(0.55, -0.1, 3.1);
  const ImpostorPicture one = impostor_picture(picture_of_ball(left, 1)),
                        two = impostor_picture(picture_of_ball(right, 1));
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> any(0.2, 0.8);
  for (int round = 0; round < 10; ++round) {
    const glm::dvec3 eye = glm::mix(left, right, any(rng));
    WarpPairScratch scratch;
    Prewarped single, both;
    ASSERT_TRUE(warp_impostor(one, eye, {}, scratch.main, single));
    const Judged alone = judge(single);
    ASSERT_TRUE(warp_pair(one, two, eye, {}, scratch, both));
    const Judged merged = judge(both);
    Prewarped by_one_thread;
    ASSERT_TRUE(warp_pair(one, two, eye, {.parallel = false}, scratch, by_one_thread));
    EXPECT_TRUE(both.color == by_one_thread.color && both.delta == by_one_thread.delta);
    // A gap beside the ball, over which the wall's and the ball's texels are interpolated.
    EXPECT_GT(alone.wrong, 100) << round;
    EXPECT_LT(merged.wrong, alone.wrong / 3) << round;
    EXPECT_GT(merged.shown, alone.shown) << round;
  }
}

TEST(MergeWarps, colours_change_from_picture_to_picture_with_the_eye) {
  const glm::dvec3 left(-0.2, 0, 3), right(0.2, 0, 3);
  const ImpostorPicture red = impostor_picture(picture_of_ball(left, 1)),
                        black = impostor_picture(picture_of_ball(right, 0));
  for (const double part : {0.25, 0.5, 0.75}) {
    WarpPairScratch scratch;
    Prewarped result;
    const glm::dvec3 eye = glm::mix(left, right, part);
    ASSERT_TRUE(warp_pair(red, black, eye, {}, scratch, result));
    // In the middle of the ball.
    const glm::dvec3 at = raster_from_world(result.geometry.capture, {0, 0, 0.5});
    const glm::u8vec4 color = result.color[std::size_t(int(at.y) * result.width() + int(at.x))];
    EXPECT_NEAR(int(color.r), 255 * (1 - part), 2) << part;
    EXPECT_EQ(color.g, 255);
    EXPECT_EQ(color.a, 255);
  }
}

TEST(MergeWarps, a_picture_is_shown_as_it_is_from_its_own_eye_and_beyond_it_keeps_its_colours) {
  const glm::dvec3 left(-0.2, 0, 3), right(0.2, 0, 3);
  const ImpostorPicture red = impostor_picture(picture_of_ball(left, 1, false)),
                        black = impostor_picture(picture_of_ball(right, 0, false));
  WarpPairScratch scratch;
  Prewarped pair, single;
  const glm::dvec3 own = red.geometry.capture.position();
  ASSERT_TRUE(warp_pair(red, black, own, {}, scratch, pair));
  ASSERT_TRUE(warp_impostor(red, own, {}, scratch.other, single));
  EXPECT_TRUE(pair.color == single.color && pair.delta == single.delta);
  ASSERT_TRUE(warp_pair(red, black, {-0.3, 0, 3}, {}, scratch, pair));
  const glm::dvec3 at = raster_from_world(pair.geometry.capture, {0, 0, 0.5});
  EXPECT_EQ(pair.color[std::size_t(int(at.y) * pair.width() + int(at.x))].r, 255);
}

}  // namespace
}  // namespace rilievo
