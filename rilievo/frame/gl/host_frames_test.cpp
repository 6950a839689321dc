// Frames in a host's framebuffer against the host's own depths, whatever its convention.
#include "rilievo/frame/gl/host_frames.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <glm/ext/matrix_clip_space.hpp>
#include <vector>

#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/core/color.h"
#include "rilievo/frame/gl/opengl_backend.h"
#include "rilievo/frame/gl/opengl_sources_test_helpers.h"
#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/gl/object.h"
#include "rilievo/method/method.h"

namespace rilievo {
namespace {

constexpr int kHostSize = 96;

// A host's framebuffer, whose depths can be read.
struct HostBuffer {
  gl::Texture color = gl::make_texture_2d(GL_RGBA8, kHostSize, kHostSize),
              depth = gl::make_texture_2d(GL_DEPTH_COMPONENT32F, kHostSize, kHostSize);
  gl::Framebuffer framebuffer = gl::make_framebuffer();

  HostBuffer() {
    glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, color, 0);
    glNamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, depth, 0);
  }
  void begin(float far) const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, kHostSize, kHostSize);
    const GLfloat black[] = {0, 0, 0, 1};
    glClearNamedFramebufferfv(framebuffer, GL_COLOR, 0, black);
    glClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, &far);
  }
  [[nodiscard]] std::vector<glm::u8vec4> colors() const {
    std::vector<glm::u8vec4> read(kHostSize * kHostSize);
    glReadPixels(0, 0, kHostSize, kHostSize, GL_RGBA, GL_UNSIGNED_BYTE, read.data());
    return read;
  }
  [[nodiscard]] std::vector<float> depths() const {
    std::vector<float> read(kHostSize * kHostSize);
    glReadPixels(0, 0, kHostSize, kHostSize, GL_DEPTH_COMPONENT, GL_FLOAT, read.data());
    return read;
  }
};

class HostFramesTest : public gl::ContextTest {
 protected:
  HostFramesTest() {
    test_shapes::add(scene_, test_shapes::sphere(0.8), {0.8f, 0.5f, 0.2f});
    test_shapes::add(scene_, test_shapes::box({1.5f, 0.3f, 0.3f}), {0.3f, 0.4f, 0.8f});
    finish(scene_);
  }
  void TearDown() override { glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE); }

  const Camera camera_ =
      look_at({1, 1.5, 5}, {0, 0, 0}, {0, 1, 0}, 0.7, kHostSize, kHostSize, 0.5, 40);
  Scene scene_;
};

TEST_F(HostFramesTest, depths_are_the_host_s_and_colours_the_same_in_every_convention) {
  Result<SceneRenderer> renderer = SceneRenderer::create(scene_);
  ASSERT_TRUE(renderer.ok());
  OpenGLFrames frames = opengl_direct(*renderer);
  const auto host_frames = HostFrames::create(frames, {1});
  ASSERT_TRUE(host_frames.ok());
  const HostBuffer buffer;
  buffer.begin(1);
  ASSERT_TRUE(frames.draw(camera_, 0).ok());
  const std::vector<glm::u8vec4> truth = buffer.colors();
  const std::vector<float> window_z = buffer.depths();
  const double n = camera_.z_near, f = camera_.z_far;
  const double a = (camera_.window.right - camera_.window.left) / 2;
  struct Convention {
    const char* name;
    ClipRange range;
    double c, e;  // of the projection: ndc_z = -c + e / d
    bool reversed;
  };
  for (const Convention& of :
       {Convention{"OpenGL", ClipRange::minus_one_to_one, -(f + n) / (f - n), -2 * f * n / (f - n),
                   false},
        Convention{"[0, 1]", ClipRange::zero_to_one, -f / (f - n), -f * n / (f - n), false},
        Convention{"reversed", ClipRange::zero_to_one, n / (f - n), f * n / (f - n), true},
        Convention{"reversed, no far plane", ClipRange::zero_to_one, 0, n, true}}) {
    SCOPED_TRACE(of.name);
    glm::dmat4 clip(0.0);
    clip[0][0] = clip[1][1] = 1 / a, clip[2][2] = of.c, clip[3][2] = of.e, clip[2][3] = -1;
    const Result<HostCamera> host =
        camera_from(eye_from_world(camera_), clip, kHostSize, kHostSize, of.range);
    ASSERT_TRUE(host.ok()) << host.error().message();
    const bool zero_to_one = of.range == ClipRange::zero_to_one;
    glClipControl(GL_LOWER_LEFT, zero_to_one ? GL_ZERO_TO_ONE : GL_NEGATIVE_ONE_TO_ONE);
    buffer.begin(of.reversed ? 0 : 1);
    ASSERT_TRUE((*host_frames)->draw(*host, 0).ok());
    GLint mode = 0;
    glGetIntegerv(GL_CLIP_DEPTH_MODE, &mode);
    EXPECT_EQ(mode, zero_to_one ? GL_ZERO_TO_ONE : GL_NEGATIVE_ONE_TO_ONE);
    const std::vector<glm::u8vec4> colors = buffer.colors();
    const std::vector<float> depths = buffer.depths();
    int shown = 0, other = 0;
    for (std::size_t i = 0; i < truth.size(); ++i) {
      for (int k = 0; k < 3; ++k)
        if (std::abs(colors[i][k] - truth[i][k]) > 2) {
          ++other;
          break;
        }
      if (window_z[i] >= 1) continue;  // the sky
      ++shown;
      const double d = f * n / (f - double(window_z[i]) * (f - n));
      const double ndc = -of.c + of.e / d, wanted = zero_to_one ? ndc : 0.5 * ndc + 0.5;
      // The camera without a far plane has another one, and other rounding at edges.
      if (std::abs(double(depths[i]) - wanted) > 2e-5) ++other;
    }
    EXPECT_GT(shown, kHostSize * kHostSize / 8);
    EXPECT_LE(other, kHostSize * kHostSize / 200);
  }
  EXPECT_EQ(glGetError(), GLenum(GL_NO_ERROR));
}

