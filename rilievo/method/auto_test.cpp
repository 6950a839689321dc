// The method `auto`: what it draws is what the method that it names draws.
#include "rilievo/method/auto.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <chrono>
#include <glm/gtc/matrix_transform.hpp>
#include <map>
#include <string>
#include <thread>

#include "rilievo/frame/software/software_backend.h"
#include "rilievo/method/auto_keyframes.h"
#include "rilievo/render/software/software_target.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

class AutoTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto built = make_builtin("builtin:teapots?triangles=20000");
    ASSERT_TRUE(built.ok());
    scene_ = std::move(built->scene);
    path_ = built->path;
  }
  [[nodiscard]] Camera camera(int frame, int width, int height) const {
    return camera_at(path_, frame_time(path_, frame), width, height);
  }

  Scene scene_;
  CameraPath path_;
};

TEST_F(AutoTest,
       a_scene_with_few_triangles_for_the_frame_is_drawn_directly_and_nothing_else_is_made) {
  SoftwareBackend backend(scene_, 4), other(scene_, 4);
  for (const bool by_clock : {false, true}) {
    const Result<Method> made = make_method("auto", {.by_clock = by_clock}, backend);
    const Result<Method> direct = make_method("direct-raster", {}, other);
    ASSERT_TRUE(made.ok() && direct.ok());
    for (int i = 0; i < 5; ++i) {
      // Ninety pixels a triangle.
      const Camera eye = camera(i, 1600, 1125);
      ASSERT_TRUE(made->frames->draw(eye, 0).ok() && direct->frames->draw(eye, 0).ok());
      const FrameStats& stats = made->frames->stats();
      EXPECT_EQ(stats.decision.method, "direct");
      EXPECT_EQ(stats.decision.sentence(), "direct (the scene fits the frame)");
      EXPECT_EQ(stats.captures, 0);
      EXPECT_EQ(stats.picture_bytes, 0u);
      EXPECT_TRUE(made->frames->software_target()->color() ==
                  direct->frames->software_target()->color());
    }
  }
}

// 90 000 pixels: levels may gain.
TEST_F(AutoTest, where_triangles_are_few_nothing_is_captured) {
  SoftwareBackend backend(scene_, 4);
  for (const bool by_clock : {false, true}) {
    const Result<Method> made = make_method("auto", {.by_clock = by_clock}, backend);
    ASSERT_TRUE(made.ok());
    for (int i = 0; i < 60; ++i) {
      ASSERT_TRUE(made->frames->draw(camera(i, 400, 225), frame_time(path_, i)).ok());
      const FrameStats& stats = made->frames->stats();
      EXPECT_NE(stats.decision.method, "cache");
      if (i == 0 || !by_clock) {
        EXPECT_EQ(stats.decision.method, "direct");
      }
    }
  }
}

// Half of a sphere's triangles are coarser than a pixel, and fewer than 2 for each of its pixels.
TEST_F(AutoTest, levels_of_few_triangles_are_prepared_whatever_is_guessed_of_them) {
  auto built = make_builtin("builtin:teapot");
  ASSERT_TRUE(built.ok());
  SoftwareBackend backend(built->scene, 4);
  const Result<Method> made = make_method("auto", {.by_clock = true}, backend);
  ASSERT_TRUE(made.ok());
  int by_levels = 0;
  // A thread makes them of what frames leave of the cores, which is nothing beside other programs:
  // the limit is for a test that fails.
  const auto begun = std::chrono::steady_clock::now();
  for (int i = 0;
       by_levels == 0 && std::chrono::steady_clock::now() - begun < std::chrono::seconds(120);
       i = (i + 1) % 200) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    const double time = frame_time(built->path, i);
    ASSERT_TRUE(made->frames->draw(camera_at(built->path, time, 512, 288), time).ok());
    const FrameDecision& decision = made->frames->stats().decision;
    by_levels += decision.method == "lod" || decision.rival == "lod";
  }
  EXPECT_GT(by_levels, 0);
}

// Of boxes there are none.
TEST_F(AutoTest, levels_that_leave_all_triangles_are_not_tried) {
  auto built = make_builtin("builtin:cube");
  ASSERT_TRUE(built.ok());
  const Object box = built->scene.objects.front();
  for (int i = 1; i < 400; ++i) {
    built->scene.objects.push_back(box);
    built->scene.objects.back().placement =
        glm::translate(box.placement, {float(i % 20 - 10), 0, float(i / 20)});
  }
  SoftwareBackend backend(built->scene, 4);
  const Result<Method> made = make_method("auto", {.by_clock = true}, backend);
  ASSERT_TRUE(made.ok());
  for (int i = 0; i < 80; ++i) {
    const double time = frame_time(built->path, i);
    ASSERT_TRUE(made->frames->draw(camera_at(built->path, time, 100, 60), time).ok());
    EXPECT_NE(made->frames->stats().decision.method, "lod") << i;
  }
}

