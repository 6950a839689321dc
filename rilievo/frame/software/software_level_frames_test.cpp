
#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/method/levels.h"
#include "rilievo/method/test_source_test_helpers.h"
#include "rilievo/scene/mesh_tools.h"

namespace rilievo {
namespace {

// Balls, near and far, before a box.
Scene balls() {
  Scene scene;
  test_shapes::add(scene, test_shapes::sphere(0.8), {0.8f, 0.5f, 0.2f});
  test_shapes::add(scene, test_shapes::sphere(0.8), {0.3f, 0.7f, 0.2f},
                   glm::translate(glm::mat4(1), {3, 0, -12}));
  test_shapes::add(scene, test_shapes::box({1.5f, 0.5f, 0.5f}), {0.3f, 0.4f, 0.8f},
                   glm::translate(glm::mat4(1), {0.7f, 0, -3}));
  for (Mesh& mesh : scene.meshes) make_flat(mesh);
  finish(scene);
  return scene;
}

std::unique_ptr<FrameSource> software_levels(const Scene& scene, int samples, double error_px) {
  return std::move(
      *make_level_frames(SoftwareBackend(scene, samples), make_object_levels(scene), error_px));
}

struct SoftwareLevels : testing::Test {
  Scene scene = balls();
  std::vector<Camera> cameras;

  SoftwareLevels() {
    for (const double x : {0.3, -2.0, 1.1})
      cameras.push_back(look_at({x, 0.5, 5 + 3 * x}, {0, 0, 0}, {0, 1, 0}, 0.8, 96, 64, 0.1, 50));
  }
};

TEST_F(SoftwareLevels, without_an_error_are_the_frames_of_all_triangles) {
  for (const int samples : {1, 4}) {
    TestSource direct = software_direct(scene, samples);
    const auto exact = software_levels(scene, samples, 0);
    for (const Camera& camera : cameras) {
      ASSERT_TRUE(direct.draw(camera, 0).ok() && exact->draw(camera, 0).ok());
      EXPECT_EQ(exact->software_target()->color(), direct.software_target()->color());
      EXPECT_EQ(exact->stats().bound_px, 0.0);
      ASSERT_TRUE(direct.draw_objects().ok() && exact->draw_objects().ok());
      EXPECT_EQ(exact->software_target()->objects(), direct.software_target()->objects());
    }
  }
}

TEST_F(SoftwareLevels, with_an_error_are_coarser_by_no_more_than_that_and_forget_the_last_frame) {
  TestSource direct = software_direct(scene, 4);
  const auto coarse = software_levels(scene, 4, 4.0);
  for (const Camera& camera : cameras) {
    ASSERT_TRUE(direct.draw(camera, 0).ok() && coarse->draw(camera, 0).ok());
    EXPECT_FALSE(coarse->software_target()->color() == direct.software_target()->color());
    EXPECT_GT(coarse->stats().bound_px, 0.0);
    EXPECT_LE(coarse->stats().bound_px, 4.0);
    const auto fresh = software_levels(scene, 4, 4.0);
    ASSERT_TRUE(fresh->draw(camera, 0).ok());
    EXPECT_EQ(fresh->software_target()->color(), coarse->software_target()->color());
  }
}

}  // namespace
}  // namespace rilievo
