// Frames of keyframes by OpenGL against those of processors, and against direct drawing.
#include "rilievo/keyframes/gl/opengl_painter.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <glm/gtc/matrix_transform.hpp>
#include <memory>

#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/frame/gl/opengl_backend.h"
#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/keyframes/frame_difference_test_helpers.h"
#include "rilievo/keyframes/software/keyframe_frames.h"
#include "rilievo/method/method.h"
#include "rilievo/render/opengl/frame_target.h"
#include "rilievo/scene/builtin/builtin.h"
#include "rilievo/scene/mesh_tools.h"

namespace rilievo {
namespace {

constexpr int kWidth = 192, kHeight = 120;

struct Drawn {
  Rgba8Image color;
  Image<float> eye_z;
  SeenObjects seen;
};

class OpenGLPainterTest : public gl::ContextTest {
 protected:
  void use(const Scene& scene) {
    Result<std::unique_ptr<OpenGLBackend>> made = OpenGLBackend::create(scene, 4);
    ASSERT_TRUE(made.ok()) << made.error().message();
    backend_ = std::move(*made);
    target_ = *backend_->make_target(kWidth, kHeight);
  }
  std::unique_ptr<KeyframeFrames> by_opengl(const KeyframeFramesOptions& options) {
    Result<std::unique_ptr<KeyframePainter>> painter = backend_->make_keyframe_painter();
    EXPECT_TRUE(painter.ok()) << painter.error().message();
    return std::move(*KeyframeFrames::create(backend_->scene(), {}, options, std::move(*painter)));
  }
  Drawn draw(FrameSource& source, const Camera& camera, double time) {
    const Result<> done = target_->draw(source, camera, time);
    EXPECT_TRUE(done.ok()) << (done.ok() ? "" : done.error().message());
    EXPECT_TRUE(gl::check_errors("draw").ok());
    Drawn drawn{target_->color(), target_->eye_z(), *target_->draw_objects(source)};
    EXPECT_TRUE(gl::check_errors("draw objects").ok());
    return drawn;
  }

