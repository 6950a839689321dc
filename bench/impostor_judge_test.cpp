// How right relief impostors are in frames, at default settings.
#include "bench/impostor_judge.h"

#include <gtest/gtest.h>

#include "bench/stale_parts.h"

namespace rilievo::bench {
namespace {

class ImpostorJudgeTest : public testing::Test {
 protected:
  void SetUp() override {
    Result<TracedScene> made = traced_scene("builtin:teapots?triangles=20000");
    ASSERT_TRUE(made.ok());
    traced = std::make_unique<TracedScene>(std::move(*made));
    judge = std::make_unique<ImpostorJudge>(*traced, 1280, 720, 4);
  }
  std::unique_ptr<TracedScene> traced;
  std::unique_ptr<ImpostorJudge> judge;
};

// 40 dB, a hundredth of the range, is not seen. What is left is the noise of soft shadows, whose
// random places go with texels.
TEST_F(ImpostorJudgeTest, a_refined_object_cannot_be_told_from_a_full_ray_tracing) {
  for (const double angle : {0.4, 2.9}) {
    const Camera camera = orbit_camera(*traced, angle, 1280, 720);
    const Result<DepthImage> picture = judge->shade(camera, {});
    ASSERT_TRUE(picture.ok());
    // Its bounds are wider than half of the frame is high.
    EXPECT_GT(picture->camera.width, 512);
    const auto quality = judge->judge(warped_for(*picture, camera.position()), camera);
    ASSERT_TRUE(quality.ok());
    EXPECT_GT(quality->psnr_db, 40);
  }
}

TEST_F(ImpostorJudgeTest, an_old_picture_loses_little_but_its_light) {
  const Camera now = orbit_camera(*traced, 1.0, 1280, 720);
  const Camera before = orbit_camera(*traced, 1.0 - 0.0524, 1280, 720);
  const Result<DepthImage> picture = judge->shade(before, {});
  ASSERT_TRUE(picture.ok());
  ASSERT_TRUE(judge->judge(warped_for(*picture, now.position()), now).ok());
  const OldLight light = old_light(*traced, before, now, 4);
  const ErrorShares shares =
      error_shares(judge->drawn(), judge->same_part(light.picture), judge->corner(), light);
  EXPECT_GT(shares.silhouettes, 0.5);
  EXPECT_LT(shares.hidden_pixels, 0.02);
  // The same eye has nothing hidden, and the same light.
  const OldLight same = old_light(*traced, now, now, 4);
  EXPECT_TRUE(judge->same_part(same.picture) == judge->truth());
}

}  // namespace
}  // namespace rilievo::bench
