#include "rilievo/method/audition.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <utility>
#include <vector>

#include "rilievo/frame/software/software_backend.h"
#include "rilievo/method/darker_test_helpers.h"
#include "rilievo/method/method.h"
#include "rilievo/render/placed_scene.h"
#include "rilievo/render/software/software_target.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

class AuditionTest : public ::testing::Test {
 protected:
  void SetUp() override {
    auto built = make_builtin("builtin:teapots?triangles=20000");
    ASSERT_TRUE(built.ok());
    scene_ = std::move(built->scene);
    camera_ = camera_at(built->path, 0, 320, 180);
    Result<RayScene> rays = RayScene::create(scene_);
    ASSERT_TRUE(rays.ok());
    loss_.emplace(std::move(*rays));
  }
  // A frame of direct drawing, from so many times as far away.
  ShownFrame shown(double times) {
    SoftwareBackend backend(scene_, 4);
    const Result<Method> direct = make_method("direct-raster", {}, backend);
    EXPECT_TRUE(direct.ok());
    ShownFrame shown;
    shown.camera = camera_;
    shown.camera.world_from_eye[3] =
        glm::dvec4(camera_.position() - (times - 1) * 20 * camera_.forward(), 1);
    shown.camera.z_far = 1000;
    EXPECT_TRUE(direct->frames->draw(shown.camera, 0).ok());
    shown.color = direct->frames->software_target()->color();
    shown.in_view.resize(scene_.objects.size());
    std::iota(shown.in_view.begin(), shown.in_view.end(), 0);
    return shown;
  }

  Scene scene_;
  Camera camera_;
  std::optional<FrameLoss> loss_;
};

TEST_F(AuditionTest, direct_drawing_loses_nothing_and_a_darker_frame_much) {
  const ShownFrame frame = shown(1);
  const std::optional<double> own = audition_loss(frame, frame.color, *loss_),
                              dark = audition_loss(frame, darker(frame.color, 40), *loss_);
  ASSERT_TRUE(own && dark);
  // 8192 pixels: their noise.
  EXPECT_LT(*own, 0.5);
  EXPECT_GT(*dark, 8);
}

// With the error e of direct drawing and u of a step the loss is (e + u) / max(e, u), at most two.
TEST_F(AuditionTest, what_is_off_by_a_step_of_a_byte_loses_at_most_three_decibels) {
  const ShownFrame frame = shown(1);
  const std::optional<double> loss = audition_loss(frame, darker(frame.color, 1), *loss_);
  ASSERT_TRUE(loss);
  EXPECT_GT(*loss, 0.2);
  EXPECT_LT(*loss, 3.5);
}

TEST_F(AuditionTest, small_objects_in_front_of_the_sky_are_looked_at) {
  for (const double far : {2.7, 40.0})
    EXPECT_TRUE(audition_loss(shown(far), shown(far).color, *loss_)) << far;
  // Nothing but the sky never tells.
  ShownFrame sky = shown(40);
  sky.in_view.clear();
  EXPECT_FALSE(audition_loss(sky, sky.color, *loss_));
}

TEST_F(AuditionTest, the_cache_is_judged_where_it_was_shown_and_leaves_nothing) {
  ShownFrame frame = shown(1);
  EXPECT_FALSE(cache_loss(frame, &*loss_));
  frame.by_cache = true;
  EXPECT_TRUE(cache_loss(frame, &*loss_));
  EXPECT_FALSE(cache_loss(frame, nullptr));
  EXPECT_FALSE(loss_->db());
}

