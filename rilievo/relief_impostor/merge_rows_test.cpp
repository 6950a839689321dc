#include "rilievo/relief_impostor/merge_rows.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "rilievo/render/shading/simd_test_helpers.h"

namespace rilievo {
namespace {

// A warp with surfaces at a few depths, silhouettes, holes and torn texels.
struct RandomWarp {
  int width = 0, height = 0;
  std::vector<std::uint32_t> color;
  std::vector<std::uint16_t> delta, flags;
};
RandomWarp random_warp(std::mt19937& rng, int width, int height) {
  std::uniform_int_distribution<int> byte(0, 255);
  RandomWarp warp{width, height, {}, {}, {}};
  int level = 20000, alpha = 255;
  for (int i = 0; i < width * height; ++i) {
    if (byte(rng) < 40) level = 5000 + 15000 * (byte(rng) % 4);
    if (byte(rng) < 60) alpha = byte(rng) < 190 ? 255 : byte(rng);
    const bool empty = byte(rng) < 30;
    std::uint32_t color = std::uint32_t(alpha) << 24;
    for (int c = 0; c < 24; c += 8) color |= std::uint32_t(byte(rng) * alpha / 255) << c;
    warp.color.push_back(empty ? 0 : color);
    warp.delta.push_back(std::uint16_t(empty ? int(kEmptyWarped) : level + byte(rng)));
    warp.flags.push_back(std::uint16_t(empty || byte(rng) < 200 ? 0 : byte(rng) & 3));
  }
  return warp;
}

// --- The slow definition: a texel at a time, the same operations on floats in the same order.

struct SlowTap {
  float color[4] = {}, inverse = 0;
  bool known = false;
};

float slow_inverse(const InverseDepth& depth, std::uint32_t code) {
  return depth.first + depth.per_code * float(code);
}

SlowTap slow_tap(const MergeInput& in, const RandomWarp& other, float u, float v) {
  SlowTap tap;
  const float x = u - 0.5f, y = v - 0.5f;
  if (!(x > -1 && y > -1 && x < float(other.width) && y < float(other.height))) return tap;
  const int left = int(std::floor(x)), top = int(std::floor(y));
  const float fx = x - float(left), fy = y - float(top);
  const float weights[4] = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
  int texels[4], best = -1;
  for (int k = 0; k < 4; ++k) {
    const int column = left + (k & 1), row = top + (k >> 1);
    const bool inside = column >= 0 && row >= 0 && column < other.width && row < other.height;
    texels[k] = inside ? row * other.width + column : -1;
    if (inside && other.delta[std::size_t(texels[k])] == kEmptyWarped) texels[k] = -1;
    if (texels[k] >= 0 && (best < 0 || weights[k] > weights[best])) best = k;
  }
  if (best < 0) return tap;
  const auto of_best = std::size_t(texels[best]);
  if (other.flags[of_best] & (kTornBit >> 16)) return tap;
  tap.known = true;
  tap.inverse = slow_inverse(in.other_depth, other.delta[of_best]);
  float sum = 0;
  for (int k = 0; k < 4; ++k) {
    if (texels[k] < 0) {
      sum += weights[k];  // transparent
      continue;
    }
    const auto texel = std::size_t(texels[k]);
    const float inverse = slow_inverse(in.other_depth, other.delta[texel]);
    if (std::abs(inverse - tap.inverse) > 0.01f * tap.inverse) continue;
    sum += weights[k];
    for (int c = 0; c < 4; ++c)
      tap.color[c] += weights[k] * float(other.color[texel] >> (8 * c) & 255);
  }
  const float scale = 1 / sum;
  for (float& channel : tap.color) channel *= scale;
  return tap;
}

std::uint32_t slow_rounded(const float (&color)[4]) {
  std::uint32_t bytes = 0;
  for (int c = 0; c < 4; ++c) bytes |= std::uint32_t(std::min(color[c] + 0.5f, 255.0f)) << (8 * c);
  return bytes;
}

std::uint32_t slow_in_front(std::uint32_t front, std::uint32_t behind) {
  const float through = 1 - float(front >> 24) / 255;
  float sum[4];
  for (int c = 0; c < 4; ++c)
    sum[c] = float(front >> (8 * c) & 255) + through * float(behind >> (8 * c) & 255);
  return slow_rounded(sum);
}

struct MergedCases {
  int taken = 0, mixed = 0, before = 0, behind = 0;
};

void slow_merge(const MergeInput& in, const RandomWarp& other, RandomWarp& main,
                MergedCases& cases) {
  for (int y = 0; y < main.height; ++y)
    for (int x = 0; x < main.width; ++x) {
      float at[3];
      for (int k = 0; k < 3; ++k)
        at[k] =
            in.map[0][k] * (float(x) + 0.5f) + (in.map[1][k] * (float(y) + 0.5f) + in.map[2][k]);
      if (!(at[2] > 0)) continue;
      const float per_w = 1 / at[2];
      const SlowTap tap = slow_tap(in, other, at[0] * per_w, at[1] * per_w);
      if (!tap.known || tap.color[3] < float(kFaintAlpha)) continue;
      const auto i = std::size_t(y * main.width + x);
      std::uint32_t& color = main.color[i];
      const float inverse = at[2] * tap.inverse;
      const auto move = [&] {
        const float code = (inverse - in.main_depth.first) / in.main_depth.per_code + 0.5f;
        main.delta[i] = std::uint16_t(std::clamp(code, 0.0f, float(kEmptyWarped - 1)));
      };
      const auto take = [&] {
        color = slow_rounded(tap.color);
        move();
        main.flags[i] = 0;
        ++cases.taken;
      };
      if (main.delta[i] == kEmptyWarped || (main.flags[i] & (kTornBit >> 16))) {
        take();
        continue;
      }
      const float own = slow_inverse(in.main_depth, main.delta[i]);
      const std::uint32_t alpha = color >> 24;
      if (std::abs(inverse - own) <= 0.01f * own) {
        if (tap.color[3] > float(alpha) + 0.5f) {
          take();
        } else if (tap.color[3] >= 254.5f && in.share > 0) {
          float mixed[4];
          for (int c = 0; c < 4; ++c) {
            const auto mine = float(color >> (8 * c) & 255);
            mixed[c] = mine + in.share * (tap.color[c] - mine);
          }
          color = slow_rounded(mixed);
          ++cases.mixed;
        }
      } else if (inverse > own) {
        color = slow_in_front(slow_rounded(tap.color), color);
        if (tap.color[3] >= 128) move();
        ++cases.before;
      } else if (alpha < 255) {
        color = slow_in_front(color, slow_rounded(tap.color));
        if (alpha < 128) move();
        ++cases.behind;
      }
    }
}

TEST(MergeRows, equal_the_slow_definition_to_the_byte_whatever_the_instruction_set) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<float> any(-1, 1);
  MergedCases cases;
  for (int round = 0; round < 40; ++round) {
    const auto size = [&] { return std::uniform_int_distribution<int>(1, 90)(rng); };
    const RandomWarp main = random_warp(rng, size(), size()),
                     other = random_warp(rng, size(), size());
    MergeInput in;
    for (int k = 0; k < 3; ++k)
      for (int c = 0; c < 3; ++c) in.map[k][c] = float(k == c) + 0.1f * any(rng);
    // Behind the other's eye, sometimes; mostly, surfaces of both have the same depths.
    for (int k = 0; k < 2; ++k) in.map[k][2] *= round % 4 ? 1e-3f : 0.2f;
    if (round % 4) in.map[2][2] = 1;
    for (int c = 0; c < 2; ++c) in.map[2][c] = 12 * any(rng);
    in.share = round % 3 ? 0.5f + 0.5f * any(rng) : 0;
    in.main_depth = {0.9f, -0.5f / 65534}, in.other_depth = {0.9f, -0.6f / 65534};

    std::vector<WarpTexel> texels;
    in.other_pitch = other.width + 2 + round % 5;
    in.other_width = other.width, in.other_height = other.height;
    texels.resize(std::size_t(in.other_pitch * (other.height + 2)), {0, kEmptyWarped});
    for (int y = 0; y < other.height; ++y) {
      const auto from = std::size_t(y * other.width);
      pack_row(&other.color[from], &other.delta[from], &other.flags[from], other.width,
               &texels[std::size_t((y + 1) * in.other_pitch + 1)]);
    }
    in.other = texels.data();

    RandomWarp expected = main;
    slow_merge(in, other, expected, cases);
    for_each_instruction_set([&](const char* name) {
      RandomWarp merged = main;
      for (int y = 0; y < main.height; ++y) {
        const auto row = std::size_t(y * main.width);
        merge_row(in, y, main.width, &merged.color[row], &merged.delta[row], &merged.flags[row]);
      }
      EXPECT_TRUE(merged.color == expected.color) << name << ' ' << round;
      EXPECT_TRUE(merged.delta == expected.delta) << name << ' ' << round;
      EXPECT_TRUE(merged.flags == expected.flags) << name << ' ' << round;
    });
  }
  // Each case was met, often.
  for (const int count : {cases.taken, cases.mixed, cases.before, cases.behind})
    EXPECT_GT(count, 200);
}

}  // namespace
}  // namespace rilievo
