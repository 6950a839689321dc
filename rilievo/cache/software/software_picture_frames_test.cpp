
#include <gtest/gtest.h>

#include "rilievo/method/pictures_test_helpers.h"
#include "rilievo/method/test_source_test_helpers.h"
#include "rilievo/nailboard/software/software_store.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

class SoftwarePictureFrames : public testing::Test {
 protected:
  void load(const char* spec) {
    auto made = make_builtin(spec);
    ASSERT_TRUE(made.ok());
    builtin = std::move(*made);
  }
  [[nodiscard]] Camera camera_of(int frame, int width, int height) const {
    return camera_at(builtin.path, frame_time(builtin.path, frame), width, height);
  }

  BuiltinScene builtin;
};

TEST_F(SoftwarePictureFrames,
       objects_without_room_for_a_picture_are_polygons_and_old_ones_make_room) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:forest?triangles=100000"));
  PictureFramesOptions options;
  options.texels_per_pixel = 6;
  options.min_triangles = 1;
  auto plenty = software_pictures(builtin.scene, options);
  // The least that there can be, half of it for captures.
  const int mb = 1 << 20;
  while (check_software_store(store_options(options)).ok()) options.max_bytes -= mb;
  options.max_bytes += mb;
  auto little = software_pictures(builtin.scene, options);
  ASSERT_TRUE(plenty.ok() && little.ok());
  int polygons = 0;
  for (const int frame : {0, 40}) {
    const Camera camera = camera_of(frame, 1280, 720);
    ASSERT_TRUE((*plenty)->draw(camera, 0).ok() && (*little)->draw(camera, 0).ok());
    const FrameStats &a = (*plenty)->stats(), &b = (*little)->stats();
    EXPECT_EQ(a.polygons + a.count("nailboard"), b.polygons + b.count("nailboard"));
    EXPECT_LE(b.picture_bytes, options.max_bytes);
    EXPECT_GT(b.captures, 0) << frame;
    polygons += b.polygons - a.polygons;
  }
  EXPECT_GT(polygons, 0);
}

TEST_F(SoftwarePictureFrames, an_eye_that_only_turns_keeps_all_pictures_and_a_moved_one_few) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:teapots?triangles=10000"));
  auto frames = software_pictures(builtin.scene, {});
  ASSERT_TRUE(frames.ok());
  expect_captures_where_the_eye_has_moved(camera_of(0, 320, 180), [&](const Camera& camera) {
    EXPECT_TRUE((*frames)->draw(camera, 0).ok());
    return (*frames)->stats().captures;
  });
}

TEST_F(SoftwarePictureFrames, too_little_memory_is_refused) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:teapots?triangles=10000"));
  PictureFramesOptions options;
  options.max_bytes = std::size_t(1) << 20;
  EXPECT_FALSE(software_pictures(builtin.scene, options).ok());
}

}  // namespace
}  // namespace rilievo