  std::unique_ptr<OpenGLBackend> backend_;
  std::unique_ptr<BackendTarget> target_;
};

// Frames along a walk, beside those of processors and direct drawing.
struct Walk {
  double to_software = 100, to_direct = 100, software_to_direct = 100;  // PSNR, the least
  double wrong = 0, filled = 0, filled_by_software = 0, live = 0;       // shares, the means
};

class OpenGLWalkTest : public OpenGLPainterTest {
 protected:
  using CameraAt = std::function<Camera(int frame)>;
  Walk walk(const Scene& scene, const CameraAt& camera_at_frame, int frames_in_all,
            KeyframeFramesOptions options = {}) {
    options.keyframes.interval = 6;
    use(scene);
    const auto frames = by_opengl(options);
    const auto software = std::move(*KeyframeFrames::create(scene, options));
    const Method direct = std::move(*make_method("direct", {}, *backend_));
    Walk walk;
    const double each = 1.0 / frames_in_all;
    for (int i = 0; i < frames_in_all; ++i) {
      const double time = i / 60.0;
      const Camera camera = camera_at_frame(i);
      EXPECT_TRUE(software->draw(camera, time));
      const Drawn drawn = draw(*frames, camera, time);
      const Drawn truth = draw(*direct.frames, camera, time);
      const Rgba8Image& expected = software->software_target()->color();
      walk.to_software = std::min(walk.to_software, psnr_of(drawn.color, expected));
      walk.to_direct = std::min(walk.to_direct, psnr_of(drawn.color, truth.color));
      walk.software_to_direct = std::min(walk.software_to_direct, psnr_of(expected, truth.color));
      walk.wrong += each * wrong_share(drawn.seen.objects, truth.seen.objects);
      walk.filled += each * frames->shares().filled;
      walk.filled_by_software += each * software->shares().filled;
      walk.live += each * frames->live_share();
      EXPECT_EQ(frames->shares().live, software->shares().live);
      EXPECT_EQ(frames->stats().count("keyframe"), software->stats().count("keyframe"));
      EXPECT_EQ(frames->stats().bound_px, software->stats().bound_px);
      EXPECT_EQ(frames->software_target(), nullptr);
    }
    return walk;
  }
};

TEST_F(OpenGLWalkTest, LooksAsWithoutOpenGL) {
  const BuiltinScene made = *make_builtin("builtin:bridge?triangles=100000");
  const Walk seen = walk(
      made.scene,
      [&](int i) { return camera_at(made.path, frame_time(made.path, i), kWidth, kHeight); }, 30);
  // The same texels and the same rays.
  EXPECT_GT(seen.to_software, 50);
  EXPECT_GT(seen.to_direct, seen.software_to_direct - 0.1);
  EXPECT_GT(seen.filled, 0);
  EXPECT_NEAR(seen.filled, seen.filled_by_software, 0.01 * seen.filled_by_software);
  // As of processors' frames.
  EXPECT_LT(seen.wrong, 0.0035);
}

TEST_F(OpenGLWalkTest, WhatIsNearIsPolygonsAndCoversWhatIsWarped) {
  // Through a ring of stones, fast.
  const BuiltinScene made = *make_builtin("builtin:stonehenge?triangles=20000");
  KeyframeFramesOptions options;
  options.keyframes.most_travel = HUGE_VAL;
  const Walk seen = walk(
      made.scene,
      [](int i) {
        const glm::dvec3 eye(-9 + 0.3 * i + 0.01 * (i % 3), 1.7, 6);
        return look_at(eye, eye + glm::dvec3(0.8, 0, -1), {0, 1, 0}, 0.9, kWidth, kHeight, 0.1,
                       200);
      },
      60, options);
  EXPECT_GT(seen.live, 0.02);
  // OpenGL's polygons and processors' differ, by filters of textures and at edges; so do what they
  // cover. What hides a pixel only in part is not counted.
  EXPECT_GT(seen.to_direct, seen.software_to_direct - 0.5);
  EXPECT_LT(seen.wrong, 0.002);
  EXPECT_LT(seen.filled, 1.2 * seen.filled_by_software + 0.002);
}

TEST_F(OpenGLWalkTest, WhatMovesAndWhatBlendsIsDrawnOverWhatIsWarped) {
  const BuiltinScene made = *make_builtin("builtin:bridge?triangles=100000");
  Scene scene = made.scene;
  bool any = false;
  for (const Object& object : scene.objects) any = any || object.moving;
  ASSERT_TRUE(any);
  // A pane before the eye.
  const Camera first = camera_at(made.path, 0, kWidth, kHeight);
  const glm::vec3 place(first.position() + 6.0 * first.forward());
  test_shapes::add(scene, test_shapes::box({1.5f, 0.8f, 0.01f}), {0.2f, 0.9f, 0.3f},
                   glm::translate(glm::mat4(1), place));
  make_flat(scene.meshes.back());
  Material& pane = scene.materials[std::size_t(scene.meshes.back().material)];
  pane.alpha_mode = AlphaMode::blend;
  pane.base_color.a = 0.5f;
  finish(scene);
  const Walk seen = walk(
      scene, [&](int i) { return camera_at(made.path, frame_time(made.path, i), kWidth, kHeight); },
      20);
  EXPECT_GT(seen.to_software, 40);
  EXPECT_GT(seen.to_direct, seen.software_to_direct - 0.2);
}

// By name, in targets of several sizes; and steady frames make no program.
TEST_F(OpenGLPainterTest, FramesMayChangeTheirSize) {
  const BuiltinScene made = *make_builtin("builtin:stonehenge?triangles=20000");
  use(made.scene);
  MethodOptions options;
  const Method keyframes = std::move(*make_method("keyframes", options, *backend_)),
               direct = std::move(*make_method("direct", {}, *backend_));
  EXPECT_EQ(keyframes.frames->software_target(), nullptr);
  std::size_t programs = 0;
  for (const int size : {64, 150, 90, 150}) {
    target_ = *backend_->make_target(2 * size, size);
    for (int i = 0; i < 2; ++i) {
      const double time = frame_time(made.path, i);
      const Camera camera = camera_at(made.path, time, 2 * size, size);
      const Drawn drawn = draw(*keyframes.frames, camera, time);
      EXPECT_GT(psnr_of(drawn.color, draw(*direct.frames, camera, time).color), 25) << size;
      if (programs == 0) programs = gl::programs_made();
    }
  }
  EXPECT_EQ(gl::programs_made(), programs);
}

// Whatever another program has set, frames are the same, and it finds what it has set.
TEST_F(OpenGLPainterTest, TheStateOfOpenGLIsLeftAsItWas) {
  const BuiltinScene made = *make_builtin("builtin:teapots?triangles=20000");
  use(made.scene);
  KeyframeFramesOptions options;
  options.keyframes.interval = 4;
  const auto plain = by_opengl(options), disturbed = by_opengl(options);
  Result<FrameTarget> target = FrameTarget::create(kWidth, kHeight, 4);
  const auto draw_into = [&](FrameSource& source, int frame, bool disturbs) {
    const double time = frame_time(made.path, frame);
    target->begin();
    const gl::Texture texture = gl::make_texture_2d(GL_RGBA8, 2, 2);
    const gl::Buffer buffer = gl::make_buffer(64, nullptr);
    if (disturbs) {
      for (const GLenum capability :
           {GL_BLEND, GL_CULL_FACE, GL_POLYGON_OFFSET_FILL, GL_SAMPLE_ALPHA_TO_COVERAGE})
        glEnable(capability);
      glDisable(GL_DEPTH_TEST);
      glCullFace(GL_FRONT);
      glDepthFunc(GL_GREATER);
      glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
      glPixelStorei(GL_UNPACK_ROW_LENGTH, 7);
      glPixelStorei(GL_PACK_SKIP_ROWS, 3);
      glBindTextureUnit(4, texture);
      glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, buffer);
      glBindBufferBase(GL_UNIFORM_BUFFER, 0, buffer);
    }
    EXPECT_TRUE(source.draw(camera_at(made.path, time, kWidth, kHeight), time).ok());
    EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
    if (disturbs) {
      for (const GLenum capability :
           {GL_BLEND, GL_CULL_FACE, GL_POLYGON_OFFSET_FILL, GL_SAMPLE_ALPHA_TO_COVERAGE}) {
        EXPECT_TRUE(glIsEnabled(capability)) << capability;
        glDisable(capability);
      }
      EXPECT_FALSE(glIsEnabled(GL_DEPTH_TEST));
      const auto is = [](GLenum name, GLint expected) {
        GLint values[4] = {};
        glGetIntegerv(name, values);
        EXPECT_EQ(values[0], expected) << name;
      };
      is(GL_CULL_FACE_MODE, GL_FRONT), is(GL_DEPTH_FUNC, GL_GREATER);
      is(GL_POLYGON_MODE, GL_LINE);
      is(GL_UNPACK_ROW_LENGTH, 7), is(GL_PACK_SKIP_ROWS, 3);
      is(GL_DRAW_FRAMEBUFFER_BINDING, GLint(target->framebuffer()));
      GLint bound = 0;
      glActiveTexture(GL_TEXTURE4);
      is(GL_TEXTURE_BINDING_2D, GLint(GLuint(texture)));
      glActiveTexture(GL_TEXTURE0);
      glGetIntegeri_v(GL_SHADER_STORAGE_BUFFER_BINDING, 1, &bound);
      EXPECT_EQ(bound, GLint(GLuint(buffer)));
      glGetIntegeri_v(GL_UNIFORM_BUFFER_BINDING, 0, &bound);
      EXPECT_EQ(bound, GLint(GLuint(buffer)));
      glCullFace(GL_BACK);
      glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
      glPixelStorei(GL_UNPACK_ROW_LENGTH, 0);
      glPixelStorei(GL_PACK_SKIP_ROWS, 0);
    }
    target->resolve();
    return target->read();
  };
  for (int i = 0; i < 6; ++i)
    EXPECT_EQ(draw_into(*plain, i, false), draw_into(*disturbed, i, true)) << i;
}

}  // namespace
}  // namespace rilievo
