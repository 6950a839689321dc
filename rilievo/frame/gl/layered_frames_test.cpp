// Against direct drawing of the same scene: the truth.
#include "rilievo/frame/gl/layered_frames.h"

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "rilievo/frame/gl/before_sky.h"
#include "rilievo/frame/gl/direct_frames.h"
#include "rilievo/frame/gl/stored_layered.h"
#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/layered_impostor/shapes_test_helpers.h"
#include "rilievo/render/opengl/frame_target.h"

namespace rilievo {
namespace {

constexpr int kSize = 160;

// Objects 1 and 2: one model, apart. 3: the same model, turned. 4: moves and turns. 5: twelve
// triangles. 6: stretches as it moves.
Scene row_of_shapes() {
  const glm::mat4 one(1);
  Scene scene;
  test_shapes::add(scene, test_shapes::torus(0.8, 0.25), {0.8f, 0.5f, 0.2f});
  for (const glm::mat4& place :
       {glm::translate(one, {3, 0.5f, 0}),
        glm::rotate(glm::translate(one, {-3, 0, 0}), 1.0f, {1, 0, 0}), one}) {
    scene.objects.push_back(scene.objects.front());
    scene.objects.back().placement = place;
  }
  test_shapes::add(scene, test_shapes::box({0.5f, 0.5f, 0.5f}), {0.3f, 0.4f, 0.8f},
                   glm::translate(one, {0, -2, 0}));
  test_shapes::add(scene, test_shapes::sphere(0.6), {0.3f, 0.7f, 0.3f});
  scene.nodes = {{-1, {0, 2, 0}}, {-1, {3, 2.4f, 0}}};
  scene.objects[3].node = 0;
  scene.objects[5].node = 1;
  using Path = Channel::Path;
  const auto linear = Channel::Interpolation::linear;
  scene.channels = {{0, Path::translation, linear, {0, 1}, {{0, 2, 0, 0}, {-1, 2.5f, 0.5f, 0}}},
                    {0, Path::rotation, linear, {0, 1}, {{0, 0, 0, 1}, {0.6f, 0, 0, 0.8f}}},
                    {1, Path::scale, linear, {0, 1}, {{1, 1, 1, 0}, {1, 1.4f, 1, 0}}}};
  scene.duration = 1;
  finish(scene);
  return scene;
}

Camera camera_from(const glm::dvec3& eye) {
  return look_at(eye, {0, 0.5, 0}, {0, 1, 0}, 0.9, kSize, kSize, 0.1, 100);
}
const glm::dvec3 kEye{2, 4, 11};

class LayeredFramesTest : public gl::ContextTest {
 protected:
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(ContextTest::SetUp());
    auto renderer = SceneRenderer::create(scene_);
    ASSERT_TRUE(renderer.ok()) << renderer.error().message();
    renderer_.emplace(std::move(*renderer));
    target_.emplace(std::move(*FrameTarget::create(kSize, kSize, 1)));
    probe_.emplace(std::move(*ProbeTarget::create(kSize, kSize)));
    options_.impostors.bake.views.spread = ViewSpread::faces_12;
    options_.impostors.bake.camera.size = 64;
    options_.impostors.bake.slicing.layers = 32;
  }

  Rgba8Image frame_of(FrameSource& source, const Camera& camera, double time = 0) {
    target_->begin();
    const Result<> drawn = source.draw(camera, time);
    EXPECT_TRUE(drawn.ok()) << (drawn.ok() ? "" : drawn.error().message());
    target_->resolve();
    return target_->read();
  }
  Image<std::uint32_t> objects_of(FrameSource& source) {
    probe_->begin();
    EXPECT_TRUE(source.draw_objects().ok());
    EXPECT_TRUE(gl::check_errors("draw").ok());
    return probe_->read_objects();
  }
  LayeredFrames make() {
    auto made = LayeredFrames::create(*renderer_, options_);
    EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().message());
    return std::move(*made);
  }

  const Scene scene_ = row_of_shapes();
  std::optional<SceneRenderer> renderer_;
  std::optional<FrameTarget> target_;
  std::optional<ProbeTarget> probe_;
  LayeredFramesOptions options_;
};

TEST_F(LayeredFramesTest, frames_are_those_of_polygons_at_any_time) {
  DirectFrames direct(*renderer_);
  for (const LayeredMethod method : {LayeredMethod::surfaces, LayeredMethod::slices}) {
    options_.layered.method = method;
    LayeredFrames frames = make();
    for (const double time : {0.0, 0.9}) {
      const Camera camera = camera_from(kEye + glm::dvec3(4 * time, 0, -6 * time));
      const Rgba8Image truth = frame_of(direct, camera, time);
      const Image<std::uint32_t> true_objects = objects_of(direct);
      const Rgba8Image frame = frame_of(frames, camera, time);
      const Image<std::uint32_t> objects = objects_of(frames);
      int covered = 0, wrong = 0, other_color = 0;
      for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
          covered += true_objects(x, y) != kNoObject;
          wrong += objects(x, y) != true_objects(x, y);
          // The sky, and the box: polygons in both.
          if (true_objects(x, y) == objects(x, y) &&
              (objects(x, y) == kNoObject || objects(x, y) == 5))
            other_color += frame(x, y) != truth(x, y);
        }
      EXPECT_GT(covered, 2000);
      // Shapes of about 25 pixels have a pixel of outline for every 6 pixels inside. Surfaces are
      // off there by less than a texel, which is half a pixel; slices also show every texel for as
      // far as it reaches in depth.
      const bool surfaces = method == LayeredMethod::surfaces;
      EXPECT_LT(wrong, covered / (surfaces ? 12 : 5)) << surfaces << " at " << time;
      EXPECT_EQ(other_color, 0);
    }
  }
}

