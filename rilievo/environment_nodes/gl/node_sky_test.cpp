// The sky that nodes saw, in frames of both backends.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <limits>

#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/core/color.h"
#include "rilievo/environment_nodes/environment_drawable.h"
#include "rilievo/environment_nodes/environment_kind.h"
#include "rilievo/environment_nodes/gl/node_textures.h"
#include "rilievo/environment_nodes/node_test_helpers.h"
#include "rilievo/environment_nodes/software/node_tiles.h"
#include "rilievo/frame/gl/opengl_sources_test_helpers.h"
#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/method/test_source_test_helpers.h"
#include "rilievo/render/opengl/frame_target.h"

namespace rilievo {
namespace {

class NodeSky : public gl::ContextTest {
 protected:
  void TearDown() override { EXPECT_TRUE(gl::check_errors("sky of nodes").ok()); }
};

const Sky kSeen{{0.1f, 0.2f, 0.7f}, {0.9f, 0.7f, 0.5f}, {0.3f, 0.2f, 0.1f}};

// A node that sees the sky where x > 0, and nothing elsewhere.
EnvironmentNodes half_a_sky() {
  const double nowhere = std::numeric_limits<double>::infinity();
  EnvironmentMap map = make_node(
      48, [=](const glm::dvec3&) { return nowhere; },
      [](const glm::dvec3& d, double) {
        if (d.x < 0) return glm::vec4(0);
        const glm::dvec3 shares = sky_shares(glm::normalize(d).y);
        return glm::vec4(float(shares.x) * kSeen.zenith + float(shares.y) * kSeen.horizon +
                             float(shares.z) * kSeen.ground,
                         1.0f);
      });
  return *make_environment_nodes({map.faces.begin(), map.faces.end()}, {});
}

std::unique_ptr<Drawable> drawable_of(DrawableFactory& factory) {
  auto made = factory.make_drawable(std::make_unique<EnvironmentRepresentation>(half_a_sky()),
                                    OptionValues(environment_nodes_kind().draw_options));
  EXPECT_TRUE(made.ok());
  return *std::move(made);
}

// The largest difference of a byte from a sky, over a frame that looks to where nothing was seen.
int off(const Rgba8Image& frame, const Camera& camera, const Sky& sky) {
  int most = 0;
  for (int y = 0; y < frame.height(); ++y)
    for (int x = 0; x < frame.width(); ++x) {
      const glm::dvec3 at = world_from_raster(camera, {x + 0.5, y + 0.5}, 1.0);
      const glm::dvec3 shares = sky_shares(glm::normalize(at - camera.position()).y);
      const glm::vec3 color = float(shares.x) * sky.zenith + float(shares.y) * sky.horizon +
                              float(shares.z) * sky.ground;
      for (int c = 0; c < 3; ++c)
        most = std::max(most, std::abs(int(frame(x, y)[c]) -
                                       int(std::lround(255 * srgb_from_linear(color[c])))));
    }
  return most;
}

TEST_F(NodeSky, is_seen_where_no_node_saw_anything_unless_a_scene_has_its_own) {
  const Camera camera = look_at({0, 0, 0}, {-1, 0.3, 0.2}, {0, 1, 0}, 0.9, 64, 48, 0.1, 100);
  Scene empty, scene;
  scene.sky.zenith = {1, 0, 0};
  test_shapes::add(scene, test_shapes::sphere(0.2), {0.8f, 0.5f, 0.2f},
                   glm::translate(glm::mat4(1), {50, 0, 0}));
  finish(scene);
  for (const Scene* behind : {&empty, &scene}) {
    const Sky& expected = behind == &empty ? kSeen : scene.sky;
    auto tiles = make_environment_tiles_factory();
    ASSERT_TRUE(tiles.ok());
    TestSource software = software_stored(*behind, 4, drawable_of(**tiles), {Instance{}}, false);
    ASSERT_TRUE(software.draw(camera, 0).ok());
    // The fit's prior pulls it towards the mean by about a hundredth: 3 of 255.
    EXPECT_LE(off(software.software_target()->color(), camera, expected), 4);

    auto renderer = SceneRenderer::create(*behind);
    ASSERT_TRUE(renderer.ok());
    auto factory = make_environment_drawable_factory();
    ASSERT_TRUE(factory.ok());
    OpenGLFrames frames = opengl_stored(*renderer, drawable_of(**factory), {Instance{}}, false);
    auto target = FrameTarget::create(camera.width, camera.height, 4);
    ASSERT_TRUE(target.ok());
    target->begin();
    ASSERT_TRUE(frames.draw(camera, 0).ok());
    target->resolve();
    EXPECT_LE(off(target->read(), camera, expected), 4);
  }
}

}  // namespace
}  // namespace rilievo