// Against frames with and without what moves: no pixel that shows it is looked at.
TEST_F(AuditionTest, what_moves_is_left_out_and_what_else_is_wrong_is_found) {
  auto built = make_builtin("builtin:bridge?triangles=100000");
  ASSERT_TRUE(built.ok());
  constexpr double kTime = 4.5;
  scene_ = std::move(built->scene);
  Result<RayScene> rays = RayScene::create(scene_);
  ASSERT_TRUE(rays.ok());
  FrameLoss loss(std::move(*rays));
  SoftwareBackend backend(scene_, 4);
  const Result<Method> direct = make_method("direct-raster", {}, backend);
  ASSERT_TRUE(direct.ok());
  PlacedScene placed(scene_);
  placed.set_time(kTime);
  Scene still = scene_;
  std::erase_if(still.objects, [](const Object& object) { return object.moving; });
  finish(still);
  SoftwareBackend still_backend(still, 4);
  const Result<Method> still_direct = make_method("direct-raster", {}, still_backend);
  ASSERT_TRUE(still_direct.ok());
  for (const int i : {0, 60, 120}) {
    ShownFrame frame;
    frame.camera = camera_at(built->path, frame_time(built->path, i), 320, 180);
    frame.by_cache = true;
    placed.cull(frame.camera, frame.in_view);
    ASSERT_TRUE(direct->frames->draw(frame.camera, kTime).ok());
    frame.color = direct->frames->software_target()->color();
    const Rgba8Image with = frame.color;
    ASSERT_TRUE(still_direct->frames->draw(frame.camera, 0).ok());
    const Rgba8Image& without = still_direct->frames->software_target()->color();
    const std::optional<double> moved = cache_loss(frame, &loss);
    leave_out_moving(placed, frame);
    for (const std::uint32_t object : frame.in_view) EXPECT_FALSE(scene_.objects[object].moving);
    int covered = 0, moving = 0;
    for (std::size_t k = 0; k < with.texels().size(); ++k) {
      const bool left_out = frame.color.texels()[k] == glm::u8vec4(0, 0, 0, 1);
      covered += left_out;
      if (with.texels()[k] == without.texels()[k]) continue;
      EXPECT_TRUE(left_out) << k;
      ++moving;
    }
    EXPECT_GT(moving, 100);
    EXPECT_LT(covered, 12 * moving);
    const std::optional<double> own = cache_loss(frame, &loss);
    ShownFrame dark = frame;
    dark.color = darker(with, 40);
    placed.cull(dark.camera, dark.in_view);
    leave_out_moving(placed, dark);
    const std::optional<double> wrong = cache_loss(dark, &loss);
    ASSERT_TRUE(moved && own && wrong);
    EXPECT_LT(*own, 0.5);
    EXPECT_GT(*moved, 3);
    EXPECT_GT(*wrong, 8);
  }
}

TEST_F(AuditionTest, of_a_frame_that_what_moves_may_cover_nothing_is_known) {
  auto built = make_builtin("builtin:bridge?triangles=100000");
  ASSERT_TRUE(built.ok());
  scene_ = std::move(built->scene);
  Result<RayScene> rays = RayScene::create(scene_);
  ASSERT_TRUE(rays.ok());
  FrameLoss loss(std::move(*rays));
  PlacedScene placed(scene_);
  placed.set_time(4.5);
  const auto moving =
      std::ranges::find_if(scene_.objects, [](const Object& object) { return object.moving; });
  ASSERT_NE(moving, scene_.objects.end());
  const glm::dvec3 eye(placed.bounds()[std::size_t(moving - scene_.objects.begin())].center());
  ShownFrame frame;
  frame.camera = look_at(eye, eye + glm::dvec3(1, 0, 0.2), {0, 1, 0}, 0.9, 64, 36, 0.1, 500);
  frame.color = Rgba8Image(64, 36, glm::u8vec4(90, 90, 90, 255));
  frame.by_cache = true;
  placed.cull(frame.camera, frame.in_view);
  ShownFrame covered = frame;
  leave_out_moving(placed, covered);
  EXPECT_TRUE(cache_loss(frame, &loss));
  EXPECT_FALSE(cache_loss(covered, &loss));
}

// Keyframes would take an eye that is the same in two frames to stand.
TEST_F(AuditionTest, the_frame_before_the_one_that_is_shown_touches_memory) {
  struct Recorded final : FrameSource {
    std::vector<glm::dvec3> eyes;
    FrameStats of;
    Result<> draw(const Camera& camera, double) override {
      eyes.push_back(camera.position());
      return Done{};
    }
    Result<> draw_objects() override { return Done{}; }
    [[nodiscard]] const SoftwareTarget* software_target() const override { return nullptr; }
    [[nodiscard]] const FrameStats& stats() const override { return of; }
    [[nodiscard]] std::vector<DepthImage> read_pictures() const override { return {}; }
  } frames;
  ShownFrame frame = shown(1);
  frame.before = frame.camera;
  frame.before.world_from_eye[3][0] += 1;
  ASSERT_TRUE(begin_audition(frame, frames).ok());
  ASSERT_TRUE(time_audition(frame, frames).ok());
  EXPECT_EQ(frames.eyes, (std::vector{frame.before.position(), frame.camera.position()}));
}

TEST_F(AuditionTest, rays_say_what_a_frame_takes) {
  Result<std::unique_ptr<RayVisibility>> rays = RayVisibility::create(scene_);
  ASSERT_TRUE(rays.ok());
  const Audition found = audition_rays(shown(1), 4, **rays);
  EXPECT_GT(found.processor_ms, 0);
  EXPECT_FALSE(found.loss_db);
}

}  // namespace
}  // namespace rilievo
