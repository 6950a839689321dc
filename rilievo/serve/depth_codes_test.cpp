#include "rilievo/serve/depth_codes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rilievo {
namespace {

double uniform(std::mt19937& random, double from, double to) {
  return from + (to - from) * (double(random()) / 4294967295.0);
}

glm::dvec3 direction(std::mt19937& random) {
  for (;;) {
    const double x = uniform(random, -1, 1);
    const double y = uniform(random, -1, 1);
    const double z = uniform(random, -1, 1);
    const double length = std::sqrt(x * x + y * y + z * z);
    if (length > 0.1 && length <= 1) return glm::dvec3(x, y, z) / length;
  }
}

// The definition: texels of random planes, seen by random eyes of the cell, which look anywhere.
TEST(DepthCodes, NothingMovesFartherThanTheBoundWithinTheCell) {
  std::mt19937 random(7);
  double largest_share = 0;
  int seen = 0;
  for (int trial = 0; trial < 4000; ++trial) {
    const Camera picture =
        look_at({0, 0, 0}, direction(random), {0.3, 1, 0.2}, 0.9, 48, 32, 0.01, 1e4);
    // A plane, and things at random depths in front of it.
    const double base = std::exp(uniform(random, -5, 1));
    const double slope_x = uniform(random, -0.01, 0.01) * base;
    const double slope_y = uniform(random, -0.01, 0.01) * base;
    Image<float> inverse_z(48, 32);
    for (int y = 0; y < 32; ++y)
      for (int x = 0; x < 48; ++x) {
        const double w = base + slope_x * x + slope_y * y;
        const bool other = random() % 16 == 0;
        inverse_z(x, y) = float(std::max(other ? w * uniform(random, 0, 3) : w, 0.0));
      }
    Camera frame = look_at({0, 0, 0}, direction(random), {0.2, 1, 0.1}, uniform(random, 0.3, 1.5),
                           1280, 720, 0.01, 1e4);
    const double cell = std::exp(uniform(random, -3, 2));
    const double error_px = 0.25;
    const float nearest = nearest_of(inverse_z);
    const DepthStep step = choose_depth_step(nearest, cell, error_px, frame_scale(frame));
    EXPECT_LE(step.cell, cell);
    EXPECT_LE(step.cell * nearest, kMostOfTheWay * (1 + 1e-9));
    EXPECT_EQ(step.error_px, error_px);
    const Image<std::uint16_t> codes = depth_codes(inverse_z, step.step);
    for (int sample = 0; sample < 64; ++sample) {
      const int x = int(random() % 48), y = int(random() % 32);
      const double w = inverse_z(x, y);
      const double coded = inverse_z_of(codes(x, y), step.step, kDepthOffset);
      if (w == 0) {
        EXPECT_EQ(coded, 0);
        continue;
      }
      // At the cell's border, where the error is largest, half of the time.
      const double reach = step.cell * (sample % 2 ? 1.0 : uniform(random, 0, 1));
      const glm::dvec3 eye = reach * direction(random);
      frame.world_from_eye[3] = glm::dvec4(eye, 1);
      const glm::dvec2 at(x + 0.5, y + 0.5);
      const glm::dvec3 truth = raster_from_world(frame, world_from_raster(picture, at, 1 / w));
      const glm::dvec3 shown = raster_from_world(frame, world_from_raster(picture, at, 1 / coded));
      const bool inside = truth.z > 0 && shown.z > 0 && truth.x >= 0 && truth.x <= frame.width &&
                          truth.y >= 0 && truth.y <= frame.height;
      if (!inside) continue;
      ++seen;
      const double moved = std::hypot(truth.x - shown.x, truth.y - shown.y);
      // The derivative is bounded where the pixel is; over half a step it grows by some percent at
      // most, since a half step is a small share of what the eye sees. Nothing is allowed for it.
      EXPECT_LE(moved, step.error_px);
      largest_share = std::max(largest_share, moved / step.error_px);
    }
  }
  EXPECT_GT(seen, 10000);
  // And the bound is of use: something comes near it.
  EXPECT_GT(largest_share, 0.3);
}

TEST(DepthCodes, TheSkyIsZeroAndWhatIsFarIsNot) {
  Image<float> inverse_z(3, 1);
  inverse_z(1, 0) = 1e-12f, inverse_z(2, 0) = 0.5f;
  const Image<std::uint16_t> codes = depth_codes(inverse_z, 0.001f);
  EXPECT_EQ(codes(0, 0), 0);
  EXPECT_EQ(codes(1, 0), 1);
  // Half a step, and what single precision adds.
  EXPECT_NEAR(inverse_z_of(codes(2, 0), 0.001f, kDepthOffset), 0.5, 0.00051);
}

TEST(DepthCodes, WhereSixteenBitsDoNotSufficeTheErrorIsLarger) {
  // So fine that the nearest thing has a code of 10^6.
  const FrameScale frame{1e9, 0};
  const DepthStep step = choose_depth_step(1, 0.1, 0.25, frame);
  EXPECT_GT(step.error_px, 0.25);
  Image<float> inverse_z(1, 1, 1.0f);
  EXPECT_LE(depth_codes(inverse_z, step.step)(0, 0), kMostDepthCode);
  EXPECT_NEAR(inverse_z_of(depth_codes(inverse_z, step.step)(0, 0), step.step, kDepthOffset), 1,
              0.51 * step.step);
}

}  // namespace
}  // namespace rilievo
