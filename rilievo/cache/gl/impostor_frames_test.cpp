// Frames in which some objects are relief impostors, ray-traced among polygons.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <thread>

#include "rilievo/cache/gl/scene_test_helpers.h"
#include "rilievo/capture/callable_source.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/frame/gl/opengl_sources_test_helpers.h"
#include "rilievo/measure/psnr.h"

namespace rilievo {
namespace {

class ImpostorFramesTest : public SceneTest {
 protected:
  std::unique_ptr<TestSource> frames_with(const ImpostorContentOptions& shown,
                                          bool background = false, int samples = 1) {
    renderer->set_time(0);
    Result<ImpostorContent> content = make_impostor_content(renderer->scene(), 0, shown);
    EXPECT_TRUE(content.ok()) << (content.ok() ? "" : content.error().message());
    ImpostorFramesOptions options;
    options.workers.size = 128;
    options.workers.samples = samples;
    options.background = background;
    auto frames = opengl_impostors(*renderer, std::move(*content), options);
    EXPECT_TRUE(frames.ok());
    return std::make_unique<TestSource>(std::move(*frames));
  }
  // Eyes of an arc around the scene, a few degrees from one to the next.
  Camera on_arc(int frame) const {
    const Box box = world_bounds(builtin.scene);
    const double angle = 0.05 * frame, away = 1.6 * double(box.radius());
    return look_at(
        glm::dvec3(box.center()) + away * glm::dvec3(std::sin(angle), 0.3, std::cos(angle)),
        glm::dvec3(box.center()), {0, 1, 0}, 0.8, kWidth, kHeight, 0.05 * away, 10 * away);
  }
};

TEST_F(ImpostorFramesTest, frames_do_not_depend_on_the_number_of_workers) {
  load("builtin:teapots?triangles=10000");
  std::vector<Rgba8Image> first;
  for (const int workers : {1, 3}) {
    const auto frames = frames_with({.objects = {"#1", "#2", "#3"}, .workers = workers});
    int captures = 0, drawn = 0;
    for (int frame = 0; frame < 6; ++frame) {
      const Rgba8Image seen = frame_of(*frames, on_arc(frame));
      captures += frames->stats().captures;
      drawn += frames->stats().count(kReliefImpostorName);
      if (workers == 1) first.push_back(seen);
      EXPECT_EQ(std::vector(seen.texels().begin(), seen.texels().end()),
                std::vector(first[std::size_t(frame)].texels().begin(),
                            first[std::size_t(frame)].texels().end()));
    }
    // All of them in all frames, most of them warped.
    EXPECT_EQ(drawn, 18);
    EXPECT_GE(captures, 3);
    EXPECT_LT(captures, 18);
  }
}

TEST_F(ImpostorFramesTest, the_second_walk_with_the_same_store_renders_nothing_new) {
  load("builtin:teapots?triangles=10000");
  const TemporaryFolder folder;
  const std::string store = (folder.path() / "walk.db").string();
  std::vector<Rgba8Image> first;
  for (const int walk : {0, 1}) {
    const auto frames = frames_with({.objects = {"#1", "#2"}, .workers = walk + 1, .store = store});
    for (int frame = 0; frame < 8; ++frame) {
      const Rgba8Image seen = frame_of(*frames, on_arc(frame));
      if (walk == 0) first.push_back(seen);
      EXPECT_TRUE(std::equal(seen.texels().begin(), seen.texels().end(),
                             first[std::size_t(frame)].texels().begin()));
    }
    if (walk == 0) {
      EXPECT_GT(frames->chooser().impostors().rendered(), 2u);
    } else {
      EXPECT_EQ(frames->chooser().impostors().rendered(), 0u);
      EXPECT_GT(frames->chooser().impostors().found(), 2u);
    }
  }
}

TEST_F(ImpostorFramesTest, impostors_and_polygons_hide_each_other_as_polygons_do) {
  load("builtin:teapots?triangles=10000");
  OpenGLFrames direct = opengl_direct(*renderer);
  const auto frames = frames_with({.objects = {"#0", "#2", "#5"}});
  for (const int frame : {0, 7, 20}) {
    (void)frame_of(direct, on_arc(frame));
    const Image<std::uint32_t> truth = objects_of(direct);
    (void)frame_of(*frames, on_arc(frame));
    // Edges differ by a pixel; depths of impostors have 12 bits between their nearest and farthest.
    EXPECT_LT(wrong_inside(truth, objects_of(*frames)), kWidth * kHeight / 400) << frame;
  }
}

TEST_F(ImpostorFramesTest, a_steady_camera_renders_and_warps_nothing) {
  load("builtin:teapots?triangles=10000");
  const auto frames = frames_with({.objects = {"#1", "#2"}});
  const Rgba8Image first = frame_of(*frames, on_arc(3));
  const WorkerStats before = frames->chooser().workers().stats();
  for (int i = 0; i < 5; ++i) {
    const Rgba8Image again = frame_of(*frames, on_arc(3));
    EXPECT_TRUE(std::equal(first.texels().begin(), first.texels().end(), again.texels().begin()));
    EXPECT_EQ(frames->stats().captures, 0);
  }
  EXPECT_EQ(frames->chooser().workers().stats().warps, before.warps);
  EXPECT_EQ(frames->chooser().workers().stats().pictures, before.pictures);
}

TEST_F(ImpostorFramesTest, a_moving_object_carries_its_impostor_along) {
  load("builtin:teapots?triangles=10000");
  std::string moving;
  for (std::size_t i = 0; i < builtin.scene.objects.size(); ++i)
    if (builtin.scene.objects[i].moving) moving = "#" + std::to_string(i);
  ASSERT_FALSE(moving.empty());
  OpenGLFrames direct = opengl_direct(*renderer);
  const auto frames = frames_with({.objects = {moving}});
  for (const double time : {0.0, 0.4, 1.1}) {
    (void)frame_of(direct, on_arc(0), time);
    const Image<std::uint32_t> truth = objects_of(direct);
    (void)frame_of(*frames, on_arc(0), time);
    EXPECT_EQ(frames->stats().count(kReliefImpostorName), 1);
    EXPECT_LT(wrong_inside(truth, objects_of(*frames)), 40) << time;
  }
}

// A shader that is never done must not be waited for.
TEST_F(ImpostorFramesTest, in_the_background_no_frame_waits) {
  load("builtin:teapots?triangles=10000");
  ImpostorContent content =
      std::move(*make_impostor_content(renderer->scene(), 0, {.objects = {"#1"}}));
  const Box box = content.sources[0]->bounds(content.impostors[0].shown.objects);
  CallableSource never("never", box, [](const CaptureRequest& request) -> Result<CapturedPicture> {
    while (!request.control->stop.stop_requested()) std::this_thread::yield();
    return Error{"never", std::string(kCaptureStopped)};
  });
  content.sources[0] = std::make_unique<KeptSource>(never, nullptr, KeptOptions{});
  ImpostorFramesOptions options;
  options.background = true;
  auto frames = opengl_impostors(*renderer, std::move(content), options);
  ASSERT_TRUE(frames.ok());
  OpenGLFrames direct = opengl_direct(*renderer);
  const Rgba8Image truth = frame_of(direct, on_arc(0));
  for (int i = 0; i < 3; ++i) {
    const Rgba8Image seen = frame_of(*frames, on_arc(0));
    EXPECT_TRUE(std::equal(truth.texels().begin(), truth.texels().end(), seen.texels().begin()));
    EXPECT_EQ(frames->stats().count(kReliefImpostorName), 0);
    EXPECT_TRUE(frames->chooser().statuses()[0].frame.rendering);
  }
}

// Between these, workers give way (frame_gate.h).
TEST_F(ImpostorFramesTest, workers_in_the_background_are_told_when_a_frame_is_drawn) {
  load("builtin:teapots?triangles=10000");
  for (const bool background : {false, true}) {
    auto frames = opengl_impostors(
        *renderer, std::move(*make_impostor_content(renderer->scene(), 0, {.objects = {"#1"}})),
        {.workers = {}, .background = background});
    ASSERT_TRUE(frames.ok());
    ImpostorChooser& chooser = frames->chooser();
    EXPECT_FALSE(chooser.workers().drawing_frame());
    FrameContent content;
    chooser.add_sets(content);
    FrameStats stats;
    ASSERT_TRUE(chooser.choose(on_arc(0), renderer->placed(), content, stats).ok());
    EXPECT_EQ(chooser.workers().drawing_frame(), background);
    ASSERT_TRUE(frames->draw(on_arc(0), 0).ok());
    EXPECT_FALSE(chooser.workers().drawing_frame());
  }
}

}  // namespace
}  // namespace rilievo
