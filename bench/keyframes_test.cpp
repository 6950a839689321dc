#include <gtest/gtest.h>

#include "bench/keyframe_walk.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo::bench {
namespace {

TEST(KeyframesBenchmark, a_walk_is_compared_with_true_frames_and_with_every_rival) {
  const auto built = make_builtin("builtin:stonehenge?triangles=20000");
  ASSERT_TRUE(built.ok());
  SoftwareBackend backend(built->scene, 4);
  KeyframeWalkOptions options;
  options.width = 160, options.height = 90, options.seconds = 0.3;
  options.places = 2, options.reference = 16;
  const Result<KeyframeWalk> walked = walk_by_keyframes(backend, built->path, options);
  ASSERT_TRUE(walked.ok());
  ASSERT_EQ(walked->rivals.size(), 4u);
  EXPECT_EQ(walked->rivals[0].name, "direct-raster");
  for (const KeyframeRival& rival : walked->rivals) {
    EXPECT_GT(rival.p50_ms, 0) << rival.name;
    // Four samples against sixteen: neither the same nor another picture.
    EXPECT_GT(rival.psnr_db, 20) << rival.name;
    EXPECT_LT(rival.psnr_db, 60) << rival.name;
  }
  EXPECT_GT(walked->psnr_db.mean, 20);
  EXPECT_EQ(walked->missing, 0);
  EXPECT_EQ(walked->live_share, 0);
  EXPECT_LT(walked->wrong_share, 0.02);
  EXPECT_LE(walked->lost_at_edges + walked->lost_as_wrong, 1);
}

TEST(KeyframesBenchmark, the_fastest_rival_is_one_that_looks_as_good) {
  KeyframeWalk walk;
  walk.psnr_db.mean = 35;
  walk.rivals = {{"slow", 50, 50, 40, 0}, {"coarse", 10, 10, 30, 0}, {"fast", 20, 20, 36, 0}};
  EXPECT_EQ(walk.fastest_as_good().name, "fast");
  // None is as good: the best one counts.
  walk.psnr_db.mean = 50;
  EXPECT_EQ(walk.fastest_as_good().name, "slow");
}

}  // namespace
}  // namespace rilievo::bench
