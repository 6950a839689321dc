#include "rilievo/layered_relief/fill_pinholes.h"

#include <gtest/gtest.h>

#include "rilievo/layered_relief/layered_relief.h"

namespace rilievo {
namespace {

constexpr std::uint16_t kFront = 10000, kBehind = 50000;

// 12 x 9 texels of a wall in front, whose colours tell them apart.
Prewarped wall() {
  Prewarped picture;
  Camera& camera = picture.geometry.capture;
  camera.width = 12, camera.height = 9;
  camera.z_near = 1, camera.z_far = 3;
  picture.geometry.plane_z = 2;
  camera.window = {-0.06, 0.06, -0.045, 0.045};
  picture.geometry.delta_bits = 16;
  for (int i = 0; i < 108; ++i) picture.color.emplace_back(i, 0, 0, 255);
  picture.delta.assign(108, kFront);
  return picture;
}

Prewarped filled(Prewarped picture) {
  std::vector<std::uint16_t> scratch;
  fill_pinholes(picture, scratch);
  return picture;
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

}  // namespace
}  // namespace rilievo
