// Do processors draw the same frames as OpenGL does: polygons, the sky, and the cache's?

#include <gtest/gtest.h>

#include "rilievo/cache/gl/software_test_helpers.h"
#include "rilievo/frame/gl/opengl_sources_test_helpers.h"
#include "rilievo/measure/psnr.h"

namespace rilievo {
namespace {

using SoftwareCacheTest = SceneTest;

TEST_F(SoftwareCacheTest, polygons_and_the_sky_are_drawn_as_opengl_draws_them) {
  // OpenGL rounds corners to 1/256 of a pixel: of trees whose triangles are smaller than pixels, a
  // few more samples show another one.
  struct Case {
    const char* spec;
    double alike, psnr_db;
  };
  for (const auto& [spec, alike, least_db] : {Case{"builtin:teapots?triangles=30000", 0.999, 45},
                                              Case{"builtin:stonehenge?triangles=30000", 0.999, 45},
                                              Case{"builtin:bridge?triangles=100000", 0.997, 44}}) {
    SCOPED_TRACE(spec);
    ASSERT_NO_FATAL_FAILURE(load(spec));
    OpenGLFrames direct = opengl_direct(*renderer);
    TestSource software = software_direct(builtin.scene, 4);
    for (const int frame : {0, 40, 90}) {
      const Rgba8Image truth = frame_of(direct, frame);
      const auto objects = objects_of(direct);
      const Rgba8Image drawn = software_frame_of(software, builtin, frame);
      const Alike same = compare_frames(truth, drawn, objects);
      EXPECT_GT(same.inner, 0.3);
      EXPECT_GE(same.alike, alike);
      EXPECT_GT(psnr_db(truth, drawn), least_db);
      ASSERT_TRUE(software.draw_objects().ok());
      EXPECT_LE(wrong_inside(objects, software.software_target()->objects()),
                kWidth * kHeight / 1000);
    }
  }
}

TEST_F(SoftwareCacheTest, draws_the_cache_s_frames_as_opengl_draws_them) {
  int pictures = 0, fading = 0;
  for (const char* spec : {"builtin:forest?triangles=200000", "builtin:bridge?triangles=100000"}) {
    SCOPED_TRACE(spec);
    ASSERT_NO_FATAL_FAILURE(load(spec));
    ImageCacheOptions options;
    options.capture_by = CaptureBy::rasterizer;
    options.machine = costs_of_both();
    options.learn = false;  // OpenGL does not
    auto opengl = opengl_cache(*renderer, options);
    auto memory = software_cache(builtin.scene, options);
    ASSERT_TRUE(opengl.ok() && memory.ok());
    for (int frame = 0; frame < 24; ++frame) {
      const Rgba8Image truth = frame_of(*opengl, frame);
      const Rgba8Image drawn = software_frame_of(**memory, builtin, frame);
      const FrameStats &a = opengl->stats(), &b = (*memory)->stats();
      EXPECT_EQ(a.captures, b.captures);
      EXPECT_EQ(a.polygons, b.polygons);
      EXPECT_EQ(a.groups, b.groups);
      EXPECT_EQ(a.count("nailboard"), b.count("nailboard"));
      EXPECT_DOUBLE_EQ(a.bound_px.value(), b.bound_px.value());
      pictures += b.groups + b.count("nailboard");
      if (frame % 3 != 2) continue;
      const auto objects = objects_of(*opengl);
      const Alike same = compare_frames(truth, drawn, objects);
      EXPECT_GE(same.alike, 0.999);
      EXPECT_GT(psnr_db(truth, drawn), 45);
      ASSERT_TRUE((*memory)->draw_objects().ok());
      EXPECT_LE(wrong_inside(objects, (*memory)->software_target()->objects()),
                kWidth * kHeight / 1000);
      fading += (*memory)->stats().polygons;
    }
  }
  EXPECT_GT(pictures, 48);
  EXPECT_GT(fading, 0);
}

}  // namespace
}  // namespace rilievo
