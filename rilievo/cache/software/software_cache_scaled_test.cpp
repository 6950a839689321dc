// What is scaled to nothing for a while, as files switch objects on and off, is there afterwards.
#include <gtest/gtest.h>

#include "rilievo/method/test_source_test_helpers.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

class ScaledToNothing : public testing::Test {
 protected:
  // One teapot, of no size in the first second and in the third.
  void SetUp() override {
    auto made = make_builtin("builtin:teapots?triangles=30000");
    ASSERT_TRUE(made.ok());
    scene_ = std::move(made->scene);
    scene_.objects.resize(1);
    scene_.objects[0].placement = glm::mat4(1);
    scene_.nodes = {Node{}};
    scene_.objects[0].node = 0;
    Channel scale;
    scale.path = Channel::Path::scale;
    scale.interpolation = Channel::Interpolation::step;
    scale.times = {0, 1, 2, 3};
    scale.values = {glm::vec4(0), glm::vec4(1), glm::vec4(0), glm::vec4(1)};
    scene_.channels = {scale};
    scene_.duration = 4;
    finish(scene_);
    ASSERT_TRUE(validate(scene_).ok());
    const Box box = world_bounds(scene_, 1.5);
    const glm::dvec3 middle(box.center());
    camera_ = look_at(middle + glm::dvec3(0, 0.3, 1.9) * double(box.radius()), middle, {0, 1, 0},
                      0.8, 160, 120, 0.01, 1000);
  }
  // The pixels that show anything, in frames of the given times.
  std::vector<int> shown(FrameSource& frames) {
    std::vector<int> counts;
    for (const double time : {0.0, 0.5, 1.5, 1.6, 1.7, 2.5, 2.6, 3.5, 3.6}) {
      EXPECT_TRUE(frames.draw(camera_, time).ok());
      const Image<float> depth = frames.software_target()->eye_z();
      counts.push_back(
          int(std::ranges::count_if(depth.texels(), [](float z) { return z < kNoDepth; })));
    }
    return counts;
  }
  void expect_there_and_gone(FrameSource& frames) {
    const std::vector<int> counts = shown(frames);
    for (const int frame : {0, 1, 5, 6}) EXPECT_EQ(counts[std::size_t(frame)], 0) << frame;
    // Between polygons and pictures a pixel at each end of 120 rows may differ.
    for (const int frame : {2, 3, 4, 7, 8})
      EXPECT_NEAR(counts[std::size_t(frame)], counts[2], 240) << frame;
    EXPECT_GT(counts[2], 1500);
  }

  Scene scene_;
  Camera camera_;
};

TEST_F(ScaledToNothing, the_cache_draws_it_afterwards) {
  for (const double capture_ms : {0.0, 50.0}) {
    ImageCacheOptions options;
    options.capture_ms = capture_ms;
    auto cache = software_cache(scene_, options);
    ASSERT_TRUE(cache.ok());
    expect_there_and_gone(**cache);
  }
}

TEST_F(ScaledToNothing, pictures_of_each_object_show_it_afterwards) {
  auto frames = software_pictures(scene_, {});
  ASSERT_TRUE(frames.ok());
  expect_there_and_gone(**frames);
}

}  // namespace
}  // namespace rilievo