TEST_F(AutoTest, by_counts_the_same_walk_gives_the_same_frames) {
  std::vector<Rgba8Image> frames[2];
  std::vector<std::string> decisions[2];
  for (int run = 0; run < 2; ++run) {
    SoftwareBackend backend(scene_, 4);
    const Result<Method> made = make_method("auto", {}, backend);
    ASSERT_TRUE(made.ok());
    for (int i = 0; i < 40; ++i) {
      ASSERT_TRUE(made->frames->draw(camera(i, 96, 64), frame_time(path_, i)).ok());
      frames[run].push_back(made->frames->software_target()->color());
      decisions[run].push_back(made->frames->stats().decision.sentence());
      EXPECT_LE(made->frames->stats().bound_px, 1);
    }
  }
  EXPECT_EQ(decisions[0], decisions[1]);
  EXPECT_TRUE(frames[0] == frames[1]);
  // There are more triangles than pixels.
  EXPECT_TRUE(decisions[0][0].starts_with("cache (by the size of the scene"));
}

TEST_F(AutoTest, frames_that_are_said_to_be_direct_are_those_of_direct_drawing) {
  SoftwareBackend backend(scene_, 4), other(scene_, 4);
  // A cache that may show no picture at all costs no less than polygons: both are drawn.
  MethodOptions options;
  options.error_px = 0.01;
  const Result<Method> made = make_method("auto", options, backend);
  const Result<Method> direct = make_method("direct-raster", {}, other);
  ASSERT_TRUE(made.ok() && direct.ok());
  std::map<std::string, int> drawn;
  for (int i = 0; i < 60; ++i) {
    const Camera eye = camera(i, 96, 64);
    const double time = frame_time(path_, i);
    ASSERT_TRUE(made->frames->draw(eye, time).ok() && direct->frames->draw(eye, time).ok());
    const std::string by(made->frames->stats().decision.method);
    ++drawn[by];
    if (by != "direct") continue;
    EXPECT_TRUE(made->frames->software_target()->color() ==
                direct->frames->software_target()->color())
        << i;
    ASSERT_TRUE(made->frames->draw_objects().ok() && direct->frames->draw_objects().ok());
    EXPECT_TRUE(made->frames->software_target()->objects() ==
                direct->frames->software_target()->objects())
        << i;
  }
  EXPECT_GT(drawn["direct"], 0);
  EXPECT_GT(drawn["cache"], 0);
}

// Whatever the clock says: no object is missing, and the one that draws is named.
TEST_F(AutoTest, by_the_clock_no_object_is_missing) {
  SoftwareBackend backend(scene_, 4), other(scene_, 4);
  const Result<Method> made = make_method("auto", {.by_clock = true}, backend);
  const Result<Method> direct = make_method("direct-raster", {}, other);
  ASSERT_TRUE(made.ok() && direct.ok());
  for (int i = 0; i < 120; ++i) {
    const Camera eye = camera(i, 96, 64);
    const double time = frame_time(path_, i);
    ASSERT_TRUE(made->frames->draw(eye, time).ok());
    EXPECT_FALSE(made->frames->stats().decision.method.empty());
    if (i % 8 != 0) continue;
    ASSERT_TRUE(direct->frames->draw(eye, time).ok());
    ASSERT_TRUE(made->frames->draw_objects().ok() && direct->frames->draw_objects().ok());
    const auto shown = made->frames->software_target()->objects().texels();
    const auto truth = direct->frames->software_target()->objects().texels();
    for (std::uint32_t object = 1; object <= scene_.objects.size(); ++object)
      // Of fewer pixels an edge that is a pixel off may leave none.
      if (std::count(truth.begin(), truth.end(), object) > 12) {
        EXPECT_GT(std::count(shown.begin(), shown.end(), object), 0) << object << " in " << i;
      }
  }
}

// What the first keyframe loses seen from aside, as `auto` finds it before the first frame.
double loss_before_the_first_frame(const BuiltinScene& built, const Camera& eye) {
  SoftwareBackend backend(built.scene, 4);
  const Result<Method> direct = make_method("direct-raster", {}, backend);
  KeyframeFramesOptions options;
  options.polygons_where_cheaper = false;
  options.keyframes.keyframe_ms = 8;
  const auto frames = KeyframeFrames::create(built.scene, options);
  EXPECT_TRUE(direct.ok() && frames.ok());
  EXPECT_TRUE(direct->frames->draw(eye, 0).ok() && (*frames)->draw(eye, 0).ok());
  const Image<float>& inverse_z = direct->frames->software_target()->inverse_z();
  const auto loss_db = loss_aside(eye, 0, inverse_z, kSoonAside, **frames);
  EXPECT_TRUE(loss_db.ok() && *loss_db);
  return **loss_db;
}

