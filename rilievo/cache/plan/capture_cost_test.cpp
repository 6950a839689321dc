#include "rilievo/cache/plan/capture_cost.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "rilievo/cache/plan/eye_motion.h"

namespace rilievo {
namespace {

struct CostScene {
  FrameView view;
  Box box;
};

CostScene random_scene(std::mt19937& rng) {
  std::uniform_real_distribution<double> u(0, 1);
  CostScene s;
  const double size = std::pow(10.0, 2 * u(rng) - 0.5), distance = size * (1.5 + 30 * u(rng));
  const glm::dvec3 center = distance * glm::dvec3(1.6 * u(rng) - 0.8, 0.8 * u(rng) - 0.4, -1);
  const glm::dvec3 half = 0.5 * size * glm::dvec3(0.2 + u(rng), 0.2 + u(rng), 0.2 + u(rng));
  s.box.add(glm::vec3(center - half)), s.box.add(glm::vec3(center + half));
  s.view.camera = look_at({0, 0, 0}, {0.1 * u(rng), -0.1, -1}, {0, 1, 0}, 0.6 + 0.6 * u(rng), 1280,
                          720, 0.1, 1e5);
  const glm::dvec3 way(u(rng) - 0.5, 0.3 * (u(rng) - 0.5), u(rng) - 0.7);
  s.view.velocity = distance * std::pow(10.0, -5 + 2.5 * u(rng)) * glm::normalize(way);
  return s;
}

TEST(Estimate, a_placed_picture_is_good_now_and_lives_about_as_long_as_expected) {
  std::mt19937 rng(1);
  std::vector<double> shares;
  int placed_ahead = 0;
  CacheOptions options;
  options.max_texels = 4096;
  for (int i = 0; i < 3000; ++i) {
    const CostScene s = random_scene(rng);
    const ViewAxes axes = view_axes(s.view, 10);
    const CaptureCost e = estimate_capture_cost(axes, s.box, 1000, s.view.velocity, options);
    if (!e.possible || !may_see(axes.now, s.box)) continue;
    const PlacedPicture placed = place_picture(axes, s.box, e, s.view.velocity, 1, options);
    ASSERT_TRUE(placed.good) << i;
    ASSERT_LE(bound_total_px(placed.geometry, s.view.camera), options.error_px);
    placed_ahead += placed.geometry.capture.position() != s.view.camera.position();
    const double expected = (1 + kAnticipation) * e.life;
    if (expected >= 600) continue;  // cut short: nobody walks straight on for ever
    // How long it does live: the frames until the bound passes, looked for one by one.
    double lived = 0;
    while (lived < 4 * expected) {
      const Camera later = camera_ahead(s.view, lived);
      const PictureError error = bound_error(placed.geometry, later);
      if (!error.in_frame || error.total_px > options.error_px) break;
      lived += std::max(1.0, expected / 100);
    }
    // What leaves the view in the middle of its life has no life to compare.
    if (bound_error(placed.geometry, camera_ahead(s.view, lived)).in_frame)
      shares.push_back(lived / expected);
  }
  ASSERT_GT(shares.size(), 500u);
  EXPECT_GT(placed_ahead, 1500);
  std::sort(shares.begin(), shares.end());
  // An estimate: to first order, and for the part of the picture that is in view at first.
  EXPECT_NEAR(shares[shares.size() / 2], 1, 0.25);
  EXPECT_GT(shares[shares.size() / 10], 0.4);
  EXPECT_LT(shares[shares.size() * 9 / 10], 2.5);
}

TEST(Estimate, anticipation_nearly_doubles_a_life) {
  std::mt19937 rng(2);
  for (int i = 0; i < 200; ++i) {
    CostScene s = random_scene(rng);
    s.view.velocity = {0.001 * glm::length(glm::dvec3(s.box.center())), 0, 0};
    const auto life = [&](bool ahead) {
      CacheOptions options;
      options.max_texels = 4096;
      const ViewAxes axes = view_axes(s.view, 10);
      CaptureCost e = estimate_capture_cost(axes, s.box, 1000, s.view.velocity, options);
      if (!ahead) e.ahead = 0;
      if (!e.possible || e.life < 10 || !may_see(axes.now, s.box)) return 0.0;
      const PlacedPicture placed = place_picture(axes, s.box, e, s.view.velocity, 1, options);
      double lived = 0;
      while (lived < 600 &&
             bound_total_px(placed.geometry, camera_ahead(s.view, lived)) <= options.error_px)
        lived += 0.1;
      return lived;
    };
    const double without = life(false), with = life(true);
    if (without > 0 && with > 0 && with < 300) {
      EXPECT_GT(with, 1.5 * without) << i;
    }
  }
}

TEST(Estimate, may_see_misses_nothing_and_covered_pixels_are_those_of_the_corners) {
  std::mt19937 rng(3);
  std::uniform_real_distribution<double> u(0, 1);
  int unseen = 0;
  for (int i = 0; i < 3000; ++i) {
    CostScene s = random_scene(rng);
    const double turn = 6.3 * u(rng);
    s.view.camera.world_from_eye =
        glm::rotate(glm::dmat4(1), turn, glm::dvec3(0, 1, 0)) * s.view.camera.world_from_eye;
    const ViewAxes axes = view_axes(s.view, 0);
    bool seen = false, all_inside = true;
    glm::dvec2 low(1e9), high(-1e9);
    for (int k = 0; k < 125; ++k) {
      const glm::vec3 share(float(k % 5) / 4, float(k / 5 % 5) / 4, float(k / 25) / 4);
      const glm::dvec3 at =
          raster_from_world(s.view.camera, glm::dvec3(s.box.min + share * s.box.extent()));
      const bool inside = at.z >= 0.1 && at.x >= 0 && at.x <= 1280 && at.y >= 0 && at.y <= 720;
      seen |= inside, all_inside &= inside;
      low = glm::min(low, glm::dvec2(at)), high = glm::max(high, glm::dvec2(at));
    }
    if (seen) {
      EXPECT_TRUE(may_see(axes.now, s.box));
    }
    unseen += !may_see(axes.now, s.box);
    if (all_inside) {
      // 1e-3 of it: the box's corners are floats.
      EXPECT_NEAR(covered_pixels(axes, s.box) / ((high.x - low.x) * (high.y - low.y)), 1, 1e-3);
    }
  }
  EXPECT_GT(unseen, 1000);
}

TEST(EyeMotion, goes_on_as_it_went_and_ignores_jumps) {
  EyeMotion motion;
  const glm::dvec3 step(0.01, 0, -0.02);
  const auto camera = [&](double t, double jump) {
    const double a = 0.01 * t;
    return look_at(step * t + glm::dvec3(jump, 0, 0),
                   step * t + glm::dvec3(jump + std::sin(a), 0, -std::cos(a)), {0, 1, 0}, 1, 64, 64,
                   0.1, 10);
  };
  EXPECT_EQ(follow(motion, camera(0, 0)).velocity, glm::dvec3(0));
  for (int f = 1; f < 20; ++f) {
    const FrameView view = follow(motion, camera(f, f < 10 ? 0 : 25));
    if (f == 10) {
      EXPECT_LE(glm::length(view.velocity), glm::length(step) * (1 + 1e-9));
    } else {
      EXPECT_LT(glm::length(view.velocity - step), 1e-9);
      // Three frames ahead, if nothing changes, is where it will be.
      const Camera there = camera(f + 3, f < 10 ? 0 : 25), ahead = camera_ahead(view, 3);
      for (int c = 0; c < 4; ++c)
        EXPECT_LT(glm::length(there.world_from_eye[c] - ahead.world_from_eye[c]), 1e-9);
    }
  }
}

TEST(EyeMotion, of_an_eye_that_stands_and_turns_is_its_turn_and_no_jerk) {
  EyeMotion motion;
  const double angles[] = {0, 0.01, 0.02, 0.5, 0.51};
  for (int f = 0; f < 5; ++f) {
    const glm::dvec3 to(std::sin(angles[f]), 0, -std::cos(angles[f]));
    const FrameView view = follow(motion, look_at({}, to, {0, 1, 0}, 1, 64, 64, 0.1, 10));
    EXPECT_EQ(view.velocity, glm::dvec3(0));
    EXPECT_NEAR(glm::length(view.turn), f == 0 ? 0 : 0.01, 1e-9) << f;
  }
}

}  // namespace
}  // namespace rilievo
