#include "rilievo/keyframes/software/hole_points.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <vector>

#include "rilievo/core/random.h"

namespace rilievo {
namespace {

constexpr int kColumns = 60, kRows = 40, kObjects = 7;

Camera eye_at(const glm::dvec3& eye, const glm::dvec3& target) {
  return look_at(eye, target, {0, 1, 0}, 0.9, kColumns, kRows, 0.1, 500);
}

std::vector<FramePixel> random_pixels(Random& random, float share) {
  std::vector<FramePixel> pixels;
  for (int i = 0; i < kColumns * kRows; ++i)
    if (random.unit() < share)
      pixels.push_back({std::uint16_t(i % kColumns), std::uint16_t(i / kColumns)});
  return pixels;
}

// A point as the definition has it, in double precision.
struct SlowPoint {
  FoundInHole found;
  glm::dvec3 place{0.0};  // a direction, of the sky
};

SlowPoint place_of(const Camera& camera, const FoundInHole& found) {
  const ImageWindow& w = camera.window;
  const double x = w.left + (found.pixel.x + 0.5) / camera.width * (w.right - w.left),
               y = w.top + (found.pixel.y + 0.5) / camera.height * (w.bottom - w.top);
  const glm::dvec3 ray = glm::dmat3(camera.world_from_eye) * glm::dvec3(x, y, -1);
  if (!(found.inverse_z > 0)) return {found, ray};
  return {found, camera.position() + ray / double(found.inverse_z)};
}

struct SlowShown {
  std::optional<FoundInHole> found;
  bool sure = true;  // no rounding decides
};

// What a hole shows: looks at all points.
SlowShown show_slowly(const Camera& camera, FramePixel hole, const std::vector<SlowPoint>& points,
                      const bool* included) {
  constexpr double kRounding = 1e-3;
  SlowShown out;
  bool best_close = false;
  double best_z = 0;
  for (const SlowPoint& point : points) {
    const bool surface = point.found.inverse_z > 0;
    if (surface && !included[point.found.object]) continue;
    const glm::dvec3 way = surface ? point.place - camera.position() : point.place;
    const glm::dvec3 eye = glm::transpose(glm::dmat3(camera.world_from_eye)) * way;
    const double z = -eye.z;
    if (z <= (surface ? camera.z_near : 0)) continue;
    const ImageWindow& w = camera.window;
    const double x = (eye.x / z - w.left) / (w.right - w.left) * camera.width,
                 y = (w.top - eye.y / z) / (w.top - w.bottom) * camera.height;
    const double off = std::max(std::abs(x - (hole.x + 0.5)), std::abs(y - (hole.y + 0.5)));
    for (const float reach : {HolePoints::kReach, HolePoints::kFarReach})
      if (std::abs(off - double(reach)) < kRounding) out.sure = false;
    if (off > double(HolePoints::kFarReach)) continue;
    const bool close = off <= double(HolePoints::kReach);
    const double near = surface ? 1 / z : 0;
    if (out.found && std::abs(near - best_z) < 1e-6 * near) out.sure = false;
    if (!out.found || (close && !best_close) || (close == best_close && near >= best_z)) {
      out.found = point.found;
      out.found->inverse_z = float(near);
      best_close = close, best_z = near;
    }
  }
  return out;
}

TEST(HolePoints, HolesShowWhatTheDefinitionSays) {
  Random random(5);
  int shown = 0, unsure = 0, sky = 0, none = 0;
  for (int i = 0; i < 40; ++i) {
    const Camera before = eye_at({0, 0, 0}, {0, 0, -10});
    const Camera after = eye_at({random.between(-0.3f, 0.3f), random.between(-0.3f, 0.3f), -0.5},
                                {random.between(-0.5f, 0.5f), 0, -10});
    std::vector<FoundInHole> found;
    std::vector<SlowPoint> slow;
    for (const FramePixel pixel : random_pixels(random, 0.6f)) {
      FoundInHole one{pixel};
      if (random.unit() < 0.8f)
        one = {pixel, 1 / random.between(3, 60), 0xff000000u | std::uint32_t(random.below(1 << 24)),
               std::uint32_t(random.below(kObjects))};
      found.push_back(one);
      slow.push_back(place_of(before, one));
    }
    const auto included = std::make_unique<bool[]>(kObjects);
    for (int object = 0; object < kObjects; ++object) included[object] = random.unit() < 0.8f;
    HolePoints points;
    points.keep(before, found);
    const std::vector<FramePixel> holes = random_pixels(random, 0.5f);
    points.show(after, holes, {included.get(), kObjects});
    for (std::size_t hole = 0; hole < holes.size(); ++hole) {
      const SlowShown expected = show_slowly(after, holes[hole], slow, included.get());
      if (!expected.sure) {
        ++unsure;
        continue;
      }
      ASSERT_EQ(points.shows(hole), expected.found.has_value()) << i << " " << hole;
      if (!expected.found) {
        ++none;
        continue;
      }
      ASSERT_NEAR(points.inverse_z(hole), expected.found->inverse_z, 1e-5);
      if (expected.found->inverse_z > 0) {
        EXPECT_EQ(points.color(hole), expected.found->color);
        EXPECT_EQ(points.object(hole), expected.found->object);
        ++shown;
      } else {
        ++sky;
      }
    }
  }
  EXPECT_GT(shown, 20000);
  EXPECT_GT(sky, 1000);
  EXPECT_GT(none, 1000);
  EXPECT_LT(unsure, 2000);
}

TEST(HolePoints, APointIsShownByFourPixelsAtMost) {
  Random random(9);
  double most = 0;
  const bool included[] = {true};
  for (int i = 0; i < 200; ++i) {
    std::vector<FoundInHole> found;
    for (const FramePixel pixel : random_pixels(random, 0.01f))
      found.push_back({pixel, 0.1f, 0xff0000ffu, 0});
    if (found.empty()) continue;
    const double step = 0.03 * random.unit();
    HolePoints points;
    points.keep(eye_at({0, 0, 0}, {0, 0, -10}), found);
    const std::vector<FramePixel> holes = random_pixels(random, 1);
    points.show(eye_at({step, step, 0}, {step, step, -10}), holes, included);
    std::size_t shown = 0;
    for (std::size_t hole = 0; hole < holes.size(); ++hole) shown += points.shows(hole);
    EXPECT_LE(shown, HolePoints::kMostShown * found.size());
    most = std::max(most, double(shown) / double(found.size()));
  }
  EXPECT_GT(most, 3.5);
}

TEST(HolePoints, AStandingEyeSeesEachPointInItsPixel) {
  Random random(6);
  const Camera camera = eye_at({1000, 20, -3000}, {1010, 15, -3100});
  std::vector<FoundInHole> found;
  std::vector<FramePixel> holes = random_pixels(random, 0.5f);
  for (const FramePixel pixel : holes)
    found.push_back({pixel, 1 / random.between(1, 400), 0xff000000u | pixel.x, 0});
  HolePoints points;
  const bool included[] = {true};
  points.keep(camera, found);
  for (int frame = 0; frame < 3; ++frame) {
    points.show(camera, holes, included);
    for (std::size_t i = 0; i < holes.size(); ++i) {
      ASSERT_TRUE(points.shows(i));
      ASSERT_EQ(points.color(i), 0xff000000u | holes[i].x);
      ASSERT_NEAR(points.inverse_z(i) / found[i].inverse_z, 1, 1e-4);
    }
    points.keep(camera, {});
    EXPECT_EQ(points.size(), holes.size());
  }
}

TEST(HolePoints, WhatNoHoleShowsIsForgotten) {
  Random random(7);
  HolePoints points;
  const bool included[] = {true, false};
  for (int i = 0; i < 30; ++i) {
    const Camera camera = eye_at({0.05 * i, 0, 0}, {0.05 * i, 0, -10});
    const std::vector<FramePixel> holes = random_pixels(random, 0.3f);
    points.show(camera, holes, included);
    std::vector<FoundInHole> found;
    for (std::size_t hole = 0; hole < holes.size(); ++hole)
      if (!points.shows(hole))
        found.push_back({holes[hole], 0.1f, 0xff0000ffu, std::uint32_t(random.below(2))});
    points.keep(camera, found);
    EXPECT_LE(points.size(), holes.size());
  }
  EXPECT_GT(points.size(), 0u);
  // Of an object that is drawn otherwise now.
  const bool nothing[] = {false, false};
  const Camera camera = eye_at({1.45, 0, 0}, {1.45, 0, -10});
  points.show(camera, random_pixels(random, 1), nothing);
  points.keep(camera, {});
  EXPECT_EQ(points.size(), 0u);
}

// Each frame sees the same points, 3 m and more away, from farther on.
TEST(HolePoints, PointsStayInTheirPixelsHoweverFarTheEyeGoes) {
  Random random(8);
  const bool included[] = {true};
  HolePoints points;
  std::vector<FramePixel> all = random_pixels(random, 1);
  int shown = 0;
  for (int i = 0; i < 200; ++i) {
    const glm::dvec3 eye(100.0 * i, 0, 0);
    const Camera camera = eye_at(eye, eye + glm::dvec3(0, 0, -10));
    std::vector<FoundInHole> found;
    for (const FramePixel pixel : all)
      found.push_back(
          {pixel, 1 / 3.0f, 0xff000000u | std::uint32_t(pixel.y * kColumns + pixel.x), 0});
    points.keep(camera, found);
    // Three tenths of a pixel on.
    const double pixel = 3 * (camera.window.right - camera.window.left) / kColumns;
    const glm::dvec3 on = eye + glm::dvec3(0.3 * pixel, 0, 0);
    points.show(eye_at(on, on + glm::dvec3(0, 0, -10)), all, included);
    for (std::size_t hole = 0; hole < all.size(); ++hole) {
      ASSERT_TRUE(points.shows(hole)) << i;
      ASSERT_EQ(points.color(hole) & 0xffffffu, std::uint32_t(hole)) << i;
      ++shown;
    }
  }
  EXPECT_EQ(shown, 200 * kColumns * kRows);
}

}  // namespace
}  // namespace rilievo
