#include "rilievo/nailboard/gap_table.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>
#include <vector>

#include "rilievo/core/depth.h"
#include "rilievo/nailboard/gap_passes.h"

namespace rilievo {
namespace {

struct Planes {
  Image<float> nearest, farthest;
};

// Rectangles at random depths, some with something behind them.
Planes random_planes(int width, int height, std::mt19937& rng) {
  Planes planes{Image<float>(width, height, kNoDepth), Image<float>(width, height, kNoDepth)};
  std::uniform_real_distribution<float> depth(4, 20);
  for (int i = 0; i < 6; ++i) {
    const int x0 = int(rng() % unsigned(width)), y0 = int(rng() % unsigned(height));
    const int w = 1 + int(rng() % 9u), h = 1 + int(rng() % 9u);
    const float z = depth(rng), slope = 0.1f * depth(rng);
    for (int y = y0; y < std::min(height, y0 + h); ++y)
      for (int x = x0; x < std::min(width, x0 + w); ++x) {
        const float d = z + slope * float(x - x0);
        float &near = planes.nearest(x, y), &far = planes.farthest(x, y);
        far = far == kNoDepth ? d : std::max(far, d);
        near = std::min(near, d);
      }
  }
  return planes;
}

// The definition in gap_table.cpp, (4), in doubles and without rounding: each edge cell against
// each cell behind it that steps of (0, 1) and (1, 1) lead to.
double slow_widest(const Planes& planes, int octant, double texels_per_w) {
  const int width = planes.nearest.width(), height = planes.nearest.height();
  const auto mirrored = [&](int x, int y) {
    if (octant & 4) std::swap(x, y);
    return std::pair((octant & 1) ? width - 1 - x : x, (octant & 2) ? height - 1 - y : y);
  };
  const auto read = [&](const Image<float>& plane, int x, int y, double nothing) {
    const auto [u, v] = mirrored(x, y);
    if (u < 0 || v < 0 || u >= width || v >= height || plane(u, v) == kNoDepth) return nothing;
    return 1.0 / double(plane(u, v));
  };
  const int columns = (octant & 4) ? height : width, rows = (octant & 4) ? width : height;
  const double straight = std::cos(std::numbers::pi / 8) / texels_per_w;
  const double diagonal =
      (std::cos(std::numbers::pi / 8) + std::sin(std::numbers::pi / 8)) / texels_per_w;
  const auto far = [&](int x, int y) {
    double least = 1e9;
    for (int j = -1; j <= 1; ++j)
      for (int i = -1; i <= 1; ++i)
        least = std::min(least, read(planes.farthest, x + i, y + j, 1e9));
    return least;
  };
  double widest = 0;
  for (int y = -1; y < rows; ++y)
    for (int x = -1; x < columns; ++x) {
      double front = 0, beyond = 1e9;
      for (int j = 0; j < 2; ++j)
        for (int i = 0; i < 2; ++i) {
          const double w = read(planes.nearest, x + i, y + j, 0);
          front = std::max(front, w), beyond = std::min(beyond, w);
        }
      double hidden = 1e9;
      for (int q = 0; q <= y + 1; ++q)
        for (int p = 0; p <= std::min(q, x + 1); ++p)
          hidden = std::min(hidden, far(x - p, y - q) + p * diagonal + (q - p) * straight);
      const double jump = beyond == 0 ? 1e9 : front - beyond;
      widest = std::max(widest, std::min(jump, front - hidden));
    }
  return widest;
}

TEST(GapTable, is_the_slow_definition_or_a_little_more) {
  std::mt19937 rng(1);
  double looseness = 0;
  int entries = 0;
  for (int i = 0; i < 12; ++i) {
    const Planes planes = random_planes(12 + int(rng() % 12u), 12 + int(rng() % 12u), rng);
    const GapTable table = make_gap_table(planes.nearest, planes.farthest);
    const double range = table.w_front - table.w_back, unit = range / kGapSteps;
    ASSERT_GT(range, 0);
    for (int octant = 0; octant < kGapOctants; ++octant)
      for (int level = 0; level < kGapLevels; ++level) {
        const double texels_per_w = 0.5 * double(1 << level) / range;
        const double slow = slow_widest(planes, octant, texels_per_w);
        const double fast = table.code[std::size_t(octant)][std::size_t(level)] * unit;
        ASSERT_GE(fast, slow - 1e-9 * range) << i << ' ' << octant << ' ' << level;
        // A step up, a step down, one for the jump; and each step taken is up to a code too short.
        const double steps = 24 * unit;
        ASSERT_LE(fast, slow + 3 * unit + (slow > 0 ? steps : 0)) << i << ' ' << octant;
        looseness += (fast - slow) / unit, ++entries;
      }
  }
  EXPECT_LE(looseness / entries, 4);  // codes
}

TEST(GapTable, what_hides_nothing_lacks_nothing) {
  const Image<float> none(16, 16, kNoDepth);
  EXPECT_EQ(make_gap_table(none, none).w_front, 0);
  const Image<float> flat(16, 16, 5.0f);
  const GapTable table = make_gap_table(flat, flat);
  for (const auto& octant : table.code)
    for (const std::uint8_t code : octant) EXPECT_EQ(code, 0);
}

TEST(GapTable, of_a_wide_picture_is_that_of_it_upright_with_the_octants_exchanged) {
  std::mt19937 rng(2);
  const Planes wide = random_planes(150, 40, rng);
  Planes tall{Image<float>(40, 150, kNoDepth), Image<float>(40, 150, kNoDepth)};
  for (int y = 0; y < 40; ++y)
    for (int x = 0; x < 150; ++x)
      tall.nearest(y, x) = wide.nearest(x, y), tall.farthest(y, x) = wide.farthest(x, y);
  const GapTable a = make_gap_table(wide.nearest, wide.farthest);
  const GapTable b = make_gap_table(tall.nearest, tall.farthest);
  for (std::size_t octant = 0; octant < kGapOctants; ++octant) {
    const std::size_t other = ((octant & 1) << 1) | ((octant & 2) >> 1) | (4 - (octant & 4));
    EXPECT_EQ(a.code[octant], b.code[other]) << octant;
  }
}

TEST(GapBound, is_nothing_where_the_eye_has_not_moved_and_infinite_within_the_depths) {
  std::mt19937 rng(3);
  PictureGeometry picture;
  picture.capture.window = {-0.2, 0.2, -0.2, 0.2};
  picture.capture.z_near = 3, picture.capture.z_far = 60;
  picture.capture.width = picture.capture.height = 24;
  picture.slab = {3, 60}, picture.plane_z = 5;
  const Planes planes = random_planes(24, 24, rng);
  const GapTable table = make_gap_table(planes.nearest, planes.farthest);
  Camera frame;
  frame.window = {-0.5, 0.5, -0.5, 0.5};
  frame.width = frame.height = 400;
  EXPECT_EQ(bound_gap_px(picture, table, frame), 0);
  frame.world_from_eye[3] = glm::dvec4(0.05, 0, 0, 1);
  const double little = bound_gap_px(picture, table, frame);
  EXPECT_GT(little, 0);
  frame.world_from_eye[3] = glm::dvec4(0.2, 0, 0, 1);
  EXPECT_GT(bound_gap_px(picture, table, frame), little);
  frame.world_from_eye[3] = glm::dvec4(0, 0, -10, 1);  // among what it shows
  EXPECT_TRUE(std::isinf(bound_gap_px(picture, table, frame)));
  RigidMotion stretched;
  stretched.now_from_then[0] *= 2;
  EXPECT_TRUE(std::isinf(bound_gap_px(picture, table, frame, stretched)));
}

}  // namespace
}  // namespace rilievo
