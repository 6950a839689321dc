// Whoever captures their pictures, nodes show the same.
#include <gtest/gtest.h>

#include "rilievo/capture/gl/opengl_source.h"
#include "rilievo/capture/ray_source.h"
#include "rilievo/environment_nodes/bake_nodes_test_helpers.h"
#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

class BakeSources : public gl::ContextTest {};

TEST_F(BakeSources, nodes_of_rays_are_those_of_OpenGL) {
  for (const char* name :
       {"builtin:stonehenge?triangles=20000", "builtin:bridge?triangles=100000"}) {
    SCOPED_TRACE(name);
    const auto built = make_builtin(name);
    ASSERT_TRUE(built);
    auto renderer = SceneRenderer::create(built->scene);
    ASSERT_TRUE(renderer);
    const auto rays = RayScene::create(built->scene);
    ASSERT_TRUE(rays);
    OpenGLSource opengl(*renderer);
    RaySource by_rays(*rays);
    std::vector<Camera> cameras;
    const std::vector<glm::dvec3> places = test_baked_nodes::places(opengl);
    for (int step = 0; step < 5; ++step)
      cameras.push_back(
          test_baked_nodes::camera_at(glm::mix(places[0], places[1], 0.2 * step), step));
    test_baked_nodes::expect_alike(test_baked_nodes::bake(opengl), test_baked_nodes::bake(by_rays),
                                   built->scene, cameras);
  }
}

}  // namespace
}  // namespace rilievo
