#include "rilievo/warp/relief_warp.h"

#include <gtest/gtest.h>

#include <random>

namespace rilievo {
namespace {

// Where the line from `eye` through `point` meets the plane of a and b, in units of a and b: by
// solving for it, with no formula of the warp.
glm::dvec2 on_plane(const ReliefFrame& frame, const glm::dvec3& eye, const glm::dvec3& point) {
  const glm::dmat3 basis(frame.a, frame.b, eye - point);
  const glm::dvec3 solved = glm::inverse(basis) * (eye - frame.origin);
  return {solved.x, solved.y};
}

TEST(ReliefWarp, samples_land_where_their_lines_of_sight_meet_the_plane) {
  std::mt19937 rng(1);
  std::uniform_real_distribution<double> unit(-1, 1);
  const auto direction = [&] { return glm::dvec3(unit(rng), unit(rng), unit(rng)); };
  int tried = 0;
  while (tried < 2000) {
    // Any basis, sheared and mirrored ones too.
    ReliefFrame frame{direction(), 0.1 * direction(), 0.1 * direction(),
                      glm::normalize(direction())};
    const glm::dvec3 across = glm::normalize(glm::cross(frame.a, frame.b));
    if (std::abs(glm::dot(across, frame.f)) < 0.2) continue;
    const glm::dvec3 eye = frame.origin - (1.5 + unit(rng)) * frame.f + 3.0 * frame.a * unit(rng) +
                           3.0 * frame.b * unit(rng);
    const auto warp = relief_warp(frame, eye);
    ASSERT_TRUE(warp);
    for (int i = 0; i < 10; ++i) {
      const double u = 20 * unit(rng), v = 20 * unit(rng), d = 0.4 * unit(rng);
      if (1 + warp->k3 * d < 0.05) continue;  // as good as in the eye's plane
      const glm::dvec2 expected = on_plane(frame, eye, frame.world(u, v, d));
      const glm::dvec2 moved = warp->moved(u, v, d);
      // Doubles; the basis may be thin.
      EXPECT_LT(glm::distance(expected, moved), 1e-7 * (1 + glm::length(expected)));
    }
    ++tried;
  }
}

TEST(ReliefWarp, signs_are_those_of_an_eye_in_front) {
  const ReliefFrame frame;  // right +x, down -y, deeper -z
  const auto warp = relief_warp(frame, {3, -2, 4});
  ASSERT_TRUE(warp);
  // Deeper things shrink, and move towards the eye's foot: right, and (y down) downwards.
  EXPECT_LT(warp->magnification(1), 1);
  EXPECT_GT(warp->magnification(-1), 1);
  EXPECT_GT(warp->k1, 0);
  EXPECT_GT(warp->k2, 0);
  EXPECT_DOUBLE_EQ(warp->k3, 0.25);
  EXPECT_NEAR(warp->epipole().x, 3, 1e-12);
  EXPECT_NEAR(warp->epipole().y, 2, 1e-12);
  // What lies at the epipole stays there at every depth; nothing moves at d = 0.
  EXPECT_LT(glm::distance(warp->moved(3, 2, 7), {3, 2}), 1e-12);
  EXPECT_LT(glm::distance(warp->moved(-5, 9, 0), {-5, 9}), 1e-12);
}

TEST(ReliefWarp, an_eye_on_the_plane_or_behind_it_has_none) {
  const ReliefFrame frame;
  EXPECT_FALSE(relief_warp(frame, {1, 2, 0}));
  EXPECT_FALSE(relief_warp(frame, {1, 2, -3}));
  ReliefFrame mirrored = frame;
  mirrored.a = -mirrored.a;
  EXPECT_TRUE(relief_warp(mirrored, {1, 2, 3}));
  EXPECT_FALSE(relief_warp(mirrored, {1, 2, -3}));
}

TEST(ReliefWarp, the_frame_is_the_cameras_raster) {
  Camera camera;
  camera.projection = Projection::parallel;
  camera.world_from_eye = {{0, 0, -1, 0}, {0, 1, 0, 0}, {1, 0, 0, 0}, {5, 6, 7, 1}};
  camera.window = {-1, 3, -2, 2};
  camera.width = 8;
  camera.height = 16;
  const ReliefFrame frame = relief_frame(camera, 4.0);
  for (const auto& [u, v, d] : {std::tuple(0.0, 0.0, 0.0), {3.5, 7.25, 1.5}, {8.0, 16.0, -2.0}})
    EXPECT_LT(glm::distance(frame.world(u, v, d), world_from_raster(camera, {u, v}, 4.0 + d)),
              1e-12);
}

}  // namespace
}  // namespace rilievo
