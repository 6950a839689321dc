#include "rilievo/layered_relief/fill_pinholes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <optional>

#include "rilievo/core/depth.h"
#include "rilievo/core/random.h"
#include "rilievo/layered_relief/layered_relief.h"

namespace rilievo {
namespace {

constexpr std::uint16_t kFront = 10000, kBehind = 50000;

// Texels of a wall in front, whose colours tell those apart that are near each other.
Prewarped wall(int width = 12, int height = 9) {
  Prewarped picture;
  Camera& camera = picture.geometry.capture;
  camera.width = width, camera.height = height;
  camera.z_near = 1, camera.z_far = 3;
  picture.geometry.plane_z = 2;
  camera.window = {-0.005 * width, 0.005 * width, -0.005 * height, 0.005 * height};
  picture.geometry.delta_bits = 16;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) picture.color.emplace_back(x, y, 0, 255);
  picture.delta.assign(picture.color.size(), kFront);
  return picture;
}

Prewarped filled(Prewarped picture, double spacing = 1) {
  static PinholeScratch scratch;  // as pictures before left it
  fill_pinholes(picture, spacing, scratch);
  return picture;
}

// The slow way: every texel, every line, every pair of ends.
struct SlowGap {
  std::size_t near = 0, far = 0;
  int texels = 1000;
};
SlowGap slow_gap(const Prewarped& picture, int x, int y, int right, int down) {
  const int step = pinhole_step(picture.geometry);
  const auto place = [&](int k) {
    return std::size_t(y + k * down) * std::size_t(picture.width()) + std::size_t(x + k * right);
  };
  // On one side: what lies in front of the texel, in front of that, and so on.
  const auto ends = [&](int way) {
    std::vector<int> found{0};
    for (int k = 1; k <= kPinholeReach; ++k) {
      const int u = x + way * k * right, v = y + way * k * down;
      if (u < 0 || v < 0 || u >= picture.width() || v >= picture.height()) break;
      if (picture.delta[place(way * k)] + step < picture.delta[place(way * found.back())])
        found.push_back(k);
    }
    found.erase(found.begin());
    return found;
  };
  SlowGap least;
  for (const int before : ends(-1))
    for (const int after : ends(1)) {
      const std::size_t a = place(-before), b = place(after);
      const int texels = before + after - 1;
      if (texels > kPinholeReach || texels >= least.texels) continue;
      if (std::abs(picture.delta[a] - picture.delta[b]) > kPinholeEnds * step) continue;
      const bool a_is_far = picture.delta[a] > picture.delta[b];
      least = {a_is_far ? b : a, a_is_far ? a : b, texels};
    }
  return least;
}
Prewarped slowly_filled(const Prewarped& picture, double spacing) {
  Prewarped out = picture;
  for (int y = 0; y < picture.height(); ++y)
    for (int x = 0; x < picture.width(); ++x) {
      SlowGap least;
      bool all = true;
      for (const glm::ivec2 line : {glm::ivec2(0, 1), {1, 0}, {1, 1}, {1, -1}}) {
        const SlowGap gap = slow_gap(picture, x, y, line.x, line.y);
        all = all && gap.texels <= kPinholeReach;
        if (gap.texels < least.texels) least = gap;
      }
      if (!all) continue;
      const Camera& camera = picture.geometry.capture;
      const double z = eye_z_from(DepthKind::window_z, decode_delta(picture.delta[least.near], 16),
                                  camera, {0.5, 0.5});
      if (least.texels > std::max(1.0, std::round(spacing * picture.geometry.plane_z / z)))
        continue;
      const std::size_t texel = std::size_t(y) * std::size_t(picture.width()) + std::size_t(x);
      out.delta[texel] = picture.delta[least.far], out.color[texel] = picture.color[least.far];
    }
  return out;
}

TEST(FillPinholes, one_of_one_or_two_texels_is_closed_whatever_shows_through_it) {
  for (const std::uint16_t behind : {kBehind, std::uint16_t(kEmptyCode)})
    for (const int second : {0, 1, 11, 12, 13}) {
      Prewarped picture = wall();
      picture.delta[4 * 12 + 5] = behind;
      picture.delta[std::size_t(4 * 12 + 5 + second)] = behind;
      const Prewarped closed = filled(picture);
      EXPECT_EQ(closed.delta, std::vector<std::uint16_t>(108, kFront)) << second;
      // With a neighbour's colour.
      EXPECT_NE(closed.color[4 * 12 + 5], picture.color[4 * 12 + 5]);
    }
}

TEST(FillPinholes, slits_and_what_lies_beside_an_edge_stay_open) {
  Prewarped slit = wall(), edge = wall(), corner = wall(), near = wall();
  for (std::size_t y = 0; y < 9; ++y) {
    slit.delta[y * 12 + 5] = kBehind;
    for (std::size_t x = 6; x < 12; ++x) edge.delta[y * 12 + x] = kEmptyCode;
    if (y > 3)
      for (std::size_t x = 6; x < 12; ++x) corner.delta[y * 12 + x] = kBehind;
  }
  // A dent of less than the step.
  near.delta[4 * 12 + 5] = std::uint16_t(kFront + pinhole_step(near.geometry));
  for (const Prewarped& picture : {slit, edge, corner, near}) {
    const Prewarped same = filled(picture);
    EXPECT_EQ(same.delta, picture.delta);
    EXPECT_EQ(same.color, picture.color);
  }
  near.delta[4 * 12 + 5] = std::uint16_t(near.delta[4 * 12 + 5] + 1);
  EXPECT_NE(filled(near).delta, near.delta);
}

TEST(FillPinholes, gaps_are_closed_that_are_no_wider_than_samples_are_apart_at_their_depth) {
  // Of three texels each way.
  Prewarped hole = wall();
  for (std::size_t y = 3; y < 6; ++y)
    for (std::size_t x = 4; x < 7; ++x) hole.delta[y * 12 + x] = kEmptyCode;
  const double z =
      eye_z_from(DepthKind::window_z, decode_delta(kFront, 16), hole.geometry.capture, {});
  const double at_plane = z / hole.geometry.plane_z;
  EXPECT_EQ(filled(hole, 2.4 * at_plane).delta[4 * 12 + 5], kEmptyCode);
  EXPECT_EQ(filled(hole, 2.6 * at_plane).delta, std::vector<std::uint16_t>(108, kFront));
  // A crack of one texel, whatever shows through parts of it.
  Prewarped crack = wall();
  for (std::size_t x = 2; x < 10; ++x)
    crack.delta[4 * 12 + x] = x < 6 ? kBehind : std::uint16_t(kEmptyCode);
  EXPECT_EQ(filled(crack).delta, std::vector<std::uint16_t>(108, kFront));
  crack.delta[4 * 12 + 1] = kBehind;
  EXPECT_EQ(filled(crack).delta, crack.delta);
}

TEST(FillPinholes, all_agrees_with_the_slow_way) {
  Random random(3);
  std::size_t closed = 0, open = 0;
  for (int i = 0; i < 50; ++i) {
    // Large ones have texels far from their border, which are asked for many at a time.
    Prewarped picture = i % 5 == 0 ? wall(90, 40) : wall();
    const int step = pinhole_step(picture.geometry);
    for (std::uint16_t& delta : picture.delta) {
      const float what = random.unit();
      delta = std::uint16_t(kFront + int(random.between(0, 1.2f * float(step))));
      if (what < 0.2f) delta = kBehind;
      if (what < 0.15f) delta = std::uint16_t(kBehind - int(random.between(0, 3.0f * float(step))));
      if (what < 0.07f) delta = kEmptyCode;
    }
    const double spacing = random.between(0, 4);
    const Prewarped fast = filled(picture, spacing), slow = slowly_filled(picture, spacing);
    EXPECT_EQ(fast.delta, slow.delta);
    EXPECT_EQ(fast.color, slow.color);
    for (std::size_t k = 0; k < picture.delta.size(); ++k)
      if (picture.delta[k] > kFront + 2 * step)
        ++(slow.delta[k] == picture.delta[k] ? open : closed);
  }
  // Both happen.
  EXPECT_GT(closed, 100u);
  EXPECT_GT(open, 100u);
}

}  // namespace
}  // namespace rilievo
