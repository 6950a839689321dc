#include "rilievo/keyframes/coarse_keyframes.h"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>
#include <utility>

#include "rilievo/capture/forwarding_source.h"
#include "rilievo/capture/raster_source.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

// A source that takes so long for a picture, and counts them.
class SlowSource final : public ForwardingSource {
 public:
  using ForwardingSource::ForwardingSource;
  [[nodiscard]] Result<CapturedPicture> capture(const CaptureRequest& request) override {
    ++pictures, width = request.camera.width;
    if (fails) return Error{"source", "fails"};
    std::this_thread::sleep_for(std::chrono::milliseconds(ms));
    return source_.capture(request);
  }
  int ms = 0, pictures = 0, width = 0;
  bool fails = false;
};

struct CoarseStage {
  BuiltinScene made = *make_builtin("builtin:stonehenge?triangles=20000");
  PlacedScene placed{made.scene};
  RasterSource raster{placed};
  SlowSource source{raster};
  CoarseKeyframes coarse{source};
  Camera frame = look_at({0, 1.7, 12}, {0, 1.7, 0}, {0, 1, 0}, 0.9, 96, 64, 0.1, 200);

  int width() {
    Result<Keyframe> made_now = coarse.make(frame, {}, 0);
    EXPECT_TRUE(made_now);
    if (!made_now) return 0;
    EXPECT_TRUE(made_now->coarse);
    const int width = made_now->camera.width;
    coarse.reuse(std::move(*made_now));
    return width;
  }
};

TEST(CoarseKeyframes, AreAsLargeAsTheMachineMakesInTime) {
  CoarseStage stage;
  // The size follows from what the one before took: nothing is known, next to nothing, too much.
  const int first = stage.width();
  stage.source.ms = 2000;
  const int second = stage.width();
  stage.source.ms = 0;
  const int third = stage.width();
  EXPECT_NEAR(first, 96 * 1.1 * 0.45, 3);
  // By the time of a few texels, which another program may lengthen.
  EXPECT_GE(second, third);
  EXPECT_LE(second, 96 * 1.1 + 3);
  EXPECT_NEAR(third, 96 * 1.1 * 0.25, 3);
}

TEST(CoarseKeyframes, MemoryIsTakenOnceAndSufficesForTheFirst) {
  CoarseStage stage;
  stage.coarse.take_memory(stage.frame, {}, 0);
  stage.coarse.take_memory(stage.frame, {}, 0);
  EXPECT_EQ(stage.source.pictures, 1);
  // What new pages took tells nothing of the size.
  EXPECT_EQ(stage.width(), stage.source.width);
  EXPECT_NEAR(stage.source.width, 96 * 1.1 * 0.45, 3);
}

TEST(CoarseKeyframes, ASourceThatFailsSaysSoWhereOneIsNeeded) {
  CoarseStage stage;
  stage.source.fails = true;
  stage.coarse.take_memory(stage.frame, {}, 0);
  EXPECT_FALSE(stage.coarse.make(stage.frame, {}, 0));
  stage.source.fails = false;
  EXPECT_NEAR(stage.width(), 96 * 1.1 * 0.45, 3);
}

}  // namespace
}  // namespace rilievo
