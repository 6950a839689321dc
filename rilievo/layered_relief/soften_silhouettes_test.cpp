#include "rilievo/layered_relief/soften_silhouettes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "rilievo/core/depth.h"

namespace rilievo {
namespace {

constexpr glm::u8vec4 kInk(200, 100, 40, 255);

// Opaque where `covered(x, y)`.
template <class Covered>
Prewarped picture_of(int width, int height, const Covered& covered) {
  Prewarped picture;
  picture.geometry.capture.width = width, picture.geometry.capture.height = height;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const bool is = covered(x, y);
      picture.color.push_back(is ? kInk : glm::u8vec4(0));
      picture.delta.push_back(is ? std::uint16_t(1000) : std::uint16_t(delta_transparent(16)));
    }
  return picture;
}

int alpha_of(const Prewarped& picture, int x, int y) {
  return picture.color[std::size_t(y) * std::size_t(picture.width()) + std::size_t(x)].a;
}

TEST(SoftenSilhouettes, alpha_is_the_share_of_what_is_covered_around) {
  std::mt19937 rng(3);
  for (const auto& [width, height] :
       {std::pair{70, 67}, {600, 240}, {8, 1}, {1, 40}, {9, 33}, {3, 3}}) {
    std::bernoulli_distribution some(0.85);
    const Prewarped before = picture_of(width, height, [&](int, int) { return some(rng); });
    Prewarped picture = before;
    soften_silhouettes(picture);
    EXPECT_EQ(picture.delta, before.delta);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        int sum = 0;
        for (int v = -1; v <= 1; ++v)
          for (int u = -1; u <= 1; ++u)
            sum += (2 - std::abs(u)) * (2 - std::abs(v)) *
                   (alpha_of(before, std::clamp(x + u, 0, width - 1),
                             std::clamp(y + v, 0, height - 1)) > 0);
        const std::size_t i = std::size_t(y) * std::size_t(width) + std::size_t(x);
        for (int c = 0; c < 4; ++c)
          EXPECT_EQ(picture.color[i][c], (before.color[i][c] * sum + 8) / 16) << x << ' ' << y;
      }
  }
}

TEST(SoftenSilhouettes, a_straight_silhouette_has_three_quarters_and_a_line_half) {
  Prewarped half = picture_of(20, 20, [](int x, int) { return x < 10; });
  soften_silhouettes(half);
  EXPECT_EQ(alpha_of(half, 9, 7), 191);
  EXPECT_EQ(alpha_of(half, 8, 7), 255);
  EXPECT_EQ(alpha_of(half, 10, 7), 0);
  // Beyond the picture's edge it goes on.
  EXPECT_EQ(alpha_of(half, 0, 7), 255);
  Prewarped line = picture_of(20, 20, [](int x, int) { return x == 10; });
  soften_silhouettes(line);
  EXPECT_EQ(alpha_of(line, 10, 0), 128);
}

}  // namespace
}  // namespace rilievo
