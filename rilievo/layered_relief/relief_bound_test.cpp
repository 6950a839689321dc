#include "rilievo/layered_relief/relief_bound.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rilievo/layered_relief/relief_error_test_helpers.h"
#include "rilievo/layered_relief/relief_pictures.h"
#include "rilievo/layered_relief/relief_test_helpers.h"
#include "rilievo/nailboard/encode_prewarped.h"

namespace rilievo {
namespace {

// The bound out of plain data is never below the one out of the relief's hull, and seldom far
// above.
TEST(ReliefBound, from_the_box_is_no_less_than_from_the_hull) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> unit(-1, 1);
  std::vector<double> ratios;
  int picked = 0;
  for (int i = 0; i < 30; ++i) {
    ReliefPictures pictures;
    pictures.pictures.push_back({random_layers(rng, 30, 34), 0.01 * (i % 3), 0.005 * (i % 2)});
    pictures.bounds = bounds_of(pictures);
    const auto set = make_relief_set(pictures);
    ASSERT_TRUE(set);
    PrewarpOptions options;
    options.splat_size = 1 + 0.5 * (i % 3);
    options.max_size = i % 4 ? 1024 : 48;
    const ReliefStats stats =
        relief_stats(*set, pictures.bounds, pictures.pictures[0].moved, options);
    const LayeredRelief& relief = set->reliefs[0];
    const ReliefFrame frame = relief.frame();
    for (int e = 0; e < 30; ++e) {
      const glm::dvec3 eye = random_eye(rng, relief);
      const Camera camera = look_at(eye, frame.world(15 + 20 * unit(rng), 17 + 20 * unit(rng), 0),
                                    {0, 1, 0.1}, 0.5 + 0.4 * unit(rng), 640, 480, 0.01, 100);
      const double bound = relief_bound_px(stats, pictures.bounds, camera);
      if (!std::isfinite(bound)) continue;
      EXPECT_EQ(pick_relief(stats, pictures.bounds, eye), 0);
      Prewarped result;
      const auto stats = Prewarp(relief, options).warp(eye, nullptr, result);
      ASSERT_TRUE(stats);  // what has a bound can be warped
      // That one takes the whole frame to be as oblique as its corners.
      const double exact = relief_error_px(relief, camera,
                                           {.splat_size = options.splat_size,
                                            .resolution = stats->resolution,
                                            .source_error = pictures.pictures[0].moved});
      const auto& [l, r, b, t] = camera.window;
      const double corner = 1 + std::max(l * l, r * r) + std::max(b * b, t * t);
      EXPECT_GE(bound + std::sqrt(0.5), exact / corner * (1 - 1e-9));
      ratios.push_back((bound + std::sqrt(0.5)) / exact);
      ++picked;
    }
  }
  EXPECT_GT(picked, 300);
  std::nth_element(ratios.begin(), ratios.begin() + std::ptrdiff_t(ratios.size() / 2),
                   ratios.end());
  EXPECT_LT(ratios[ratios.size() / 2], 2.5);
}

TEST(ReliefBound, a_scaled_and_moved_instance_is_off_as_much_as_its_eye_says) {
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> unit(-1, 1);
  for (int i = 0; i < 100; ++i) {
    const Camera frame =
        look_at({unit(rng), unit(rng), 4}, {0, 0, unit(rng)}, {0, 1, 0}, 0.8, 320, 200, 0.1, 50);
    const double scale = std::exp(unit(rng));
    glm::dmat4 motion = frame.world_from_eye;  // any rotation
    for (int k = 0; k < 3; ++k) motion[k] *= scale;
    motion[3] = glm::dvec4(unit(rng), unit(rng), unit(rng), 1);
    const auto at_capture = camera_at_capture(frame, motion);
    ASSERT_TRUE(at_capture);
    ASSERT_TRUE(validate(*at_capture));
    for (int k = 0; k < 10; ++k) {
      const glm::dvec4 p(unit(rng), unit(rng), unit(rng), 1);
      const glm::dvec3 there = raster_from_world(frame, glm::dvec3(motion * p));
      const glm::dvec3 here = raster_from_world(*at_capture, glm::dvec3(p));
      EXPECT_NEAR(there.x, here.x, 1e-6 * (1 + std::abs(there.x)));
      EXPECT_NEAR(there.y, here.y, 1e-6 * (1 + std::abs(there.y)));
      EXPECT_NEAR(there.z, scale * here.z, 1e-9);
    }
    motion[0] *= 1.01;
    EXPECT_FALSE(camera_at_capture(frame, motion));
    motion[0] *= -1 / 1.01;
    EXPECT_FALSE(camera_at_capture(frame, motion));
  }
}

Prewarped random_picture(std::mt19937& rng, int width, int height) {
  Prewarped picture;
  picture.geometry.capture.width = width;
  picture.geometry.capture.height = height;
  picture.geometry.capture.window = {-1, -1 + 0.1 * width, 0.5 - 0.1 * height, 0.5};
  for (int i = 0; i < width * height; ++i) {
    const bool empty = rng() % 3 == 0;
    picture.delta.push_back(std::uint16_t(empty ? kEmptyCode : rng() % kEmptyCode));
    picture.color.push_back(empty ? glm::u8vec4(0)
                                  : glm::u8vec4(rng() % 256, rng() % 256, rng() % 256, 255));
  }
  return picture;
}

TEST(EncodePrewarped, halved_pictures_have_the_mean_colour_and_the_nearest_depth) {
  std::mt19937 rng(7);
  for (const auto& [w, h] : {std::pair(8, 6), std::pair(7, 5), std::pair(1, 9)}) {
    const Prewarped picture = random_picture(rng, w, h);
    Prewarped halved, scratch;
    halve_prewarped(picture, 2, halved, scratch);
    EXPECT_EQ(halved.width(), (w + 3) / 4);
    EXPECT_EQ(halved.height(), (h + 3) / 4);
    for (int y = 0; y < halved.height(); ++y)
      for (int x = 0; x < halved.width(); ++x) {
        glm::dvec4 sum(0);
        std::uint16_t nearest = kEmptyCode;
        for (int v = 4 * y; v < std::min(h, 4 * y + 4); ++v)
          for (int u = 4 * x; u < std::min(w, 4 * x + 4); ++u) {
            sum += glm::dvec4(picture.color[std::size_t(v * w + u)]) / 16.0;
            nearest = std::min(nearest, picture.delta[std::size_t(v * w + u)]);
          }
        const std::size_t at = std::size_t(y * halved.width() + x);
        EXPECT_EQ(halved.delta[at], nearest);
        for (int k = 0; k < 4; ++k)  // rounded twice
          EXPECT_NEAR(double(halved.color[at][k]), sum[k], 1.01);
      }
    // Texels stand where they stood.
    const Camera& c = halved.geometry.capture;
    EXPECT_NEAR((c.window.right - c.window.left) / c.width, 0.4, 1e-12);
    EXPECT_NEAR((c.window.top - c.window.bottom) / c.height, 0.4, 1e-12);
    EXPECT_EQ(c.window.left, -1);
    EXPECT_EQ(c.window.top, 0.5);
  }
}

// Against the atlas's own rule (encode_picture.h), texel by texel.
TEST(EncodePrewarped, pieces_hold_all_texels_and_the_nearest_delta_around_empty_ones) {
  std::mt19937 rng(9);
  const Prewarped picture = random_picture(rng, 23, 18);
  int texels = 0;
  for (const PicturePiece& piece : pieces_of(23, 18, 10)) {
    EncodedPiece encoded;
    encode_prewarped(picture, piece, encoded);
    const Camera part = geometry_of(picture.geometry, piece).capture;
    for (int y = 0; y < piece.height; ++y)
      for (int x = 0; x < piece.width; ++x) {
        const int u = piece.x + x, v = piece.y + y;
        const std::size_t from = std::size_t(v * 23 + u);
        const std::size_t to = std::size_t((piece.height - 1 - y) * piece.width + x);
        std::uint16_t expected = picture.delta[from];
        if (expected == kEmptyCode)
          for (int b = std::max(0, v - 1); b <= std::min(17, v + 1); ++b)
            for (int a = std::max(0, u - 1); a <= std::min(22, u + 1); ++a)
              expected = std::min(expected, picture.delta[std::size_t(b * 23 + a)]);
        EXPECT_EQ(encoded.picture.codes16[to], expected);
        EXPECT_EQ(encoded.color[to], picture.color[from]);
        const int row = piece.height - 1 - y;
        const OcclusionTile& block =
            encoded.picture.blocks[std::size_t(row / 4 * blocks_across(piece.width) + x / 4)];
        EXPECT_EQ((block.covered >> (x % 4 + 4 * (row % 4)) & 1) != 0, expected != kEmptyCode);
        if (expected != kEmptyCode) {
          EXPECT_LE(block.nearest_delta(), expected / double(delta_steps(16)) + 1e-12);
          EXPECT_GE(block.farthest_delta(), expected / double(delta_steps(16)) - 1e-12);
        }
        const glm::dvec3 whole =
            world_from_raster(picture.geometry.capture, {u + 0.5, v + 0.5}, 1.0);
        EXPECT_LT(glm::distance(whole, world_from_raster(part, {x + 0.5, y + 0.5}, 1.0)), 1e-12);
        ++texels;
      }
  }
  EXPECT_EQ(texels, 23 * 18);
}

}  // namespace
}  // namespace rilievo
