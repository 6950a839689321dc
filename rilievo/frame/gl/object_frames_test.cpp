// Against direct drawing of the same scene: the truth.

#include <gtest/gtest.h>

#include <glm/gtc/matrix_transform.hpp>

#include "rilievo/capture/gl/opengl_source.h"
#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/frame/gl/opengl_sources_test_helpers.h"
#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/layered_impostor/gl/layered_drawable.h"
#include "rilievo/layered_impostor/layered_kind.h"
#include "rilievo/method/objects.h"
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

class ObjectFramesTest : public gl::ContextTest {
 protected:
  void SetUp() override {
    ASSERT_NO_FATAL_FAILURE(ContextTest::SetUp());
    auto renderer = SceneRenderer::create(scene_);
    ASSERT_TRUE(renderer.ok()) << renderer.error().message();
    renderer_.emplace(std::move(*renderer));
    target_.emplace(std::move(*FrameTarget::create(kSize, kSize, 1)));
    probe_.emplace(std::move(*ProbeTarget::create(kSize, kSize)));
    options_.objects.bake = OptionValues(kind_.bake_options);
    options_.objects.draw = OptionValues(kind_.draw_options);
    for (const auto& [name, value] : {std::pair{"views", "12"}, {"size", "64"}, {"layers", "32"}})
      ASSERT_TRUE(options_.objects.bake.set(name, value).ok());
  }
  void draw_by(LayeredMethod method) {
    const bool sliced = method == LayeredMethod::slices;
    ASSERT_TRUE(options_.objects.draw.set("warp", sliced ? "slices" : "surfaces").ok());
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
  std::unique_ptr<FrameSource> make() {
    auto factory = make_layered_drawable_factory();
    EXPECT_TRUE(factory.ok()) << (factory.ok() ? "" : factory.error().message());
    OpenGLSource source(*renderer_);
    auto made =
        ObjectChooser::create(renderer_->placed(), source, kind_, std::move(*factory), options_);
    EXPECT_TRUE(made.ok()) << (made.ok() ? "" : made.error().message());
    return std::make_unique<OpenGLFrames>(*renderer_, std::move(*made));
  }

  const Kind& kind_ = layered_impostor_kind();
  const Scene scene_ = row_of_shapes();
  std::optional<SceneRenderer> renderer_;
  std::optional<FrameTarget> target_;
  std::optional<ProbeTarget> probe_;
  ObjectFramesOptions options_;
};

TEST_F(ObjectFramesTest, frames_are_those_of_polygons_at_any_time) {
  OpenGLFrames direct = opengl_direct(*renderer_);
  for (const LayeredMethod method : {LayeredMethod::surfaces, LayeredMethod::slices}) {
    draw_by(method);
    const auto frames = make();
    for (const double time : {0.0, 0.9}) {
      const Camera camera = camera_from(kEye + glm::dvec3(4 * time, 0, -6 * time));
      const Rgba8Image truth = frame_of(direct, camera, time);
      const Image<std::uint32_t> true_objects = objects_of(direct);
      const Rgba8Image frame = frame_of(*frames, camera, time);
      const Image<std::uint32_t> objects = objects_of(*frames);
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

TEST_F(ObjectFramesTest, only_objects_apart_by_a_translation_share_an_impostor) {
  const auto frames = make();
  frame_of(*frames, camera_from(kEye));
  // Tori: one for objects 1, 2 and 4, which is not turned yet; one for 3; a sphere.
  EXPECT_EQ(frames->stats().captures, 3 * 12);
  EXPECT_GT(frames->stats().capture_ms, 0);
  EXPECT_EQ(frames->stats().count(kLayeredImpostorName), 5);
  EXPECT_EQ(frames->stats().polygons, 1);
  EXPECT_EQ(frames->stats().picture_bytes,
            3 * layered_texture_bytes(12, 64, 64, LayeredMethod::surfaces));
  frame_of(*frames, camera_from(kEye), 0.5);
  EXPECT_EQ(frames->stats().captures, 0);
  EXPECT_EQ(frames->stats().capture_ms, 0);
  EXPECT_EQ(frames->stats().count(kLayeredImpostorName), 4);  // the sphere is stretched
  EXPECT_EQ(frames->stats().polygons, 2);
}

TEST_F(ObjectFramesTest, memory_goes_to_those_that_stand_for_most_triangles) {
  options_.objects.max_bytes = layered_texture_bytes(12, 64, 64, LayeredMethod::surfaces) + 1;
  const auto frames = make();
  frame_of(*frames, camera_from(kEye));
  EXPECT_EQ(frames->stats().captures, 12);
  EXPECT_EQ(frames->stats().count(kLayeredImpostorName), 3);
  EXPECT_LE(frames->stats().picture_bytes, options_.objects.max_bytes);

  options_.objects.max_bytes = 0;
  const auto none = make();
  OpenGLFrames direct = opengl_direct(*renderer_);
  EXPECT_EQ(frame_of(*none, camera_from(kEye)), frame_of(direct, camera_from(kEye)));
  EXPECT_EQ(none->stats().polygons, 6);
  EXPECT_EQ(none->stats().captures, 0);
}

TEST_F(ObjectFramesTest, what_the_eye_is_too_near_to_is_polygons) {
  const auto frames = make();
  // From above onto the torus in the middle, and past it: in the ball of its bounds (1.5 metres).
  const Camera near = look_at({0, 1.2, 0.01}, {0, 0, 0}, {0, 0, 1}, 0.9, kSize, kSize, 0.01, 100);
  frame_of(*frames, near);
  EXPECT_EQ(frames->stats().count(kLayeredImpostorName), 0);
  EXPECT_EQ(frames->stats().polygons, 2);  // the box is below

  // Texels of 2.1 m / 64, or somewhat more, on an object 11.9 m away, in a frame with pixels of
  // 0.97 / 160 radians: about half a pixel.
  frame_of(*frames, camera_from(kEye));
  EXPECT_EQ(frames->stats().count(kLayeredImpostorName), 5);
  options_.max_texel_px = 0.25;
  const auto fine = make();
  frame_of(*fine, camera_from(kEye));
  EXPECT_EQ(fine->stats().count(kLayeredImpostorName), 0);
}

TEST_F(ObjectFramesTest, an_impostor_from_a_file_draws_like_the_drawer_before_the_sky) {
  const std::uint32_t torus = 2;
  OpenGLSource source_of_pictures(*renderer_);
  const auto baked =
      bake_layered(source_of_pictures, {&torus, 1}, layered_bake_options(options_.objects.bake));
  ASSERT_TRUE(baked.ok()) << baked.error().message();
  auto drawer = LayeredDrawer::create();
  ASSERT_TRUE(drawer.ok());
  const Camera camera = camera_from({-3, 3, 5});
  for (const LayeredMethod method : {LayeredMethod::surfaces, LayeredMethod::slices}) {
    const std::uint32_t object = LayeredRepresentation(*baked).only_object();
    auto drawable = make_layered_drawable(*baked, *drawer, {.method = method});
    ASSERT_TRUE(drawable.ok()) << drawable.error().message();
    EXPECT_EQ((*drawable)->bytes(), layered_texture_bytes(12, 64, 64, method));
    OpenGLFrames source =
        opengl_stored(*renderer_, std::move(*drawable), {{glm::dmat4(1.0), 0, object}}, false);
    const Rgba8Image frame = frame_of(source, camera);
    const Image<std::uint32_t> objects = objects_of(source);

    auto pictures = LayeredPictures::create(*baked);
    ASSERT_TRUE(pictures.ok());
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