TEST_F(LayeredFramesTest, only_objects_apart_by_a_translation_share_an_impostor) {
  LayeredFrames frames = make();
  frame_of(frames, camera_from(kEye));
  // Tori: one for objects 1, 2 and 4, which is not turned yet; one for 3; a sphere.
  EXPECT_EQ(frames.figures().captures, 3 * 12);
  EXPECT_GT(frames.figures().capture_ms, 0);
  EXPECT_EQ(frames.figures().layered, 5);
  EXPECT_EQ(frames.figures().polygons, 1);
  EXPECT_EQ(frames.figures().picture_bytes,
            3 * layered_texture_bytes(12, 64, 64, LayeredMethod::surfaces));
  frame_of(frames, camera_from(kEye), 0.5);
  EXPECT_EQ(frames.figures().captures, 0);
  EXPECT_EQ(frames.figures().capture_ms, 0);
  EXPECT_EQ(frames.figures().layered, 4);  // the sphere is stretched
  EXPECT_EQ(frames.figures().polygons, 2);
}

TEST_F(LayeredFramesTest, memory_goes_to_those_that_stand_for_most_triangles) {
  options_.impostors.max_bytes = layered_texture_bytes(12, 64, 64, LayeredMethod::surfaces) + 1;
  LayeredFrames frames = make();
  frame_of(frames, camera_from(kEye));
  EXPECT_EQ(frames.figures().captures, 12);
  EXPECT_EQ(frames.figures().layered, 3);
  EXPECT_LE(frames.figures().picture_bytes, options_.impostors.max_bytes);

  options_.impostors.max_bytes = 0;
  LayeredFrames none = make();
  DirectFrames direct(*renderer_);
  EXPECT_EQ(frame_of(none, camera_from(kEye)), frame_of(direct, camera_from(kEye)));
  EXPECT_EQ(none.figures().polygons, 6);
  EXPECT_EQ(none.figures().captures, 0);
}

TEST_F(LayeredFramesTest, what_the_eye_is_too_near_to_is_polygons) {
  LayeredFrames frames = make();
  // From above onto the torus in the middle, and past it: in the ball of its bounds (1.5 metres).
  const Camera near = look_at({0, 1.2, 0.01}, {0, 0, 0}, {0, 0, 1}, 0.9, kSize, kSize, 0.01, 100);
  frame_of(frames, near);
  EXPECT_EQ(frames.figures().layered, 0);
  EXPECT_EQ(frames.figures().polygons, 2);  // the box is below

  // Texels of 2.1 m / 64, or somewhat more, on an object 11.9 m away, in a frame with pixels of
  // 0.97 / 160 radians: about half a pixel.
  frame_of(frames, camera_from(kEye));
  EXPECT_EQ(frames.figures().layered, 5);
  options_.max_texel_px = 0.25;
  LayeredFrames fine = make();
  frame_of(fine, camera_from(kEye));
  EXPECT_EQ(fine.figures().layered, 0);
}

TEST_F(LayeredFramesTest, an_impostor_from_a_file_draws_like_the_drawer_before_the_sky) {
  const std::uint32_t torus = 2;
  options_.impostors.bake.fills = true;
  const auto baked = bake_layered(*renderer_, {&torus, 1}, options_.impostors.bake);
  ASSERT_TRUE(baked.ok()) << baked.error().message();
  const Camera camera = camera_from({-3, 3, 5});
  for (const LayeredMethod method : {LayeredMethod::surfaces, LayeredMethod::slices}) {
    auto stored = StoredLayered::create(*baked, {.method = method});
    ASSERT_TRUE(stored.ok()) << stored.error().message();
    EXPECT_EQ(stored->figures().picture_bytes, layered_texture_bytes(12, 64, 64, method));
    BeforeSky source(std::make_unique<StoredLayered>(std::move(*stored)), *renderer_);
    const Rgba8Image frame = frame_of(source, camera);
    const Image<std::uint32_t> objects = objects_of(source);

    auto pictures = LayeredPictures::create(*baked);
    auto drawer = LayeredDrawer::create();
    ASSERT_TRUE(pictures.ok() && drawer.ok());
    const LayeredInstance instance{glm::dmat4(1), torus + 1};
    target_->begin();
    drawer->draw(*pictures, camera, {&instance, 1}, {.method = method});
    target_->resolve();
    const Rgba8Image alone = target_->read();
    int covered = 0;
    for (int y = 0; y < kSize; ++y)
      for (int x = 0; x < kSize; ++x) {
        EXPECT_TRUE(objects(x, y) == kNoObject || objects(x, y) == torus + 1);
        EXPECT_EQ(frame(x, y).a, 255);
        if (objects(x, y) == kNoObject) continue;
        ++covered;
        EXPECT_EQ(frame(x, y), alone(x, y));
      }
    EXPECT_GT(covered, 500);
  }
}

}  // namespace
}  // namespace rilievo