TEST_F(HostFramesTest, linear_colours_are_those_of_the_bytes) {
  Result<SceneRenderer> renderer = SceneRenderer::create(scene_);
  ASSERT_TRUE(renderer.ok());
  OpenGLFrames frames = opengl_direct(*renderer);
  const auto plain = HostFrames::create(frames, {1}),
             linear = HostFrames::create(frames, {1, true});
  ASSERT_TRUE(plain.ok() && linear.ok());
  const Result<HostCamera> host =
      camera_from(eye_from_world(camera_), clip_from_eye(camera_), kHostSize, kHostSize);
  ASSERT_TRUE(host.ok());
  const HostBuffer buffer;
  buffer.begin(1);
  ASSERT_TRUE((*plain)->draw(*host, 0).ok());
  const std::vector<glm::u8vec4> bytes = buffer.colors();
  buffer.begin(1);
  ASSERT_TRUE((*linear)->draw(*host, 0).ok());
  const std::vector<glm::u8vec4> read = buffer.colors();
  for (std::size_t i = 0; i < bytes.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const double c = bytes[i][k] / 255.0;
      const double wanted = c <= 0.04045 ? c / 12.92 : std::pow((c + 0.055) / 1.055, 2.4);
      ASSERT_NEAR(read[i][k], 255 * wanted, 1.01) << i;
    }
}

// Drawn apart, pictures look as when they are drawn into the host's frame, at silhouettes too,
// where they cover a part of a pixel.
TEST_F(HostFramesTest, linear_colours_of_pictures_are_those_of_the_bytes) {
  const auto backend = OpenGLBackend::create(scene_, 1);
  ASSERT_TRUE(backend.ok());
  const Result<Method> pictures = make_method("nailboard", {.sky = false}, **backend);
  ASSERT_TRUE(pictures.ok());
  const auto plain = HostFrames::create(*pictures->frames, {1}),
             linear = HostFrames::create(*pictures->frames, {1, true});
  const Result<HostCamera> host =
      camera_from(eye_from_world(camera_), clip_from_eye(camera_), kHostSize, kHostSize);
  ASSERT_TRUE(plain.ok() && linear.ok() && host.ok());
  const HostBuffer buffer;
  buffer.begin(1);
  ASSERT_TRUE((*plain)->draw(*host, 0).ok());
  EXPECT_GT(pictures->frames->stats().count("nailboard"), 0);
  const std::vector<glm::u8vec4> bytes = buffer.colors();
  buffer.begin(1);
  ASSERT_TRUE((*linear)->draw(*host, 0).ok());
  const std::vector<glm::u8vec4> read = buffer.colors();
  int shown = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i)
    for (int k = 0; k < 3; ++k) {
      shown += bytes[i][k] > 0;
      // Rounded once more.
      ASSERT_NEAR(read[i][k], 255 * linear_from_srgb(float(bytes[i][k]) / 255), 1.01) << i;
    }
  EXPECT_GT(shown, kHostSize * kHostSize / 8);
}

}  // namespace
}  // namespace rilievo