// From the first frame on if that is certain; else the cache begins.
TEST_F(AutoTest, where_direct_drawing_takes_long_keyframes_begin_if_they_are_good_enough) {
  auto built = make_builtin("builtin:stonehenge?triangles=200000");
  ASSERT_TRUE(built.ok());
  int width = 160;
  const auto camera = [&](int frame) {
    return camera_at(built->path, frame_time(built->path, frame), width, 90);
  };
  const double loss = loss_before_the_first_frame(*built, camera(0));
  ASSERT_GT(loss, 0.5);
  SoftwareBackend backend(built->scene, 4);
  for (const double allowed_db : {1000.0, 1.2 * loss, 0.4 * loss, 0.0}) {
    const bool certain = allowed_db > 2 * loss, hopeless = allowed_db < loss / 2;
    width = 160;
    MethodOptions options{.by_clock = true};
    options.loss_db = allowed_db;
    // A cache that may show no picture costs no less than polygons.
    options.error_px = 0.01;
    const Result<Method> made = make_method("auto", options, backend);
    ASSERT_TRUE(made.ok());
    int frame = 0, by_keyframes = 0;
    const auto draw = [&](double turned) {
      Camera eye = camera(frame);
      eye.world_from_eye = glm::rotate(eye.world_from_eye, turned, {0, 1, 0});
      EXPECT_TRUE(made->frames->draw(eye, frame_time(built->path, frame)).ok());
      ++frame;
      return made->frames->stats().decision.method == "keyframes";
    };
    const auto sentence = [&] { return made->frames->stats().decision.sentence(); };
    // If not at once, not while the cache captures what it sees at first, and in some frames after.
    while (frame < (certain ? 3 : 6)) EXPECT_EQ(draw(0), certain) << allowed_db << " in " << frame;
    // And are not left where the second one comes.
    for (; certain && frame < 80;) {
      (void)draw(0);
      EXPECT_EQ(sentence().find("not good enough"), std::string::npos) << frame;
    }
    // Between the two it depends on where the eye is when there are two.
    while (frame < 140) by_keyframes += draw(0);
    if (certain || hopeless) {
      EXPECT_EQ(by_keyframes > 0, certain) << allowed_db;
    }
    // An eye that turns away, but does not jump, sees what none of them shows: they go on from a
    // coarse one, though others are tried.
    for (int i = 1; certain && i <= 24; ++i) {
      (void)draw(0.4 * std::min(i, 3));
      EXPECT_EQ(sentence().find("not good enough"), std::string::npos) << sentence() << i;
    }
    if (certain) {
      // In a frame of another size, which no first frame made one for, frames of the cache make
      // two. Beside other programs they may have to be made again.
      width = 176;
      EXPECT_FALSE(draw(0));
      for (by_keyframes = 0; by_keyframes == 0 && frame < 1500;) by_keyframes += draw(0);
      EXPECT_GT(by_keyframes, 0);
    }
    // Of what the eye sees after a jump there are none.
    EXPECT_FALSE(draw(1.5));
  }
}

// The first frame finds out what direct drawing takes, and shows the cache's first one, which is
// drawn after it: the cache captures no later than alone.
TEST_F(AutoTest, where_keyframes_are_prepared_the_cache_captures_as_early_as_alone) {
  auto built = make_builtin("builtin:stonehenge?triangles=200000");
  ASSERT_TRUE(built.ok());
  std::vector<int> captures[2];
  for (const bool alone : {false, true}) {
    SoftwareBackend backend(built->scene, 4);
    MethodOptions options{.by_clock = true};
    options.loss_db = 0;
    const Result<Method> made = make_method(alone ? "cache" : "auto", options, backend);
    ASSERT_TRUE(made.ok());
    for (int i = 0; i < 3; ++i) {
      const double time = frame_time(built->path, i);
      ASSERT_TRUE(made->frames->draw(camera_at(built->path, time, 160, 90), time).ok());
      if (i > 0) captures[alone].push_back(made->frames->stats().captures);
      EXPECT_TRUE(alone || made->frames->stats().decision.method == "cache") << i;
    }
  }
  EXPECT_EQ(captures[0], captures[1]);
  EXPECT_GT(captures[0][0], 0);
}

TEST_F(AutoTest, what_only_the_cache_has_is_refused_by_its_name) {
  SoftwareBackend backend(scene_, 4);
  const Result<Method> bakes = make_method("auto", {.bake_mb = 10}, backend);
  ASSERT_FALSE(bakes.ok());
  EXPECT_EQ(bakes.error().where, "--bake-mb");
  const Result<Method> levels = make_method("auto", {.levels = true}, backend);
  ASSERT_FALSE(levels.ok());
  EXPECT_EQ(levels.error().where, "--levels");
}

}  // namespace
}  // namespace rilievo
