#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <random>
#include <string>

#include "rilievo/io/png.h"
#include "rilievo/relief_impostor/critical_points.h"
#include "rilievo/relief_impostor/painted_picture_test_helpers.h"
#include "rilievo/relief_impostor/valid_eyes.h"

namespace rilievo {
namespace {

// Hills and a few cliffs, without holes but at the corners.
ImpostorPicture hills(std::mt19937& rng, int size) {
  std::uniform_real_distribution<double> any(-1, 1);
  const double a = any(rng), b = any(rng), c = 10 + 5 * any(rng), cliff = 0.3 * any(rng);
  return painted_picture(size, size, [&](double u, double v) -> std::optional<Paint> {
    if (u * u + v * v >= 1.2) return std::nullopt;
    const double depth = 0.5 + 0.15 * a * u + 0.15 * b * v + 0.05 * std::sin(c * (u + b * v)) +
                         (u > cliff + 0.3 * v ? 0.2 : 0.0);
    return Paint{{200, 100, 50, 255}, depth};
  });
}

glm::dvec3 some_eye(std::mt19937& rng, const ImpostorPicture& picture, double reach) {
  std::uniform_real_distribution<double> any(-1, 1);
  return picture.geometry.capture.position() +
         reach * glm::dvec3(any(rng), any(rng), 0.5 * any(rng));
}

TEST(CriticalPoints, are_the_neighbours_whose_levels_differ_most) {
  std::mt19937 rng(1);
  for (int round = 0; round < 20; ++round) {
    const ImpostorPicture picture = hills(rng, 60);
    const std::vector<CriticalPair> pairs = critical_pairs(picture, 4);
    ASSERT_GT(pairs.size(), 16u);
    // With one region: the largest differences of all.
    for (const CriticalPair& pair : critical_pairs(picture, 1)) {
      const auto difference = [&](int x, int y) {
        return std::abs(int(picture.at(x, y).code) -
                        int(picture.at(x + pair.across, y + !pair.across).code));
      };
      for (int y = 0; y + 1 < 60; ++y)
        for (int x = 0; x + 1 < 60; ++x) {
          if (picture.at(x, y).code == kEmptyLevel ||
              picture.at(x + pair.across, y + !pair.across).code == kEmptyLevel)
            continue;
          EXPECT_LE(difference(x, y), difference(pair.x, pair.y));
        }
    }
  }
}

TEST(CriticalPoints, nothing_is_stretched_for_the_pictures_own_eye) {
  std::mt19937 rng(2);
  const ImpostorPicture picture = hills(rng, 60);
  const auto warp = plane_warp(picture.geometry, picture.geometry.capture.position());
  const auto pairs = critical_pairs(picture, 8);
  EXPECT_NEAR(stretch_of(picture.geometry, pairs, *warp).mean, 1, 1e-9);
  EXPECT_NEAR(true_stretch(picture, 8, *warp).most, 1, 1e-9);
}

// The paper's parallel picture is the limit of a far eye: eqs. (5) and (6), with S4's signs.
TEST(CriticalPoints, equations_5_to_7_are_the_limit_of_a_far_eye) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> any(-1, 1);
  const double far = 1e7;
  const Camera camera = look_at({0, 0, far}, {0, 0, 0}, {0, 1, 0}, 2 * std::atan(1 / far), 100, 100,
                                far - 1, far + 1);
  PictureGeometry geometry = picture_geometry(camera);
  geometry.plane_z = far;
  for (int round = 0; round < 100; ++round) {
    const glm::dvec3 eye(any(rng), any(rng), 4 + any(rng));
    const auto warp = plane_warp(geometry, eye);
    ASSERT_TRUE(warp);
    const double u1 = 50 + 40 * any(rng), d1 = any(rng), d2 = any(rng), u2 = u1 + 1;
    const double u_e = 50 + 50 * eye.x, h = eye.z;
    const auto paper = [&](double u, double d) { return d * (u_e - u) / (h + d); };
    const auto ours = [&](double u, double d) {
      return warp->x.moved(u, warp->nearness((far + d) / far));
    };
    EXPECT_NEAR(ours(u2, d2) - ours(u1, d1), 1 + paper(u2, d2) - paper(u1, d1), 1e-4);
  }
}

TEST(CriticalPoints, never_exceed_the_true_stretch_and_order_eyes_as_it_does) {
  std::mt19937 rng(4);
  double worst = 1;
  for (int round = 0; round < 6; ++round) {
    const ImpostorPicture picture = hills(rng, 80);
    const auto pairs = critical_pairs(picture, 8);
    std::vector<double> guessed, known;
    for (int e = 0; e < 60; ++e) {
      const auto warp = plane_warp(picture.geometry, some_eye(rng, picture, 0.8));
      guessed.push_back(stretch_of(picture.geometry, pairs, *warp).mean);
      known.push_back(true_stretch(picture, 8, *warp).mean);
      EXPECT_LE(guessed.back(), known.back() + 1e-9);
    }
    // The share of pairs of eyes that both put into the same order.
    int same = 0, all = 0;
    for (std::size_t i = 0; i < known.size(); ++i)
      for (std::size_t k = 0; k < i; ++k, ++all)
        same += (guessed[i] < guessed[k]) == (known[i] < known[k]);
    worst = std::min(worst, double(same) / all);
  }
  RecordProperty("same_order", std::to_string(worst));
  // A heuristic; chance is a half.
  EXPECT_GT(worst, 0.75);
}

TEST(ValidEyes, the_map_agrees_with_brute_force) {
  std::mt19937 rng(5);
  for (int round = 0; round < 3; ++round) {
    const ImpostorPicture picture = hills(rng, 48);
    ValidEyesOptions options{.size = 33, .extent = 2.5, .max_share = 0.2, .step = 8};
    const ValidEyes map = valid_eyes(picture, options);
    options.step = 1;
    const ValidEyes all = valid_eyes(picture, options);
    EXPECT_EQ(all.tried, 33 * 33);
    EXPECT_LT(map.tried, all.tried);
    int valid = 0, differ = 0;
    for (int y = 0; y < 33; ++y)
      for (int x = 0; x < 33; ++x) {
        valid += all.valid(x, y);
        differ += all.valid(x, y) != map.valid(x, y);
      }
    if (const char* folder = std::getenv("RILIEVO_SHOW")) {
      EXPECT_TRUE(save_png(std::string(folder) + "/valid_eyes_" + std::to_string(round) + ".png",
                           picture_of(all)));
    }
    // The region is not empty, not everything, and holds the picture's eye.
    EXPECT_GT(valid, 30);
    EXPECT_LT(valid, 33 * 33 - 30);
    EXPECT_TRUE(map.valid(16, 16));
    // The ragged edge has tips thinner than a step.
    EXPECT_LE(differ, 33 * 33 / 50);
    EXPECT_EQ(eye_of(picture, options, 16, 16), picture.geometry.capture.position());
    EXPECT_EQ(picture_of(map)(16, 16), glm::u8vec4(255));
  }
}

}  // namespace
}  // namespace rilievo
