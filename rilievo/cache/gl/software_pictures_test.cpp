// Are pictures that are captured again by an angle chosen and drawn without OpenGL as with it?
#include <gtest/gtest.h>

#include <vector>

#include "rilievo/cache/gl/software_test_helpers.h"
#include "rilievo/frame/gl/opengl_sources_test_helpers.h"

namespace rilievo {
namespace {

class SoftwarePicturesTest : public AlikeTest {
 protected:
  // Along the scene's path, while its objects move. The rasteriser captures for both.
  void expect_same_walk(PictureFramesOptions options, std::span<const int> frames) {
    options.capture_by = CaptureBy::rasterizer;
    auto opengl = opengl_pictures(*renderer, options);
    auto software = software_pictures(builtin.scene, options);
    ASSERT_TRUE(opengl.ok() && software.ok());
    int captures = 0, kept = 0;
    for (const int frame : frames) {
      SCOPED_TRACE(frame);
      const double time = frame_time(builtin.path, frame);
      const Camera camera = camera_at(builtin.path, time, kWidth, kHeight);
      expect_same(*opengl, **software, camera, 0.2, time);
      const FrameStats &a = opengl->stats(), &b = (*software)->stats();
      EXPECT_EQ(a.captures, b.captures);
      EXPECT_EQ(a.polygons, b.polygons);
      EXPECT_EQ(a.count("nailboard"), b.count("nailboard"));
      captures += b.captures;
      kept += b.count("nailboard") - b.captures;
    }
    EXPECT_GT(captures, 0);
    EXPECT_GT(kept, 0);
  }
};

TEST_F(SoftwarePicturesTest, each_depth_is_drawn_as_opengl_draws_it) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:teapots?triangles=20000"));
  const int frames[] = {0, 1, 2, 40, 41};
  for (const DepthMode mode : {DepthMode::flat, DepthMode::linear, DepthMode::exact}) {
    SCOPED_TRACE(int(mode));
    PictureFramesOptions options;
    options.mode = mode;
    options.max_angle = 0.02;
    expect_same_walk(options, frames);
  }
}

TEST_F(SoftwarePicturesTest, a_forest_of_many_pictures_is_drawn_as_opengl_draws_it) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:forest?triangles=200000"));
  const int frames[] = {0, 1, 2};
  PictureFramesOptions options;
  options.max_angle = 0.02;
  expect_same_walk(options, frames);
}

TEST_F(SoftwarePicturesTest, pictures_are_read_back_as_opengl_s_are) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:teapots?triangles=20000"));
  PictureFramesOptions options;
  options.capture_by = CaptureBy::rasterizer;
  auto opengl = opengl_pictures(*renderer, options);
  auto software = software_pictures(builtin.scene, options);
  ASSERT_TRUE(opengl.ok() && software.ok());
  const Camera camera = camera_at(builtin.path, 0, kWidth, kHeight);
  frame_of(*opengl, camera);
  ASSERT_TRUE((*software)->draw(camera, 0).ok());
  const std::vector<DepthImage> a = opengl->read_pictures(), b = (*software)->read_pictures();
  ASSERT_EQ(a.size(), b.size());
  ASSERT_GT(a.size(), 8u);
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].name, b[i].name);
    EXPECT_EQ(a[i].color, b[i].color);
    EXPECT_EQ(a[i].depth, b[i].depth);
    EXPECT_EQ(a[i].object, b[i].object);
  }
}

}  // namespace
}  // namespace rilievo
