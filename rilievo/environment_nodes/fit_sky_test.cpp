#include "rilievo/environment_nodes/fit_sky.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rilievo {
namespace {

// A colour of a Sky, as frames' shaders have it.
glm::vec3 color_of(const Sky& sky, double elevation) {
  const glm::dvec3 shares = sky_shares(elevation);
  return float(shares.x) * sky.zenith + float(shares.y) * sky.horizon +
         float(shares.z) * sky.ground;
}

// The sum of squares that a fit shall make small.
double error_of(const Sky& sky, const std::vector<std::pair<glm::dvec3, glm::vec3>>& seen) {
  double sum = 0;
  for (const auto& [to, color] : seen) {
    const glm::vec3 off = color_of(sky, to.y) - color;
    sum += double(glm::dot(off, off));
  }
  return sum;
}

std::vector<glm::dvec3> directions(int count, std::mt19937& random) {
  std::normal_distribution<double> normal;
  std::vector<glm::dvec3> all;
  for (int i = 0; i < count; ++i) {
    const double x = normal(random);
    const double y = normal(random);
    const double z = normal(random);
    all.push_back(glm::normalize(glm::dvec3(x, y, z)));
  }
  return all;
}

TEST(FitSky, finds_the_sky_that_was_seen) {
  Sky sky;
  sky.zenith = {0.1f, 0.3f, 0.9f}, sky.horizon = {0.9f, 0.8f, 0.7f}, sky.ground = {0.2f, 0.1f, 0};
  std::mt19937 random(7);
  SkySums sums;
  for (const glm::dvec3& to : directions(2000, random)) sums.add(to, color_of(sky, to.y), 0.001);
  const std::optional<Sky> found = fit_sky(sums);
  ASSERT_TRUE(found.has_value());
  // The mean colour counts a thousandth of the weight, against shares that are a tenth of it.
  for (int c = 0; c < 3; ++c) {
    EXPECT_NEAR(found->zenith[c], sky.zenith[c], 0.02);
    EXPECT_NEAR(found->horizon[c], sky.horizon[c], 0.02);
    EXPECT_NEAR(found->ground[c], sky.ground[c], 0.02);
  }
}

// The slow twin: no other sky of many at random is nearer to what was seen.
TEST(FitSky, no_other_sky_is_nearer_to_noisy_colours) {
  std::mt19937 random(11);
  std::uniform_real_distribution<float> any(0.2f, 0.8f);
  SkySums sums;
  std::vector<std::pair<glm::dvec3, glm::vec3>> seen;
  for (const glm::dvec3& to : directions(500, random)) {
    const float r = any(random);
    const float g = any(random);
    const float b = any(random);
    seen.emplace_back(to, glm::vec3(r, g, b));
    sums.add(to, seen.back().second, 1);
  }
  const Sky best = *fit_sky(sums);
  const double least = error_of(best, seen);
  for (int i = 0; i < 300; ++i) {
    Sky other = best;
    for (glm::vec3* color : {&other.zenith, &other.horizon, &other.ground})
      for (int c = 0; c < 3; ++c) (*color)[c] += 0.3f * (any(random) - 0.5f);
    // What the mean colour counts moves the fit, and the sum by its square: less than this.
    EXPECT_GT(error_of(other, seen), least * (1 - 1e-4));
  }
}

TEST(FitSky, what_was_not_seen_has_the_mean_colour) {
  SkySums sums;
  EXPECT_FALSE(fit_sky(sums).has_value());
  // A window that shows a white sky, cut off at 1, around the horizon.
  for (int i = 0; i < 100; ++i)
    sums.add(glm::normalize(glm::dvec3(1, 0.002 * i - 0.1, 0)), {2.6f, 3.2f, 4.0f}, 0.01);
  const Sky sky = *fit_sky(sums);
  for (const glm::vec3& color : {sky.zenith, sky.horizon, sky.ground})
    for (int c = 0; c < 3; ++c) EXPECT_NEAR(color[c], 1, 1e-5);
}

}  // namespace
}  // namespace rilievo
