#include "rilievo/method/auto_keyframes.h"

#include <gtest/gtest.h>

#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

TEST(AutoKeyframes, where_the_first_one_alone_loses_too_much_the_second_one_is_not_made) {
  const auto built = make_builtin("builtin:stonehenge?triangles=20000");
  ASSERT_TRUE(built.ok());
  KeyframeFramesOptions options;
  options.polygons_where_cheaper = false;
  const auto camera = [&](int i) {
    return camera_at(built->path, frame_time(built->path, i), 160, 90);
  };
  for (const double most_db : {1000.0, -1000.0}) {
    const auto frames = KeyframeFrames::create(built->scene, options);
    ASSERT_TRUE(frames.ok() && (*frames)->prepare_first(camera(0), 0).ok());
    EyePrediction eye;
    eye.follow(camera(0));
    eye.follow(camera(1));
    const Result<BegunKeyframes> begun = begin_keyframes(eye, 0, most_db, **frames);
    ASSERT_TRUE(begun.ok());
    EXPECT_TRUE(begun->loss_db);
    EXPECT_EQ((*frames)->prepared(), most_db > 0);
    EXPECT_EQ(begun->frames > 0, most_db > 0);
    // The frames go on from what there is.
    EXPECT_TRUE((*frames)->draw(camera(2), 0).ok());
  }
}

}  // namespace
}  // namespace rilievo
