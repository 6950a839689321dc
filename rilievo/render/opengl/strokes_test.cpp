// Points and lines by OpenGL, against their definition.
#include <gtest/gtest.h>

#include <cmath>
#include <numeric>

#include "rilievo/gl/context.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/render/opengl/frame_target.h"
#include "rilievo/render/opengl/scene_renderer.h"
#include "rilievo/render/raster/whole_frames_test_helpers.h"
#include "rilievo/render/strokes_test_helpers.h"

namespace rilievo {
namespace {

// OpenGL rounds corners to 1/256 of a pixel, but the corners of what is drawn lie outside of the
// discs and strips.
constexpr double kRoundingPx = 0.01;

TEST(StrokesByOpenGl, cover_the_pixels_that_they_should) {
  auto context = gl::Context::create();
  ASSERT_TRUE(context.ok()) << context.error().message();
  const Scene scene = random_strokes(3, 90);
  auto renderer = SceneRenderer::create(scene);
  ASSERT_TRUE(renderer.ok()) << renderer.error().message();
  std::vector<std::uint32_t> all(scene.objects.size());
  std::iota(all.begin(), all.end(), 0u);
  Random random(5);
  int shown = 0;
  for (const Projection projection :
       {Projection::perspective, Projection::parallel, Projection::back_perspective})
    for (int i = 0; i < 4; ++i) {
      const Camera camera = stroke_camera(random, projection, 61, 47);
      auto target = ProbeTarget::create(camera.width, camera.height);
      ASSERT_TRUE(target.ok());
      target->begin(camera.keeps_farthest());
      renderer->draw_objects(camera, all);
      const Image<std::uint32_t> objects = target->read_objects();
      const Image<float> eye_z = target->read_eye_z(camera);
      for (int y = 0; y < camera.height; ++y)
        for (int x = 0; x < camera.width; ++x) {
          const StrokeSeen seen = stroke_at_raster(scene, camera, {x + 0.5, y + 0.5}, kRoundingPx);
          if (seen.doubtful) continue;
          ASSERT_EQ(objects(x, y), seen.object) << int(projection) << " " << x << " " << y;
          if (seen.object == kNoObject) continue;
          ++shown;
          ASSERT_NEAR(double(eye_z(x, y)), seen.eye_z, 1e-3 * seen.eye_z);
        }
    }
  EXPECT_GT(shown, 3000);
}

TEST(StrokesByOpenGl, frames_are_those_of_the_rasteriser) {
  auto context = gl::Context::create();
  ASSERT_TRUE(context.ok()) << context.error().message();
  Scene scene = random_strokes(9, 120);
  scene.meshes[0].normals = {{0, 0.6f, 0.8f}, {0, 1, 0}};  // some are lit
  auto renderer = SceneRenderer::create(scene);
  ASSERT_TRUE(renderer.ok()) << renderer.error().message();
  RasterFrames raster(scene);
  std::vector<std::uint32_t> all(scene.objects.size());
  std::iota(all.begin(), all.end(), 0u);
  Random random(1);
  for (int i = 0; i < 4; ++i) {
    const Camera camera = stroke_camera(random, Projection::perspective, 120, 90);
    auto target = FrameTarget::create(camera.width, camera.height, 4);
    ASSERT_TRUE(target.ok());
    target->begin();
    renderer->draw_opaque(camera, all, OutputEncoding::srgb);
    target->resolve();
    const Rgba8Image frame = target->read();
    RasterPicture picture;
    ASSERT_TRUE(raster.draw(camera, 4, picture).ok());
    Rgba8Image other(camera.width, camera.height);
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x)
        other(x, camera.height - 1 - y) =
            picture.color[std::size_t(y) * std::size_t(camera.width) + std::size_t(x)];
    // Drivers round the corners of discs to 1/256 of a pixel: samples on edges fall to either side.
    EXPECT_GT(psnr_db(frame, other), 40) << i;
  }
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

}  // namespace
}  // namespace rilievo
