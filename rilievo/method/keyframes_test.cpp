// Keyframes by name: what the command line makes.
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "rilievo/frame/software/software_backend.h"
#include "rilievo/method/method.h"
#include "rilievo/render/software/software_target.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

TEST(Method, keyframes_of_either_source_show_every_object_in_view) {
  const auto built = make_builtin("builtin:teapots?triangles=20000");
  ASSERT_TRUE(built.ok());
  for (const char* const source : {"raster", "rays"}) {
    SoftwareBackend backend(built->scene, 4);
    MethodOptions options;
    options.source = source;
    const Result<Method> made = make_method("keyframes", options, backend);
    ASSERT_TRUE(made.ok());
    SoftwareBackend other(built->scene, 4);
    const Result<Method> direct = make_method("direct-raster", options, other);
    ASSERT_TRUE(direct.ok());
    // The second keyframe begins in the third frame, when it is known how fast the eye goes, and is
    // complete after fifteen bands of 16 columns of 231, if the eye turns.
    for (int i = 0; i < 18; ++i) {
      const double time = frame_time(built->path, 2 * i);
      const Camera camera = camera_at(built->path, time, 160, 96);
      ASSERT_TRUE(made->frames->draw(camera, time).ok());
      ASSERT_TRUE(direct->frames->draw(camera, time).ok());
    }
    EXPECT_EQ(made->frames->stats().count("keyframe"), 2);
    ASSERT_TRUE(made->frames->draw_objects().ok() && direct->frames->draw_objects().ok());
    const auto shown = made->frames->software_target()->objects().texels();
    const auto truth = direct->frames->software_target()->objects().texels();
    for (std::uint32_t object = 1; object <= built->scene.objects.size(); ++object)
      // Of fewer pixels an edge that is a pixel off may leave none.
      if (std::count(truth.begin(), truth.end(), object) > 12) {
        EXPECT_GT(std::count(shown.begin(), shown.end(), object), 0) << object;
      }
  }
}

// Of sources that would work beside frames by the clock.
TEST(Method, frames_that_do_not_go_by_the_clock_wait_for_a_slow_source) {
  const auto built = make_builtin("builtin:teapots?triangles=20000");
  ASSERT_TRUE(built.ok());
  std::vector<Rgba8Image> runs[2];
  for (std::vector<Rgba8Image>& run : runs) {
    SoftwareBackend backend(built->scene, 4);
    MethodOptions options;
    options.source = "raytrace";
    const Result<Method> made = make_method("keyframes", options, backend);
    ASSERT_TRUE(made.ok());
    int captures = 0;
    for (int i = 0; i < 20; ++i) {
      const double time = frame_time(built->path, i);
      ASSERT_TRUE(made->frames->draw(camera_at(built->path, time, 96, 64), time).ok());
      EXPECT_EQ(made->frames->stats().late, 0);
      captures += made->frames->stats().captures;
      run.push_back(made->frames->software_target()->color());
    }
    EXPECT_GE(captures, 2);
  }
  EXPECT_EQ(runs[0], runs[1]);
}

TEST(Method, keyframes_by_an_unknown_source_are_an_error_that_names_the_option) {
  const auto built = make_builtin("builtin:teapots?triangles=20000");
  ASSERT_TRUE(built.ok());
  SoftwareBackend backend(built->scene, 4);
  MethodOptions options;
  // A distance field is not the scene.
  for (const char* const source : {"paint", "sdf:torus"}) {
    options.source = source;
    const Result<Method> made = make_method("keyframes", options, backend);
    ASSERT_FALSE(made.ok());
    EXPECT_EQ(made.error().where, "--source");
  }
}

}  // namespace
}  // namespace rilievo
