
#include <gtest/gtest.h>

#include <cmath>

#include "rilievo/cache/gl/scene_test_helpers.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/frame/gl/opengl_sources_test_helpers.h"
#include "rilievo/io/exr.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/method/pictures_test_helpers.h"
#include "rilievo/nailboard/gl/atlas_pictures.h"
#include "rilievo/representation/gl/factories.h"
#include "rilievo/representation/kinds.h"

namespace rilievo {
namespace {

struct Fixture : SceneTest {
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(SceneTest::SetUp());
    ASSERT_NO_FATAL_FAILURE(load("builtin:teapots?triangles=20000"));
  }
};

using PictureFramesTest = Fixture;

TEST_F(PictureFramesTest, nailboards_cut_into_each_other_as_polygons_do_and_flat_impostors_do_not) {
  const Camera camera = camera_at(builtin.path, 0, kWidth, kHeight);
  OpenGLFrames direct = opengl_direct(*renderer);
  const Rgba8Image truth = frame_of(direct, camera);
  const auto true_objects = objects_of(direct);
  int wrong[3];
  double psnr[3];
  for (DepthMode mode : {DepthMode::flat, DepthMode::linear, DepthMode::exact}) {
    PictureFramesOptions options;
    options.mode = mode;
    auto frames = opengl_pictures(*renderer, options);
    ASSERT_TRUE(frames.ok()) << frames.error().message();
    psnr[int(mode)] = psnr_db(frame_of(*frames, camera), truth);
    wrong[int(mode)] = wrong_inside(true_objects, objects_of(*frames));
    EXPECT_GT(frames->stats().count("nailboard"), 8);
    EXPECT_EQ(frames->stats().captures, frames->stats().count("nailboard"));
  }
  // From the capturing eye nailboards show the truth but for resampling (a blur of half a texel,
  // some 35 dB at this size) and Delta's 1/254 where surfaces cross.
  EXPECT_GT(psnr[int(DepthMode::exact)], 33);
  EXPECT_GT(psnr[int(DepthMode::linear)], 33);
  EXPECT_LT(wrong[int(DepthMode::exact)], kWidth * kHeight / 1000);
  EXPECT_LT(wrong[int(DepthMode::linear)], kWidth * kHeight / 1000);
  EXPECT_GT(wrong[int(DepthMode::flat)], 10 * wrong[int(DepthMode::exact)]);
}

TEST_F(PictureFramesTest,
       a_picture_is_kept_while_the_eye_only_turns_and_captured_when_it_has_moved) {
  PictureFramesOptions options;
  auto frames = opengl_pictures(*renderer, options);
  ASSERT_TRUE(frames.ok());
  expect_captures_where_the_eye_has_moved(camera_at(builtin.path, 0, kWidth, kHeight),
                                          [&](const Camera& camera) {
                                            frame_of(*frames, camera);
                                            return frames->stats().captures;
                                          });
}

TEST_F(PictureFramesTest, pictures_read_back_from_a_file_draw_the_same_frame_bit_for_bit) {
  const Camera camera = camera_at(builtin.path, 0, kWidth, kHeight);
  const TemporaryFolder folder;
  const Scene nothing;
  auto empty = SceneRenderer::create(nothing);
  ASSERT_TRUE(empty.ok());
  for (int bits : {8, 16}) {
    PictureFramesOptions options;
    options.delta_bits = bits;
    auto frames = opengl_pictures(*renderer, options);
    ASSERT_TRUE(frames.ok());
    frame_of(*frames, camera);
    const std::vector<DepthImage> pictures = frames->read_pictures();
    const auto file = folder / ("pictures_" + std::to_string(bits) + ".exr");
    ASSERT_TRUE(save_pictures(file, pictures).ok());
    const auto loaded = load_pictures(file);
    ASSERT_TRUE(loaded.ok()) << loaded.error().message();
    auto before = make_atlas_pictures(pictures, DepthMode::exact, bits);
    auto after = make_atlas_pictures(*loaded, DepthMode::exact, bits);
    ASSERT_TRUE(before.ok() && after.ok());
    OpenGLFrames from_memory =
        opengl_stored(*empty, std::move(before->drawable), before->instances, false, false);
    OpenGLFrames from_file =
        opengl_stored(*empty, std::move(after->drawable), after->instances, false, false);
    const Rgba8Image a = frame_of(from_memory, camera), b = frame_of(from_file, camera);
    ASSERT_EQ(a, b);
    // And the file's frame is the live one wherever a picture is: the live atlas holds the same
    // bytes.
    const Rgba8Image live = frame_of(*frames, camera);
    int differ = 0, drawn = 0;
    for (std::size_t i = 0; i < a.texels().size(); ++i) {
      if (a.texels()[i] == glm::u8vec4(0, 0, 0, 255)) continue;
      ++drawn;
      differ += a.texels()[i] != live.texels()[i];
    }
    EXPECT_GT(drawn, kWidth * kHeight / 8);
    // Live polygons (a table, a wall) show through edges and before some pictures.
    EXPECT_LT(differ, drawn / 10);
  }
}

TEST_F(PictureFramesTest, frames_are_the_same_from_run_to_run) {
  const Camera camera = camera_at(builtin.path, 0.1, kWidth, kHeight);
  Rgba8Image first;
  for (int run = 0; run < 2; ++run) {
    auto frames = opengl_pictures(*renderer, {});
    ASSERT_TRUE(frames.ok());
    const Rgba8Image frame = frame_of(*frames, camera, 0.1);
    if (run) {
      EXPECT_EQ(frame, first);
    }
    first = frame;
  }
}

}  // namespace
}  // namespace rilievo
