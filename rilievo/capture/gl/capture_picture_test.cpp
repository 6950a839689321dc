#include "rilievo/capture/gl/capture_picture.h"

#include <gtest/gtest.h>

#include "rilievo/gl/context.h"
#include "rilievo/render/rays/cast_picture.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

class CapturePictureTest : public testing::TestWithParam<Projection> {};

TEST_P(CapturePictureTest, agrees_with_one_ray_a_texel) {
  auto context = gl::Context::create();
  ASSERT_TRUE(context.ok()) << context.error().message();
  const auto builtin = make_builtin("builtin:teapot?triangles=5000");
  ASSERT_TRUE(builtin.ok());
  auto renderer = SceneRenderer::create(builtin->scene);
  ASSERT_TRUE(renderer.ok());
  const Box box = world_bounds(builtin->scene);
  const glm::dvec3 eye =
      glm::dvec3(box.center()) + glm::dvec3(1.5, 1.2, 2.0) * double(box.radius());
  Result<Camera> camera = tight_camera(GetParam(), eye, {0, 1, 0}, box);
  ASSERT_TRUE(camera.ok());
  camera->width = 120, camera->height = 90;

  const auto picture = capture_picture(*renderer, *camera);
  ASSERT_TRUE(picture.ok()) << picture.error().message();
  ASSERT_TRUE(validate(*picture).ok());
  const auto rays = RayScene::create(builtin->scene);
  ASSERT_TRUE(rays.ok());
  const DepthImage cast = cast_picture(*rays, *camera);

  int covered = 0, differ = 0, deeper = 0;
  for (int y = 0; y < 90; ++y)
    for (int x = 0; x < 120; ++x) {
      covered += cast.covered(x, y);
      if (picture->object(x, y) != cast.object(x, y)) {
        ++differ;
        continue;
      }
      if (!cast.covered(x, y)) {
        EXPECT_EQ(picture->color(x, y), glm::vec4(0.0f));
        continue;
      }
      EXPECT_GT(picture->color(x, y).a, 0.0f);
      // A ray may slip between triangles that meet, or past a silhouette, to the wall behind.
      deeper += std::abs(picture->depth(x, y) - cast.depth(x, y)) > 2e-3f * cast.depth(x, y);
    }
  EXPECT_GT(covered, 2000);
  EXPECT_LT(differ, covered / 200);
  EXPECT_LT(deeper, covered / 100);
}

INSTANTIATE_TEST_SUITE_P(AllProjections, CapturePictureTest,
                         testing::Values(Projection::perspective, Projection::back_perspective,
                                         Projection::parallel));

// Of any size, and after others: what is compiled while frames are drawn makes them stutter.
TEST(CapturePicture, compiles_no_program_but_with_the_first_picture) {
  auto context = gl::Context::create();
  ASSERT_TRUE(context.ok());
  const auto builtin = make_builtin("builtin:teapot?triangles=2000");
  auto renderer = SceneRenderer::create(builtin->scene);
  ASSERT_TRUE(renderer.ok());
  const Box box = world_bounds(builtin->scene);
  Result<Camera> camera =
      tight_camera(Projection::perspective, glm::dvec3(box.center()) + 2.0 * double(box.radius()),
                   {0, 1, 0}, box);
  ASSERT_TRUE(camera.ok());
  std::size_t made = 0;
  for (int i = 0; i < 3; ++i) {
    camera->width = 40 + 10 * i, camera->height = 30;
    for (const int samples : {1, 4})
      ASSERT_TRUE(
          capture_picture(*renderer, *camera, {.samples = samples, .with_sky = i == 2}).ok());
    if (i == 0) made = gl::programs_made();
    EXPECT_EQ(gl::programs_made(), made);
  }
}

TEST(CapturePicture, refuses_a_camera_that_is_none) {
  auto context = gl::Context::create();
  ASSERT_TRUE(context.ok());
  const auto builtin = make_builtin("builtin:teapot?triangles=2000");
  auto renderer = SceneRenderer::create(builtin->scene);
  ASSERT_TRUE(renderer.ok());
  Camera camera;
  camera.z_near = -1;
  EXPECT_FALSE(capture_picture(*renderer, camera).ok());
}

}  // namespace
}  // namespace rilievo
