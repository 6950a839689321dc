#include "rilievo/frame/software/software_backend_target.h"

#include <gtest/gtest.h>

#include "rilievo/frame/frame_source.h"

namespace rilievo {
namespace {

// Draws frames into two targets by turns, each of one colour.
class SourceOfTwoTargets final : public FrameSource {
 public:
  Result<> draw(const Camera& camera, double) override {
    now_ = 1 - now_;
    targets_[now_].draw(camera.z_far, {}, glm::u8vec4(++frames_, 0, 0, 255));
    return Done{};
  }
  Result<> draw_objects() override {
    targets_[now_].draw_objects(1, {});
    return Done{};
  }
  [[nodiscard]] const SoftwareTarget* software_target() const override { return &targets_[now_]; }
  [[nodiscard]] const FrameStats& stats() const override { return stats_; }

 private:
  SoftwareTarget targets_[2] = {SoftwareTarget(8, 8, 1), SoftwareTarget(8, 8, 1)};
  int now_ = 0, frames_ = 0;
  FrameStats stats_;
};

// As a source does that fades from one method to another.
TEST(SoftwareBackendTarget, shows_the_target_that_the_last_frame_is_in) {
  SourceOfTwoTargets source;
  SoftwareBackendTarget target;
  Camera camera;
  camera.width = camera.height = 8;
  for (int frame = 1; frame <= 4; ++frame) {
    ASSERT_TRUE(target.draw(source, camera, 0).ok());
    EXPECT_EQ(target.color()(3, 3).r, frame);
    const Result<SeenObjects> seen = target.draw_objects(source);
    ASSERT_TRUE(seen.ok());
    EXPECT_EQ(seen->objects.width(), 8);
  }
}

}  // namespace
}  // namespace rilievo
