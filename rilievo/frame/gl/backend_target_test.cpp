#include "rilievo/frame/backend_target.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "rilievo/capture/ray_source.h"
#include "rilievo/frame/gl/opengl_backend.h"
#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/io/exr.h"
#include "rilievo/method/direct.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

constexpr int kWidth = 160, kHeight = 90;

class BackendTargetTest : public gl::ContextTest {
 protected:
  BackendTargetTest() : built_(*make_builtin("builtin:teapots?triangles=20000")) {
    camera_ = camera_at(built_.path, 0.5, kWidth, kHeight);
  }

  // The frame that a backend draws directly, as it is read.
  DepthImage drawn(Backend& backend) {
    const auto frames = backend.make_frames(std::make_unique<DirectChooser>());
    const auto target = backend.make_target(kWidth, kHeight);
    EXPECT_TRUE(frames && target);
    const Result<> done = (*target)->draw(**frames, camera_, 0.5);
    EXPECT_TRUE(done.ok());
    DepthImage picture = read_picture(**target, camera_);
    const Rgba8Image bytes = srgb8_from_linear(picture.color);
    EXPECT_EQ(bytes, (*target)->color());
    return picture;
  }

  BuiltinScene built_;
  Camera camera_;
};

// Of the pixels that rays hit, those whose depth is another one.
double other_depths(const DepthImage& drawn, const DepthImage& truth, double& covered) {
  int hits = 0, others = 0;
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x) {
      if (!truth.covered(x, y)) continue;
      ++hits;
      others += !(std::abs(drawn.depth(x, y) / truth.depth(x, y) - 1) < 0.01f);
    }
  covered = double(hits) / (kWidth * kHeight);
  return double(others) / hits;
}

TEST_F(BackendTargetTest, frames_read_from_both_backends_have_the_depths_that_rays_find) {
  const auto rays = RayScene::create(built_.scene, 0.5);
  ASSERT_TRUE(rays);
  const auto truth = RaySource(*rays).capture({.camera = camera_, .samples = 1});
  ASSERT_TRUE(truth);
  for (const int samples : {1, 4}) {
    const auto opengl = OpenGLBackend::create(built_.scene, samples);
    const auto software = SoftwareBackend::create(built_.scene, samples);
    ASSERT_TRUE(opengl && software);
    for (Backend* backend :
         {static_cast<Backend*>(opengl->get()), static_cast<Backend*>(software->get())}) {
      backend->set_time(0.5);
      double covered = 0;
      // A pixel's sample lies up to half a pixel beside its centre: silhouettes differ, one pixel
      // wide, and where the ground is seen at a small angle the depth by some percent a pixel.
      EXPECT_LT(other_depths(drawn(*backend), truth->picture, covered), samples == 1 ? 0.01 : 0.1);
      EXPECT_GT(covered, 0.3);
    }
  }
}

TEST_F(BackendTargetTest, a_frame_is_a_picture_that_openexr_keeps) {
  const auto backend = SoftwareBackend::create(built_.scene, 4);
  ASSERT_TRUE(backend);
  const DepthImage frame = drawn(**backend);
  const auto file = std::filesystem::temp_directory_path() / "rilievo_backend_target_test.exr";
  ASSERT_TRUE(save_pictures(file, {&frame, 1}));
  const auto loaded = load_pictures(file);
  std::filesystem::remove(file);
  ASSERT_TRUE(loaded.ok());
  EXPECT_EQ((*loaded)[0].depth, frame.depth);
  EXPECT_EQ((*loaded)[0].camera, frame.camera);
  // A half has 11 bits: its colours are the same bytes again.
  EXPECT_EQ(srgb8_from_linear((*loaded)[0].color), srgb8_from_linear(frame.color));
}

TEST_F(BackendTargetTest, sizes_and_samples_that_cannot_be_are_refused) {
  const auto opengl = OpenGLBackend::create(built_.scene, 4);
  const auto software = SoftwareBackend::create(built_.scene, 4);
  ASSERT_TRUE(opengl && software);
  for (const auto& [width, height] : {std::pair(0, 5), {5, 0}, {1 << 20, 5}}) {
    EXPECT_FALSE((*opengl)->make_target(width, height)) << width;
    EXPECT_FALSE((*software)->make_target(width, height)) << width;
  }
  EXPECT_FALSE(SoftwareBackend::create(built_.scene, 3));
}

}  // namespace
}  // namespace rilievo
