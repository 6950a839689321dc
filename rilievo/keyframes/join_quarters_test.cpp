#include "rilievo/keyframes/join_quarters.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "rilievo/core/color.h"
#include "rilievo/core/depth.h"
#include "rilievo/core/random.h"
#include "rilievo/keyframes/keyframe.h"
#include "rilievo/render/shading/simd_test_helpers.h"

namespace rilievo {
namespace {

// Four rows of quarters, with one more on either side.
struct RandomRows {
  std::vector<std::uint32_t> colors[4], objects[2];
  std::vector<float> inverse_z[4];
  QuarterRows rows = {};

  // A few surfaces, some of which are sky.
  RandomRows(int texels, std::uint64_t seed) {
    Random random(seed);
    const std::size_t size = std::size_t(2 * texels + 2);
    for (int i = 0; i < 4; ++i) {
      for (std::size_t x = 0; x < size; ++x) {
        colors[i].push_back(std::uint32_t(random.next()) & 0xffffffu);
        const int surface = random.below(4);
        inverse_z[i].push_back(surface == 0 ? 0.0f
                                            : 0.1f * float(surface) * random.between(0.98f, 1.02f));
      }
      rows.colors[i] = colors[i].data() + 1, rows.inverse_z[i] = inverse_z[i].data() + 1;
    }
    for (int i = 0; i < 2; ++i) {
      for (std::size_t x = 0; x < size - 2; ++x)
        objects[i].push_back(std::uint32_t(random.below(100)));
      rows.objects[i] = objects[i].data();
    }
  }
};

struct Joined {
  std::vector<std::uint32_t> colors[2], objects;
  std::vector<float> inverse_z;

  explicit Joined(int texels) : objects(std::size_t(texels), 7u), inverse_z(std::size_t(texels)) {
    for (std::vector<std::uint32_t>& row : colors) row.assign(std::size_t(2 * texels), 0u);
  }
  TexelRow out() {
    return {{colors[0].data(), colors[1].data()}, inverse_z.data(), objects.data()};
  }
  bool operator==(const Joined&) const = default;
};

bool alike(float inverse_z, float as) { return std::abs(inverse_z - as) <= 0.03f * as; }

// One quarter after the other.
Joined joined_slowly(const QuarterRows& rows, int texels, bool smooth) {
  Joined out(texels);
  for (int x = 0; x < texels; ++x) {
    std::vector<float> sorted;
    for (int i = 0; i < 4; ++i) sorted.push_back(rows.inverse_z[1 + i / 2][2 * x + i % 2]);
    const std::vector<float> w = sorted;
    std::sort(sorted.begin(), sorted.end(), std::greater<>());
    float sum = 0;
    int count = 0;
    for (int i = 0; i < 4; ++i) {
      const int row = 1 + i / 2, column = 2 * x + i % 2;
      const float own = w[std::size_t(i)];
      Quarter shows = own > sorted[1] ? Quarter::nearer : Quarter::farther;
      if (alike(own, sorted[1])) shows = Quarter::own, sum += own, ++count;
      if (own == sorted[1]) out.objects[std::size_t(x)] = rows.objects[i / 2][column];
      const std::uint32_t color = rows.colors[row][column];
      std::uint32_t same = 0, nearer = 0, sums[3];
      for (int c = 0; c < 3; ++c) sums[c] = 2 * (color >> (8 * c) & 255);
      const int sides[4][2] = {
          {row, column - 1}, {row, column + 1}, {row - 1, column}, {row + 1, column}};
      for (const auto& [side_row, side_column] : sides) {
        const float beside = rows.inverse_z[side_row][side_column];
        if (!alike(beside, own)) {
          nearer += beside > own;
          continue;
        }
        ++same;
        for (int c = 0; c < 3; ++c) sums[c] += rows.colors[side_row][side_column] >> (8 * c) & 255;
      }
      std::uint32_t bytes = color;
      if (smooth) {
        bytes = 0;
        for (int c = 0; c < 3; ++c)
          bytes |= std::uint32_t(std::lround(double(sums[c]) / (2 + same))) << (8 * c);
      }
      out.colors[i / 2][std::size_t(column)] = bytes | quarter_code(shows, same, nearer);
    }
    out.inverse_z[std::size_t(x)] = sum / float(count);
  }
  return out;
}

TEST(JoinQuarters, AsOneAfterTheOtherOnEveryInstructionSet) {
  for_each_instruction_set([](const char* set) {
    SCOPED_TRACE(set);
    for (const int texels : {1, 2, 15, 16, 17, 33, 100})
      for (const bool smooth : {false, true}) {
        const RandomRows random(texels, std::uint64_t(texels));
        Joined out(texels);
        join_quarters(random.rows, texels, smooth, out.out());
        EXPECT_EQ(out, joined_slowly(random.rows, texels, smooth)) << texels;
      }
  });
}

TEST(JoinQuarters, WithoutObjectsNoneIsShown) {
  RandomRows random(20, 3);
  random.rows.objects[0] = random.rows.objects[1] = nullptr;
  Joined out(20);
  join_quarters(random.rows, 20, true, out.out());
  for (const std::uint32_t object : out.objects) EXPECT_EQ(object, kNoObject);
}

TEST(SrgbBytes, AsTheCurveToAQuarterOfAByteOnEveryInstructionSet) {
  constexpr int kCount = 5001;
  std::vector<glm::vec4> linear;
  Random random(1);
  for (int i = 0; i < kCount; ++i) {
    const float dark = random.unit() * random.unit() * random.unit();
    linear.emplace_back(random.between(-0.2f, 1.2f), dark, random.unit(), random.unit());
  }
  linear[5].r = std::numeric_limits<float>::quiet_NaN();
  for_each_instruction_set([&](const char* set) {
    SCOPED_TRACE(set);
    std::vector<std::uint32_t> bytes(kCount, ~0u);
    srgb_bytes_of(linear.data(), kCount, bytes.data());
    EXPECT_EQ(bytes[5] & 255, 0u);
    for (int i = 6; i < kCount; ++i) {
      EXPECT_EQ(bytes[std::size_t(i)] >> 24, 0u);
      for (int c = 0; c < 3; ++c) {
        const float exact =
            srgb_from_linear(std::clamp(linear[std::size_t(i)][c], 0.0f, 1.0f)) * 255;
        EXPECT_NEAR(float(bytes[std::size_t(i)] >> (8 * c) & 255), exact, 0.75f);
      }
    }
  });
}

TEST(InversesOf, NothingIsInfinitelyFar) {
  const float eye_z[] = {kNoDepth, 2, 0.5f, 0};
  float inverse_z[4];
  inverses_of(eye_z, 4, inverse_z);
  EXPECT_EQ(inverse_z[0], 0);
  EXPECT_EQ(inverse_z[1], 0.5f);
  EXPECT_EQ(inverse_z[2], 2);
  EXPECT_EQ(inverse_z[3], 0);
}

}  // namespace
}  // namespace rilievo
