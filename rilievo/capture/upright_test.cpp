#include "rilievo/capture/upright.h"

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/constants.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <random>
#include <vector>

#include "rilievo/capture/shapes_test_helpers.h"

namespace rilievo {
namespace {

using test_shapes::random_direction;

constexpr double kDegree = glm::pi<double>() / 180;

// Axes of a camera in a world with +y up. Radians.
Camera held(double azimuth, double nod, double roll) {
  Camera camera;
  glm::dmat4 m = glm::rotate(glm::dmat4(1), azimuth, {0, 1, 0});
  m = glm::rotate(m, nod, {1, 0, 0});
  camera.world_from_eye = glm::rotate(m, roll, {0, 0, 1});
  return camera;
}

// The same in another world; where +y went.
glm::dvec3 turn_world(std::vector<Camera>& cameras, std::mt19937& rng) {
  const glm::dmat4 turn = glm::rotate(glm::dmat4(1), std::uniform_real_distribution<>(-3, 3)(rng),
                                      random_direction(rng));
  for (Camera& camera : cameras) camera.world_from_eye = turn * camera.world_from_eye;
  return glm::dvec3(turn[1]);
}

double off_degrees(const glm::dvec3& a, const glm::dvec3& b) {
  return std::atan2(glm::length(glm::cross(a, b)), glm::dot(a, b)) / kDegree;
}

TEST(Upright, level_cameras_tell_it_exactly_in_any_world) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> u(-1, 1);
  for (int i = 0; i < 50; ++i) {
    std::vector<Camera> cameras;
    for (int k = 0; k <= i; ++k) cameras.push_back(held(3 * u(rng), 0, 0));
    const glm::dvec3 up = turn_world(cameras, rng);
    const glm::dvec3 found = estimate_up(cameras);
    EXPECT_NEAR(glm::length(found), 1, 1e-12);
    // Where all look alike the smallest eigenvalue is 0 still, and found by iteration.
    EXPECT_LT(off_degrees(found, up), 1e-5);
  }
}

TEST(Upright, one_camera_has_only_itself_to_say) {
  std::mt19937 rng(2);
  std::vector<Camera> cameras{held(0.3, 0.4, 0.2)};
  turn_world(cameras, rng);
  EXPECT_LT(off_degrees(estimate_up(cameras), glm::dvec3(cameras[0].world_from_eye[1])), 1e-5);
  EXPECT_EQ(estimate_up({}), glm::dvec3(0, 1, 0));
}

TEST(Upright, a_capture_that_turns_around_is_told_in_spite_of_nods_and_rolls) {
  std::mt19937 rng(3);
  std::normal_distribution<double> n;
  std::uniform_real_distribution<double> u(-1, 1);
  for (int i = 0; i < 40; ++i) {
    std::vector<Camera> cameras;
    // All look down, by 20 degrees in the mean: the y axes alone would be as far off if the
    // cameras did not turn.
    for (int k = 0; k < 40; ++k)
      cameras.push_back(held(3.1 * u(rng), (-20 + 12 * n(rng)) * kDegree, 2 * n(rng) * kDegree));
    const glm::dvec3 up = turn_world(cameras, rng);
    // 2 degrees of roll over 40 cameras: 0.45 along each of two axes.
    EXPECT_LT(off_degrees(estimate_up(cameras), up), 2.0);
  }
}

TEST(Upright, a_few_cameras_that_look_one_way_are_off_by_less_than_they_nod) {
  std::mt19937 rng(4);
  std::normal_distribution<double> n;
  for (int i = 0; i < 40; ++i) {
    std::vector<Camera> cameras;
    for (int k = 0; k < 8; ++k)
      cameras.push_back(held((k - 4) * 5 * kDegree, -25 * kDegree, n(rng) * kDegree));
    const glm::dvec3 up = turn_world(cameras, rng);
    EXPECT_LT(off_degrees(estimate_up(cameras), up), 24.0);
  }
}

TEST(Upright, cameras_held_sideways_or_upside_down_count_for_nothing) {
  std::mt19937 rng(5);
  std::normal_distribution<double> n;
  std::uniform_real_distribution<double> u(-1, 1);
  for (int i = 0; i < 40; ++i) {
    std::vector<Camera> cameras;
    for (int k = 0; k < 40; ++k) {
      const double roll = k % 5 == 0 ? glm::pi<double>() / 2 : k % 5 == 1 ? glm::pi<double>() : 0;
      cameras.push_back(held(3.1 * u(rng), 12 * n(rng) * kDegree, roll + 2 * n(rng) * kDegree));
    }
    const glm::dvec3 up = turn_world(cameras, rng);
    // As without them, of which 24 are left.
    EXPECT_LT(off_degrees(estimate_up(cameras), up), 3.0);
  }
}

TEST(Upright, who_looks_straight_down_gets_an_answer_but_no_gaze) {
  DepthImage picture;
  picture.camera = look_at({0, 5, 0}, {0, 0, 0}, {0, 0, 1}, 0.8, 16, 16, 1, 20);
  picture.color = ColorImage(16, 16, glm::vec4(1));
  picture.depth = Image<float>(16, 16, 5.0f);
  std::vector<DepthImage> pictures;
  for (int i = 0; i < 12; ++i) {
    pictures.push_back(picture);
    pictures.back().camera.world_from_eye =
        glm::rotate(glm::dmat4(1), 0.5 * i, {0, 1, 0}) * picture.camera.world_from_eye;
  }
  Box box;
  box.add(glm::vec3(-9)), box.add(glm::vec3(9));
  const Vantage vantage = estimate_vantage(pictures, box);
  EXPECT_NEAR(glm::length(vantage.up), 1, 1e-12);
  if (vantage.gaze) {
    EXPECT_GT(glm::length(
                  glm::cross(glm::normalize(vantage.gaze->target - vantage.gaze->eye), vantage.up)),
              0.05);
  }
}

TEST(Upright, the_gaze_is_that_of_the_photograph_in_the_middle) {
  std::vector<DepthImage> pictures;
  for (int i = 0; i < 5; ++i) {
    DepthImage picture;
    const double a = 0.2 * i;
    picture.camera = look_at({std::sin(a), 1, std::cos(a)}, {9 * std::sin(a), 0.5, 9 * std::cos(a)},
                             {0, 1, 0}, 0.8, 32, 32, 0.1, 20);
    picture.color = ColorImage(32, 32, glm::vec4(1));
    picture.depth = Image<float>(32, 32, 3.0f);
    pictures.push_back(std::move(picture));
  }
  Box box;
  box.add(glm::vec3(-20)), box.add(glm::vec3(20));
  const Vantage vantage = estimate_vantage(pictures, box);
  ASSERT_TRUE(vantage.gaze);
  const Camera& middle = pictures[2].camera;
  EXPECT_EQ(vantage.gaze->eye, middle.position());
  EXPECT_LT(glm::distance(vantage.gaze->target, middle.position() + 3.0 * middle.forward()), 1e-6);
  // Where no photograph saw anything, none is in the middle.
  Box elsewhere;
  elsewhere.add(glm::vec3(100)), elsewhere.add(glm::vec3(101));
  EXPECT_FALSE(estimate_vantage(pictures, elsewhere).gaze);
}

}  // namespace
}  // namespace rilievo
