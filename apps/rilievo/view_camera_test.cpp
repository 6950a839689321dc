#include "apps/rilievo/view_camera.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rilievo::app {
namespace {

// Angles and directions in doubles, a few operations each.
constexpr double kRounding = 1e-9;

struct Random {
  std::mt19937 engine{1};
  std::uniform_real_distribution<double> unit{-1, 1};
  double operator()() { return unit(engine); }
  glm::dvec3 vector() { return {(*this)(), (*this)(), (*this)()}; }
};

TEST(view_camera, a_camera_gives_its_pose_back) {
  Random random;
  for (int i = 0; i < 1000; ++i) {
    const ViewPose pose{10.0 * random.vector(), 3.1 * random(), 1.5 * random()};
    const Camera camera =
        look_at(pose.eye, pose.eye + forward_of(pose), {0, 1, 0}, 0.9, 16, 9, 0.1, 10);
    const ViewPose back = pose_of(camera, pose.world_from_upright);
    EXPECT_NEAR(glm::distance(back.eye, pose.eye), 0, kRounding);
    EXPECT_NEAR(back.yaw, pose.yaw, 1e-6);  // near the poles yaw is ill-conditioned
    EXPECT_NEAR(back.pitch, pose.pitch, 1e-6);
  }
}

TEST(view_camera, turning_up_stops_short_of_the_pole) {
  ViewPose pose;
  turn(pose, 0, 100);
  EXPECT_GT(forward_of(pose).y, 0.99);
  EXPECT_GT(std::hypot(forward_of(pose).x, forward_of(pose).z), 0.01);
  turn(pose, 0, -200);
  EXPECT_LT(forward_of(pose).y, -0.99);
  EXPECT_GT(std::hypot(forward_of(pose).x, forward_of(pose).z), 0.01);
}

TEST(view_camera, turning_left_shows_what_was_left) {
  ViewPose pose;  // looks along -z: left is -x
  turn(pose, 0.1, 0);
  EXPECT_LT(forward_of(pose).x, 0);
}

TEST(view_camera, flying_right_is_across_the_gaze) {
  Random random;
  for (int i = 0; i < 1000; ++i) {
    ViewPose pose{random.vector(), 3 * random(), 1.5 * random()};
    const ViewPose before = pose;
    fly(pose, {1, 0, 0});
    const glm::dvec3 way = pose.eye - before.eye;
    EXPECT_NEAR(glm::length(way), 1, kRounding);
    EXPECT_NEAR(glm::dot(way, forward_of(pose)), 0, kRounding);
    EXPECT_GT(glm::dot(glm::cross(forward_of(pose), {0, 1, 0}), way), 0);
    fly(pose, {-1, 0, 2});
    EXPECT_NEAR(glm::distance(pose.eye, before.eye + 2.0 * forward_of(before)), 0, kRounding);
  }
}

TEST(view_camera, circling_keeps_the_distance_and_looks_at_the_center) {
  Random random;
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 center = random.vector();
    ViewPose pose{center + 10.0 * random.vector(), 3 * random(), random()};
    const double distance = glm::distance(pose.eye, center), closer = random();
    circle(pose, center, random(), 0.3 * random(), closer);
    EXPECT_NEAR(glm::distance(pose.eye, center), distance * std::exp(-closer),
                kRounding * distance);
    EXPECT_NEAR(glm::dot(glm::normalize(center - pose.eye), forward_of(pose)), 1, kRounding);
  }
}

TEST(view_camera, upright_is_whatever_was_told) {
  Random random;
  EXPECT_EQ(upright_axes({0, 1, 0}), glm::dmat3(1));
  for (int i = 0; i < 1000; ++i) {
    const glm::dmat3 axes = upright_axes(glm::normalize(random.vector()));
    EXPECT_NEAR(glm::determinant(axes), 1, kRounding);
    ViewPose pose{random.vector(), 3 * random(), 1.4 * random(), axes};
    const Camera camera =
        look_at(pose.eye, pose.eye + forward_of(pose), up_of(pose), 0.9, 16, 9, 0.1, 10);
    const ViewPose back = pose_of(camera, axes);
    EXPECT_NEAR(glm::distance(forward_of(back), forward_of(pose)), 0, kRounding);
    // Turning to the side keeps the height of the gaze; flying up goes up.
    const double height = glm::dot(forward_of(pose), up_of(pose));
    turn(pose, random(), 0);
    EXPECT_NEAR(glm::dot(forward_of(pose), up_of(pose)), height, kRounding);
    const glm::dvec3 before = pose.eye;
    fly(pose, {0, 2, 0});
    EXPECT_NEAR(glm::distance(pose.eye, before + 2.0 * up_of(pose)), 0, kRounding);
  }
}

TEST(view_camera, circling_from_the_center_itself_steps_back) {
  ViewPose pose;
  circle(pose, {0, 0, 0}, 0.1, 0.1, 0);
  EXPECT_TRUE(std::isfinite(pose.eye.x + pose.eye.y + pose.eye.z + pose.yaw + pose.pitch));
  EXPECT_GT(glm::length(pose.eye), 0);
}

}  // namespace
}  // namespace rilievo::app
