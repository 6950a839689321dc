#include "rilievo/layered_relief/hits_on_faces.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/core/random.h"
#include "rilievo/core/sanitized_test_helpers.h"
#include "rilievo/layered_relief/relief_pictures.h"

namespace rilievo {
namespace {

std::vector<Camera> cameras_around(int count, const Box& box, int size) {
  std::vector<Camera> cameras;
  const auto directions = relief_directions(count);
  for (const glm::dvec3& direction : *directions)
    cameras.push_back(*relief_camera(box, direction, size));
  return cameras;
}

TEST(HitsOnFaces, six_axes_hit_each_face_within_0_87_texels_and_one_axis_does_not) {
  const Box cube{glm::vec3(-1), glm::vec3(1)};
  const double texel = 2.0 / 64, six = farthest_from_hits(cameras_around(6, cube, 64));
  // A face across two axes, seen along one of them: a lattice of 1 by sqrt(2).
  EXPECT_GE(six, 0.5 * std::sqrt(3.0) * texel);
  EXPECT_LE(six, 0.5 * std::sqrt(3.0) * texel * 1.03);
  EXPECT_TRUE(std::isinf(farthest_from_hits(cameras_around(2, cube, 64))));
  EXPECT_LT(farthest_from_hits(cameras_around(20, cube, 64)), six * 1.5);
}

// Against the hits themselves, around random points of random faces.
TEST(HitsOnFaces, no_point_of_a_face_is_farther_from_a_hit_than_claimed) {
  Random random(33);
  std::mt19937 rng(33);
  double tightest = 0;
  for (int i = 0; i < sanitized_cases(300); ++i) {
    const Box box{glm::vec3(0), glm::vec3(random.between(0.5f, 2), random.between(0.5f, 2), 1)};
    if (i % 30) continue;
    const std::vector<Camera> cameras = cameras_around(i % 60 ? 6 : 12, box, 40);
    const double claimed = farthest_from_hits(cameras);
    for (int k = 0; k < 6000; ++k) {
      const glm::dvec3 normal = test_shapes::random_direction(rng);
      const glm::dvec3 at(random.unit(), random.unit(), random.unit());
      double least = 1e9;
      for (const Camera& camera : cameras) {
        const double facing = glm::dot(camera.forward(), normal);
        if (std::abs(facing) < 0.2) continue;  // hits are five texels apart
        const glm::dvec2 raster(raster_from_world(camera, at));
        for (int y = -3; y <= 3; ++y)
          for (int x = -3; x <= 3; ++x) {
            const glm::dvec3 on_line =
                world_from_raster(camera, glm::floor(raster) + glm::dvec2(x + 0.5, y + 0.5), 1.0);
            const glm::dvec3 hit =
                on_line + camera.forward() * (glm::dot(at - on_line, normal) / facing);
            least = std::min(least, glm::distance(at, hit));
          }
      }
      ASSERT_LE(least, claimed);
      tightest = std::max(tightest, least / claimed);
    }
  }
  EXPECT_GT(tightest, kSanitized ? 0.7 : 0.8);  // of fewer cases
}

}  // namespace
}  // namespace rilievo
