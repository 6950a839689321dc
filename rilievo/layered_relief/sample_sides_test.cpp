#include "rilievo/layered_relief/sample_sides.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <unordered_set>
#include <utility>
#include <vector>

#include "rilievo/core/random.h"
#include "rilievo/layered_relief/two_sided_ball_test_helpers.h"

namespace rilievo {
namespace {

// Lines of sight of which `of_line` tells how often each meets the object.
template <class OfLine>
bool is_closed(int lines, const OfLine& of_line) {
  LayeredDepthImage layers;
  layers.first = {0};
  for (int i = 0; i < lines; ++i) {
    for (int k = of_line(i); k > 0; --k) layers.samples.emplace_back().object = 1;
    layers.first.push_back(layers.samples.size());
  }
  const LayeredDepthImage* const all[] = {&layers};
  return find_closed_objects(all).contains(1);
}

// Leaves at random are met by a Poisson number of times: of many, hardly a line meets one alone.
TEST(SampleSides, many_leaves_are_not_a_closed_body) {
  for (const double mean : {1.0, 3.0, 5.0, 7.0, 10.0, 20.0}) {
    Random random(3);
    const auto leaves = [&](int) {
      int count = 0;
      for (double left = mean; (left += std::log(1 - double(random.unit()))) > 0;) ++count;
      return count;
    };
    EXPECT_FALSE(is_closed(20'000, leaves)) << mean;
  }
}

TEST(SampleSides, three_sheets_are_not_a_closed_body) {
  EXPECT_FALSE(is_closed(1000, [](int) { return 3; }));
  EXPECT_FALSE(is_closed(1000, [](int i) { return i == 500 ? 2 : 3; }));
}

// Where they touch, the two surfaces between them are one.
TEST(SampleSides, bodies_that_touch_are_closed) {
  EXPECT_TRUE(is_closed(1000, [](int i) { return i % 10 < 3 ? 3 : i % 10 < 5 ? 4 : 2; }));
}

TEST(SampleSides, bodies_are_closed_and_sheets_are_not) {
  const ReliefPictures ball = two_sided_ball(32);
  std::vector<const LayeredDepthImage*> all;
  for (const ReliefPictures::Picture& picture : ball.pictures) all.push_back(&picture.layers);
  EXPECT_TRUE(find_closed_objects(all).contains(1));
  // Half of it is met once.
  ReliefPictures half = ball;
  for (ReliefPictures::Picture& picture : half.pictures) {
    LayeredDepthImage& layers = picture.layers;
    LayeredDepthImage cut = layers;
    cut.samples.clear(), cut.first = {0};
    for (std::size_t line = 0; line + 1 < layers.first.size(); ++line) {
      for (std::uint64_t s = layers.first[line]; s < layers.first[line + 1]; ++s) {
        const int w = layers.camera.width;
        const glm::dvec3 at = world_from_raster(
            layers.camera,
            {double(line % std::size_t(w)) + 0.5, double(line / std::size_t(w)) + 0.5},
            double(layers.samples[s].depth));
        if (at.x + at.y + at.z > 0) cut.samples.push_back(layers.samples[s]);
      }
      cut.first.push_back(cut.samples.size());
    }
    layers = std::move(cut);
  }
  all.clear();
  for (const ReliefPictures::Picture& picture : half.pictures) all.push_back(&picture.layers);
  EXPECT_TRUE(find_closed_objects(all).empty());
}

// Of some lines of sight one hit is missing, as where surfaces that touch were merged: the others
// have the side that their neighbours have. Told by where a ball's surface is.
TEST(SampleSides, where_a_hit_is_missing_sides_follow_from_neighbours) {
  std::mt19937 rng(3);
  ReliefPictures balls = two_sided_ball(48);
  for (ReliefPictures::Picture& picture : balls.pictures) {
    // A second ball behind the first one. Of one line of eight the first ball's first or second hit
    // is missing.
    LayeredDepthImage& layers = picture.layers;
    LayeredDepthImage two = layers;
    two.samples.clear(), two.first = {0};
    for (std::size_t line = 0; line + 1 < layers.first.size(); ++line) {
      const std::size_t begin = layers.first[line], end = layers.first[line + 1];
      const std::size_t missing = rng() % 8 == 0 ? begin + rng() % 2 : end;
      for (std::size_t s = begin; s < end; ++s)
        if (s != missing) two.samples.push_back(layers.samples[s]);
      for (std::size_t s = begin; s < end; ++s) {
        two.samples.push_back(layers.samples[s]);
        two.samples.back().depth += 4, two.samples.back().back += 4;
      }
      two.first.push_back(two.samples.size());
    }
    layers = std::move(two);
  }
  std::vector<const LayeredDepthImage*> all;
  for (const ReliefPictures::Picture& picture : balls.pictures) all.push_back(&picture.layers);
  const std::unordered_set<std::uint32_t> closed = find_closed_objects(all);
  ASSERT_TRUE(closed.contains(1));
  int odd = 0, wrong = 0;
  for (const LayeredDepthImage* layers : all) {
    const SampleSides sides(*layers, closed);
    const Camera& camera = layers->camera;
    const auto w = std::size_t(camera.width);
    for (std::size_t line = 0; line + 1 < layers->first.size(); ++line) {
      const std::size_t begin = layers->first[line], end = layers->first[line + 1];
      if ((end - begin) % 2 == 0) continue;
      for (std::size_t s = begin; s < end; ++s) {
        const glm::dvec3 at =
            world_from_raster(camera, {double(line % w) + 0.5, double(line / w) + 0.5},
                              double(layers->samples[s].depth));
        const bool first_ball = s == begin;
        const glm::dvec3 centre = first_ball ? glm::dvec3(0) : 4.0 * camera.forward();
        const double faces = -glm::dot(glm::normalize(at - centre), camera.forward());
        // Near its rim both of a ball's sides are close together and across.
        if (std::abs(faces) < 0.4) continue;
        ++odd;
        wrong += sides.is_outer(s) != (faces > 0);
      }
    }
  }
  EXPECT_GT(odd, 1000);
  EXPECT_EQ(wrong, 0);
}

// The normals of a ball are its radii.
TEST(SampleSides, normals_point_at_the_viewers) {
  const ReliefPictures ball = two_sided_ball(64);
  const std::unordered_set<std::uint32_t> closed{1};
  for (const ReliefPictures::Picture& picture : ball.pictures) {
    const SampleSides sides(picture.layers, closed);
    const Camera& camera = picture.layers.camera;
    int seen = 0;
    for (std::size_t line = 0; line + 1 < picture.layers.first.size(); ++line)
      for (std::uint64_t s = picture.layers.first[line]; s < picture.layers.first[line + 1]; ++s) {
        const auto w = std::size_t(camera.width);
        const glm::dvec3 at =
            world_from_raster(camera, {double(line % w) + 0.5, double(line / w) + 0.5},
                              double(picture.layers.samples[s].depth));
        const bool front = s == picture.layers.first[line];
        const glm::dvec3 normal = (front ? 1.0 : -1.0) * glm::normalize(at);
        if (-glm::dot(normal, camera.forward()) < 0.4) continue;
        EXPECT_GT(glm::dot(glm::dvec3(sides.normal(s)), normal), 0.99);
        ++seen;
      }
    EXPECT_GT(seen, 2000);
  }
}

}  // namespace
}  // namespace rilievo
