// Baselines against direct drawing by OpenGL.

#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>

#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/frame/gl/opengl_sources_test_helpers.h"
#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/method/levels.h"
#include "rilievo/method/method.h"
#include "rilievo/render/opengl/frame_target.h"
#include "rilievo/scene/mesh_tools.h"

namespace rilievo {
namespace {

constexpr int kFrameSize = 96;

// A ball before a box, and a pane that blends between them.
Scene scene_with_pane() {
  Scene scene;
  test_shapes::add(scene, test_shapes::sphere(0.8), {0.8f, 0.5f, 0.2f});
  test_shapes::add(scene, test_shapes::box({1.5f, 0.5f, 0.5f}), {0.3f, 0.4f, 0.8f},
                   glm::translate(glm::mat4(1), {0.7f, 0, -3}));
  test_shapes::add(scene, test_shapes::box({2.0f, 1.0f, 0.01f}), {0.2f, 0.9f, 0.3f},
                   glm::translate(glm::mat4(1), {0, 0, -1.5f}));
  // As files give them: OpenGL needs normals.
  for (Mesh& mesh : scene.meshes) make_flat(mesh);
  Material& pane = scene.materials[std::size_t(scene.meshes.back().material)];
  pane.alpha_mode = AlphaMode::blend;
  pane.base_color.a = 0.5f;
  finish(scene);
  return scene;
}

class BaselineTest : public gl::ContextTest {
 protected:
  struct Drawn {
    Rgba8Image color;
    Image<std::uint32_t> objects;
    Image<float> eye_z;
  };
  Drawn draw(FrameSource& source, int samples) {
    Result<FrameTarget> target = FrameTarget::create(kFrameSize, kFrameSize, samples);
    Result<ProbeTarget> probe = ProbeTarget::create(kFrameSize, kFrameSize);
    Drawn drawn;
    target->begin();
    const Result<> done = source.draw(camera_, 0);
    EXPECT_TRUE(done.ok()) << (done.ok() ? "" : done.error().message());
    target->resolve();
    drawn.color = target->read();
    probe->begin();
    EXPECT_TRUE(source.draw_objects().ok());
    drawn.objects = probe->read_objects();
    drawn.eye_z = probe->read_eye_z(camera_);
    return drawn;
  }

  Camera camera_ =
      look_at({0.3, 0.5, 5}, {0, 0, 0}, {0, 1, 0}, 0.8, kFrameSize, kFrameSize, 0.1, 50);
  Scene scene_ = scene_with_pane();
};

TEST_F(BaselineTest, processors_draw_the_frame_that_opengl_draws) {
  Result<SceneRenderer> renderer = SceneRenderer::create(scene_);
  ASSERT_TRUE(renderer.ok());
  OpenGLFrames direct = opengl_direct(*renderer);
  for (const bool rays : {false, true})
    for (const int samples : {1, 4}) {
      OpenGLBackend backend(*renderer, samples);
      auto frames = make_method(rays ? "direct-rays" : "direct-raster", {}, backend);
      ASSERT_TRUE(frames.ok());
      const Drawn truth = draw(direct, samples), drawn = draw(*frames->frames, samples);
      int other_color = 0, other_object = 0, shown = 0;
      for (int y = 0; y < kFrameSize; ++y)
        for (int x = 0; x < kFrameSize; ++x) {
          for (int k = 0; k < 3; ++k)
            if (std::abs(int(truth.color(x, y)[k]) - int(drawn.color(x, y)[k])) > 3) {
              ++other_color;
              break;
            }
          shown += truth.objects(x, y) != kNoObject;
          // Depths as far apart as floats of window_z are at five metres.
          other_object += truth.objects(x, y) != drawn.objects(x, y) ||
                          std::abs(truth.eye_z(x, y) - drawn.eye_z(x, y)) > 1e-2f;
        }
      // Samples on an edge, within rounding.
      EXPECT_LE(other_color, kFrameSize * kFrameSize / 200) << rays << ' ' << samples;
      EXPECT_LE(other_object, kFrameSize * kFrameSize / 500) << rays << ' ' << samples;
      EXPECT_GT(shown, kFrameSize * kFrameSize / 10);
    }
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

TEST_F(BaselineTest, levels_without_an_error_show_the_true_frame_and_with_one_fewer_triangles) {
  Result<SceneRenderer> renderer = SceneRenderer::create(scene_);
  ASSERT_TRUE(renderer.ok());
  OpenGLFrames direct = opengl_direct(*renderer);
  const Drawn truth = draw(direct, 4);
  const OpenGLBackend backend(*renderer, 4);
  const auto exact = make_level_frames(backend, make_object_levels(scene_), 0.0),
             coarse = make_level_frames(backend, make_object_levels(scene_), 4.0);
  ASSERT_TRUE(exact.ok() && coarse.ok());
  const Drawn same = draw(**exact, 4), other = draw(**coarse, 4);
  EXPECT_EQ(same.color, truth.color);
  EXPECT_EQ(same.objects, truth.objects);
  EXPECT_EQ((*exact)->stats().bound_px, 0.0);
  EXPECT_NE(other.color, truth.color);
  EXPECT_GT((*coarse)->stats().bound_px, 0.0);
  EXPECT_LE((*coarse)->stats().bound_px, 4.0);
}

}  // namespace
}  // namespace rilievo
