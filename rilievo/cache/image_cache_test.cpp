#include "rilievo/cache/image_cache.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rilievo/capture/frame_target.h"
#include "rilievo/draw/direct_frames.h"
#include "rilievo/gl/context.h"
#include "rilievo/scene/builtin.h"

namespace rilievo {
namespace {

constexpr int kWidth = 320, kHeight = 180;

struct ImageCacheTest : testing::Test {
  void load(const char* spec) {
    // What lives in a context goes before it.
    probe.reset(), target.reset(), renderer.reset(), context.reset();
    auto made = gl::Context::create();
    ASSERT_TRUE(made.ok()) << made.error().message();
    context = std::move(*made);
    auto scene = make_builtin(spec);
    ASSERT_TRUE(scene.ok()) << scene.error().message();
    builtin = std::move(*scene);
    auto r = SceneRenderer::create(builtin.scene);
    ASSERT_TRUE(r.ok()) << r.error().message();
    renderer = std::make_unique<SceneRenderer>(std::move(*r));
    target = std::make_unique<FrameTarget>(std::move(*FrameTarget::create(kWidth, kHeight, 4)));
    probe = std::make_unique<ProbeTarget>(std::move(*ProbeTarget::create(kWidth, kHeight)));
  }
  Rgba8Image frame_of(FrameSource& source, int frame) {
    const double time = frame_time(builtin.path, frame);
    target->begin();
    EXPECT_TRUE(source.draw(camera_at(builtin.path, time, kWidth, kHeight), time).ok());
    target->resolve();
    return target->read();
  }

  std::unique_ptr<gl::Context> context;
  BuiltinScene builtin;
  std::unique_ptr<SceneRenderer> renderer;
  std::unique_ptr<FrameTarget> target;
  std::unique_ptr<ProbeTarget> probe;
};

double psnr_of(const Rgba8Image& a, const Rgba8Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.texels().size(); ++i)
    for (int k = 0; k < 3; ++k) {
      const double e = double(a.texels()[i][k]) - double(b.texels()[i][k]);
      sum += e * e;
    }
  return 10 * std::log10(255.0 * 255.0 / (sum / (3.0 * double(a.texels().size())) + 1e-9));
}

TEST_F(ImageCacheTest, what_is_shown_lies_within_the_bound_and_the_bound_within_the_limit) {
  for (const char* spec : {"builtin:forest?triangles=200000", "builtin:bridge?triangles=100000"}) {
    ASSERT_NO_FATAL_FAILURE(load(spec));
    for (double error_px : {0.5, 1.0, 2.0}) {
      ImageCacheOptions options;
      options.error_px = error_px;
      auto cache = ImageCache::create(*renderer, options);
      ASSERT_TRUE(cache.ok()) << cache.error().message();
      int shown = 0;
      for (int frame = 0; frame < 24; ++frame) {
        frame_of(*cache, frame);
        shown += cache->figures().pictures + cache->figures().hierarchy;
        EXPECT_LE(cache->figures().bound_px, error_px);
        std::vector<float> errors;
        cache->append_errors(3, errors);
        for (float e : errors) ASSERT_LE(e, cache->figures().bound_px + 1e-3);  // floats
      }
      EXPECT_GT(shown, 24);
    }
  }
}

TEST_F(ImageCacheTest, frames_look_like_direct_ones_and_show_the_same_objects) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:bridge?triangles=100000"));
  auto cache = ImageCache::create(*renderer, {});
  ASSERT_TRUE(cache.ok());
  DirectFrames direct(*renderer);
  for (int frame = 0; frame < 12; ++frame) {
    const Rgba8Image cached = frame_of(*cache, frame);
    if (frame % 4 != 3) continue;
    probe->begin();
    ASSERT_TRUE(cache->draw_objects().ok());
    const auto seen = probe->read_objects();
    const Rgba8Image truth = frame_of(direct, frame);
    // A pixel's error and a blur of half a texel cost some 30 dB at this size.
    EXPECT_GT(psnr_of(cached, truth), 28);
    probe->begin();
    ASSERT_TRUE(direct.draw_objects().ok());
    const auto objects = probe->read_objects();
    int wrong = 0;
    for (int y = 1; y + 1 < kHeight; ++y)
      for (int x = 1; x + 1 < kWidth; ++x) {
        bool inside = true;
        for (int dy = -1; dy <= 1; ++dy)
          for (int dx = -1; dx <= 1; ++dx) inside &= objects(x + dx, y + dy) == objects(x, y);
        wrong += inside && seen(x, y) != objects(x, y);
      }
    EXPECT_LE(wrong, kWidth * kHeight / 1000);  // 0.1 %
  }
}

