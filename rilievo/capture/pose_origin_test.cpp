#include "rilievo/capture/pose_origin.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>
#include <vector>

namespace rilievo {
namespace {

TEST(PoseOrigin, cameras_near_0_stay_and_others_come_near) {
  for (const glm::dvec3& at :
       {glm::dvec3(0), glm::dvec3(40, 1, -20), glm::dvec3(4.7e5, 412, -5.4e6)})
    for (const int count : {1, 5, 200}) {
      std::vector<glm::dmat4> before, poses;
      for (int i = 0; i < count; ++i)
        before.push_back(glm::translate(glm::dmat4(1.0), at + glm::dvec3(0.5 * i, 1.5, -0.1 * i)));
      poses = before;
      std::vector<glm::dmat4*> pointers;
      for (glm::dmat4& pose : poses) pointers.push_back(&pose);
      const WorldSpace world = take_origin_off(pointers);
      EXPECT_EQ(world.origin == glm::dvec3(0), glm::length(at) < 1000);
      for (int i = 0; i < count; ++i) {
        // Doubles have steps of 1e-9 there.
        EXPECT_LT(glm::distance(glm::dvec3(poses[std::size_t(i)][3]) + world.origin,
                                glm::dvec3(before[std::size_t(i)][3])),
                  1e-8);
        // What stays where it is lies near 0 anyway.
        EXPECT_LT(glm::length(glm::dvec3(poses[std::size_t(i)][3])), 150);
      }
    }
}

}  // namespace
}  // namespace rilievo