TEST_F(ImageCacheTest, steady_frames_of_a_still_eye_capture_nothing) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:forest?triangles=100000"));
  auto cache = ImageCache::create(*renderer, {});
  ASSERT_TRUE(cache.ok());
  const Camera camera = camera_at(builtin.path, 0, kWidth, kHeight);
  int last = 0;
  for (int frame = 0; frame < 20; ++frame) {
    target->begin();
    ASSERT_TRUE(cache->draw(camera, 0).ok());
    last = cache->figures().captures;
  }
  EXPECT_EQ(last, 0);
  // Until the light changes.
  cache->invalidate();
  target->begin();
  ASSERT_TRUE(cache->draw(camera, 0).ok());
  EXPECT_GT(cache->figures().captures, 0);
}

TEST_F(ImageCacheTest, keeps_to_its_memory) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:forest?triangles=400000"));
  for (std::size_t mb : {16, 64}) {
    ImageCacheOptions options;
    options.max_bytes = mb << 20;
    auto cache = ImageCache::create(*renderer, options);
    ASSERT_TRUE(cache.ok()) << cache.error().message();
    for (int frame = 0; frame < 6; ++frame) {
      const Rgba8Image image = frame_of(*cache, frame);
      EXPECT_LE(cache->figures().picture_bytes, mb << 20);
      EXPECT_GT(cache->figures().polygons + cache->figures().pictures + cache->figures().hierarchy,
                3);
    }
  }
}

TEST_F(ImageCacheTest, leaves_the_callers_opengl_state_as_it_found_it) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:bridge?triangles=100000"));
  ImageCacheOptions options;
  options.outlines = true;
  auto cache = ImageCache::create(*renderer, options);
  ASSERT_TRUE(cache.ok());
  target->begin();
  // An unlikely state.
  const gl::VertexArray vertex_array = gl::make_vertex_array();
  const gl::Texture texture = gl::make_texture_2d_array(GL_RGBA8, 4, 4, 2);
  const gl::Buffer buffer = gl::make_buffer(256, nullptr);
  glBindVertexArray(vertex_array);
  glBindTextureUnit(1, texture);
  glBindBufferBase(GL_UNIFORM_BUFFER, 1, buffer);
  glDisable(GL_DEPTH_TEST);
  glDepthFunc(GL_ALWAYS);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  glCullFace(GL_FRONT);
  glViewport(0, 0, kWidth, kHeight);
  glUseProgram(0);
  const auto state = [] {
    std::vector<GLint> values;
    for (GLenum name :
         {GL_VERTEX_ARRAY_BINDING, GL_DEPTH_TEST, GL_DEPTH_FUNC, GL_BLEND, GL_BLEND_SRC_RGB,
          GL_BLEND_DST_RGB, GL_CULL_FACE, GL_CULL_FACE_MODE, GL_CURRENT_PROGRAM,
          GL_DRAW_FRAMEBUFFER_BINDING, GL_READ_FRAMEBUFFER_BINDING, GL_ACTIVE_TEXTURE,
          GL_SAMPLE_ALPHA_TO_COVERAGE, GL_SCISSOR_TEST, GL_DEPTH_WRITEMASK}) {
      GLint value = 0;
      glGetIntegerv(name, &value);
      values.push_back(value);
    }
    GLint viewport[4], bound = 0;
    glGetIntegerv(GL_VIEWPORT, viewport);
    values.insert(values.end(), viewport, viewport + 4);
    glGetIntegeri_v(GL_UNIFORM_BUFFER_BINDING, 1, &bound);
    values.push_back(bound);
    glActiveTexture(GL_TEXTURE1);
    glGetIntegerv(GL_TEXTURE_BINDING_2D_ARRAY, &bound);
    glActiveTexture(GL_TEXTURE0);
    values.push_back(bound);
    return values;
  };
  const auto before = state();
  ASSERT_TRUE(cache->draw(camera_at(builtin.path, 0, kWidth, kHeight), 0).ok());
  EXPECT_EQ(state(), before);
  EXPECT_TRUE(gl::check_errors("cache").ok());
}

}  // namespace
}  // namespace rilievo
