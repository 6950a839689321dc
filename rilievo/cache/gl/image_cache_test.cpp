
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "rilievo/cache/gl/scene_test_helpers.h"
#include "rilievo/capture/gl/opengl_source.h"
#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/frame/gl/opengl_sources_test_helpers.h"
#include "rilievo/gl/state_guard.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/representation/bake_objects.h"
#include "rilievo/representation/gl/factories.h"
#include "rilievo/representation/kinds.h"

namespace rilievo {
namespace {

using ImageCacheTest = SceneTest;

TEST_F(ImageCacheTest, the_bound_lies_within_the_limit) {
  for (const char* spec : {"builtin:forest?triangles=200000", "builtin:bridge?triangles=100000"}) {
    ASSERT_NO_FATAL_FAILURE(load(spec));
    for (double error_px : {0.5, 1.0, 2.0}) {
      ImageCacheOptions options;
      options.error_px = error_px;
      auto cache = opengl_cache(*renderer, options);
      ASSERT_TRUE(cache.ok()) << cache.error().message();
      int shown = 0;
      for (int frame = 0; frame < 24; ++frame) {
        frame_of(*cache, frame);
        shown += cache->stats().count("nailboard") + cache->stats().groups;
        EXPECT_LE(cache->stats().bound_px, error_px);
      }
      EXPECT_GT(shown, 24);
    }
  }
}

TEST_F(ImageCacheTest, frames_look_like_direct_ones_and_show_the_same_objects) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:bridge?triangles=100000"));
  auto cache = opengl_cache(*renderer, {});
  ASSERT_TRUE(cache.ok());
  OpenGLFrames direct = opengl_direct(*renderer);
  for (int frame = 0; frame < 12; ++frame) {
    const Rgba8Image cached = frame_of(*cache, frame);
    if (frame % 4 != 3) continue;
    const auto seen = objects_of(*cache);
    const Rgba8Image truth = frame_of(direct, frame);
    // A pixel's error and a blur of half a texel cost some 30 dB at this size.
    EXPECT_GT(psnr_db(cached, truth), 28);
    EXPECT_LE(wrong_inside(objects_of(direct), seen), kWidth * kHeight / 1000);  // 0.1 %
  }
}

// A fine ring that spins, through a ball that rests.
BuiltinScene spinning_ring() {
  BuiltinScene made;
  test_shapes::add(made.scene, test_shapes::torus(1.0, 0.3, 300, 200), {0.8f, 0.5f, 0.2f});
  test_shapes::add(made.scene, test_shapes::sphere(0.8), {0.3f, 0.6f, 0.3f},
                   glm::translate(glm::mat4(1), {1, 0, 0}));
  made.scene.nodes = {{-1, {}}};
  made.scene.objects[0].node = 0;
  Channel turn{0, Channel::Path::rotation, Channel::Interpolation::linear, {}, {}};
  for (int i = 0; i <= 8; ++i) {
    const float angle = 3.0f * float(i);
    turn.times.push_back(float(i));
    turn.values.push_back({std::sin(0.5f * angle), 0, 0, std::cos(0.5f * angle)});
  }
  made.scene.channels = {turn};
  made.scene.duration = 8;
  finish(made.scene);
  return made;
}

TEST_F(ImageCacheTest, what_is_baked_stands_for_what_spins) {
  ASSERT_NO_FATAL_FAILURE(load(spinning_ring()));
  const Camera camera = look_at({1, 2, 9}, {0, 0, 0}, {0, 1, 0}, 1.2, kWidth, kHeight, 0.1, 100);
  OpenGLFrames direct = opengl_direct(*renderer);
  for (const char* warp : {"surfaces", "slices"}) {
    ImageCacheOptions options;
    options.error_px = 2;
    options.capture_by = CaptureBy::opengl;  // the rasteriser would capture them in every frame
    auto cache = opengl_cache(*renderer, options);
    ASSERT_TRUE(cache.ok()) << cache.error().message();
    const Kind& kind = *kinds().front();
    auto factory = make_factory(drawable_rows(), kind.name);
    ASSERT_TRUE(factory.ok()) << factory.error().message();
    ObjectDrawablesOptions bake{OptionValues(kind.bake_options), OptionValues(kind.draw_options)};
    ASSERT_TRUE(bake.bake.set("views", "12").ok() && bake.bake.set("size", "96").ok());
    ASSERT_TRUE(bake.draw.set("warp", warp).ok());
    OpenGLSource source(*renderer);
    auto drawables = bake_object_drawables(renderer->placed(), source, kind, **factory, bake);
    ASSERT_TRUE(drawables.ok()) << drawables.error().message();
    ASSERT_EQ(drawables->size(), 2u);
    std::size_t baked_bytes = 0;
    for (const ObjectDrawable& one : *drawables) baked_bytes += one.drawable->bytes();
    cache->cache().add_alternatives(std::move(*drawables), std::move(*factory));
    for (int frame = 0; frame < 24; ++frame) {
      const double time = 0.25 * frame;  // 0.75 radians a frame: no flat picture lasts
      const Rgba8Image cached = frame_of(*cache, camera, time);
      if (frame < 20) continue;
      const FrameStats& stats = cache->stats();
      EXPECT_EQ(stats.count(kind.name), 1) << frame;    // the ring
      EXPECT_EQ(stats.count("nailboard"), 1) << frame;  // the ball, as long as it holds
      EXPECT_EQ(stats.polygons + stats.captures, 0) << frame;
      EXPECT_GT(stats.bound_px, 0);
      EXPECT_LE(stats.bound_px, options.error_px);
      EXPECT_GT(stats.picture_bytes, baked_bytes);
      const auto seen = objects_of(*cache);
      // It carries the light of the baking along: that is what differs most.
      EXPECT_GT(psnr_db(cached, frame_of(direct, camera, time)), 24);
      // The slices that a ball and a ring cut into each other: half a slice, over their border.
      EXPECT_LE(wrong_inside(objects_of(direct), seen), kWidth * kHeight / 100);
    }
    cache->cache().invalidate();
    frame_of(*cache, camera);
    EXPECT_EQ(cache->stats().count(kind.name), 0);
    EXPECT_LT(cache->stats().picture_bytes, baked_bytes + options.max_bytes);
  }
}

TEST_F(ImageCacheTest, an_object_that_changed_loses_its_pictures_and_others_keep_theirs) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:bridge?triangles=100000"));
  auto cache = opengl_cache(*renderer, {});
  ASSERT_TRUE(cache.ok());
  const Camera camera = camera_at(builtin.path, 0, kWidth, kHeight);
  const auto frame = [&] {
    frame_of(*cache, camera);
    return cache->stats().captures;
  };
  for (int i = 0; i < 30; ++i) frame();
  ASSERT_EQ(frame(), 0);
  const auto shows = [&](std::uint32_t object) {
    for (const SceneCache::Shown& shown : cache->cache().shown())
      if (shown.objects == std::vector{object}) return true;
    return false;
  };
  int tried = 0;
  for (std::uint32_t object = 0; object < builtin.scene.objects.size() && tried < 4; ++object) {
    if (!shows(object) || builtin.scene.objects[object].moving != (tried % 2 == 0)) continue;
    ++tried;
    const std::size_t before = cache->cache().shown().size();
    cache->cache().invalidate_object(object);
    frame();
    // In its place a new picture, soon, or its polygons.
    EXPECT_GE(cache->cache().shown().size() + 3, before);
    EXPECT_LE(cache->stats().captures, 3);
  }
  EXPECT_GT(tried, 0);
}

TEST_F(ImageCacheTest, steady_frames_of_a_still_eye_capture_nothing) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:forest?triangles=100000"));
  auto cache = opengl_cache(*renderer, {});
  ASSERT_TRUE(cache.ok());
  const Camera camera = camera_at(builtin.path, 0, kWidth, kHeight);
  int last = 0;
  for (int frame = 0; frame < 20; ++frame) {
    frame_of(*cache, camera);
    last = cache->stats().captures;
  }
  EXPECT_EQ(last, 0);
  // Until the light changes.
  cache->cache().invalidate();
  frame_of(*cache, camera);
  EXPECT_GT(cache->stats().captures, 0);
}

TEST_F(ImageCacheTest, keeps_to_its_memory) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:forest?triangles=400000"));
  OpenGLFrames direct = opengl_direct(*renderer);
  int most_wrong = 0;
  for (std::size_t mb : {16, 64}) {
    ImageCacheOptions options;
    options.max_bytes = mb << 20;
    auto cache = opengl_cache(*renderer, options);
    ASSERT_TRUE(cache.ok()) << cache.error().message();
    for (int frame = 0; frame < 12; ++frame) {
      const Rgba8Image image = frame_of(*cache, frame);
      EXPECT_LE(cache->stats().picture_bytes, mb << 20);
      // What finds no room for its picture is drawn all the same.
      const Image<std::uint32_t> seen = objects_of(*cache);
      static_cast<void>(frame_of(direct, frame));
      most_wrong = std::max(most_wrong, wrong_inside(objects_of(direct), seen));
      EXPECT_GT(cache->stats().polygons + cache->stats().count("nailboard") + cache->stats().groups,
                3);
    }
  }
  EXPECT_LE(most_wrong, kWidth * kHeight / 200);  // 0.5 %: texels are larger than pixels
}

TEST_F(ImageCacheTest, leaves_the_callers_opengl_state_as_it_found_it) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:bridge?triangles=100000"));
  ImageCacheOptions options;
  options.outlines = true;
  auto cache = opengl_cache(*renderer, options);
  ASSERT_TRUE(cache.ok());
  target->begin();
  // An unlikely state.
  const gl::VertexArray vertex_array = gl::make_vertex_array();
  const gl::Texture texture = gl::make_texture_2d_array(GL_RGBA8, 4, 4, 2);
  const gl::Buffer buffer = gl::make_buffer(1024, nullptr);
  glBindVertexArray(vertex_array);
  glBindTextureUnit(1, texture);
  // 256 is a multiple of any alignment that OpenGL may ask for.
  glBindBufferRange(GL_UNIFORM_BUFFER, 1, buffer, 256, 512);
  glDepthRangef(0.25f, 0.5f);
  glDisable(GL_DEPTH_TEST);
  glDepthFunc(GL_ALWAYS);
  glEnable(GL_BLEND);
  glBlendFunc(GL_ONE, GL_ONE);
  glCullFace(GL_FRONT);
  glViewport(0, 0, kWidth, kHeight);
  glUseProgram(0);
  glPixelStorei(GL_UNPACK_ROW_LENGTH, 7);
  glPixelStorei(GL_PACK_SKIP_ROWS, 3);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer);
  const auto state = [] {
    std::vector<GLint> values;
    for (GLenum name :
         {GL_VERTEX_ARRAY_BINDING, GL_DEPTH_TEST, GL_DEPTH_FUNC, GL_BLEND, GL_BLEND_SRC_RGB,
          GL_BLEND_DST_RGB, GL_CULL_FACE, GL_CULL_FACE_MODE, GL_CURRENT_PROGRAM,
          GL_DRAW_FRAMEBUFFER_BINDING, GL_READ_FRAMEBUFFER_BINDING, GL_ACTIVE_TEXTURE,
          GL_SAMPLE_ALPHA_TO_COVERAGE, GL_SCISSOR_TEST, GL_DEPTH_WRITEMASK, GL_UNPACK_ROW_LENGTH,
          GL_PACK_SKIP_ROWS, GL_PIXEL_UNPACK_BUFFER_BINDING, GL_PIXEL_PACK_BUFFER_BINDING}) {
      GLint value = 0;
      glGetIntegerv(name, &value);
      values.push_back(value);
    }
    GLint viewport[4], bound = 0;
    glGetIntegerv(GL_VIEWPORT, viewport);
    values.insert(values.end(), viewport, viewport + 4);
    glGetIntegeri_v(GL_UNIFORM_BUFFER_BINDING, 1, &bound);
    values.push_back(bound);
    for (const GLenum name : {GL_UNIFORM_BUFFER_START, GL_UNIFORM_BUFFER_SIZE}) {
      GLint64 bytes = 0;
      glGetInteger64i_v(name, 1, &bytes);
      values.push_back(GLint(bytes));
    }
    GLfloat depth_range[2];
    glGetFloatv(GL_DEPTH_RANGE, depth_range);
    for (const GLfloat depth : depth_range) values.push_back(GLint(1000 * depth));
    values.push_back(glIsEnabled(GL_TEXTURE_CUBE_MAP_SEAMLESS));
    for (const GLenum name : {GL_TEXTURE_BINDING_CUBE_MAP, GL_TEXTURE_BINDING_2D_MULTISAMPLE}) {
      glGetIntegerv(name, &bound);
      values.push_back(bound);
    }
    glActiveTexture(GL_TEXTURE1);
    glGetIntegerv(GL_TEXTURE_BINDING_2D_ARRAY, &bound);
    glActiveTexture(GL_TEXTURE0);
    values.push_back(bound);
    return values;
  };
  const auto before = state();
  ASSERT_TRUE(cache->draw(camera_at(builtin.path, 0, kWidth, kHeight), 0).ok());
  EXPECT_EQ(state(), before);
  // What this cache does not change, and other kinds do.
  GLuint other[2];
  glCreateTextures(GL_TEXTURE_CUBE_MAP, 1, &other[0]);
  glCreateTextures(GL_TEXTURE_2D_MULTISAMPLE, 1, &other[1]);
  {
    const gl::StateGuard guard;
    glEnable(GL_TEXTURE_CUBE_MAP_SEAMLESS);
    for (const GLuint one : other) glBindTextureUnit(0, one);
    EXPECT_NE(state(), before);
  }
  EXPECT_EQ(state(), before);
  glDeleteTextures(2, other);
  EXPECT_TRUE(gl::check_errors("cache").ok());
}

TEST_F(ImageCacheTest, draws_the_same_in_whatever_state_the_caller_left_opengl) {
  ASSERT_NO_FATAL_FAILURE(load("builtin:bridge?triangles=100000"));
  GLuint sampler = 0;
  glCreateSamplers(1, &sampler);
  glSamplerParameteri(sampler, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
  glSamplerParameteri(sampler, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
  const gl::Buffer buffer = gl::make_buffer(16, nullptr);
  constexpr GLenum kOddPixels[] = {GL_UNPACK_ROW_LENGTH, GL_UNPACK_SKIP_ROWS, GL_UNPACK_SWAP_BYTES,
                                   GL_PACK_ROW_LENGTH, GL_PACK_SKIP_PIXELS};
  constexpr GLenum kOdd[] = {GL_CLIP_DISTANCE0,  GL_CLIP_DISTANCE3, GL_DEPTH_CLAMP,
                             GL_BLEND,           GL_CULL_FACE,      GL_POLYGON_OFFSET_FILL,
                             GL_FRAMEBUFFER_SRGB};
  // Captures in the first frame, pictures in the later ones; a fresh cache for each state.
  const auto drawn = [&](CaptureBy by, bool oddly, bool scissored) {
    ImageCacheOptions options;
    options.capture_by = by;
    auto cache = opengl_cache(*renderer, options);
    EXPECT_TRUE(cache.ok());
    Rgba8Image image;
    for (int frame = 0; frame < 3; ++frame) {
      target->begin();
      if (oddly) {
        for (const GLenum capability : kOdd) glEnable(capability);
        glBlendFunc(GL_ONE, GL_ONE);
        glPolygonOffset(-50, -50);
        glPolygonMode(GL_FRONT_AND_BACK, GL_LINE);
        for (GLuint unit = 0; unit < 3; ++unit) glBindSampler(unit, sampler);
        for (const GLenum mode : kOddPixels) glPixelStorei(mode, 1);
        glBindBuffer(GL_PIXEL_UNPACK_BUFFER, buffer);
        glBindBuffer(GL_PIXEL_PACK_BUFFER, buffer);
      }
      if (scissored) {
        glEnable(GL_SCISSOR_TEST);
        glScissor(0, 0, kWidth / 2, kHeight);
      }
      EXPECT_TRUE(
          cache->draw(camera_at(builtin.path, frame_time(builtin.path, frame), kWidth, kHeight), 0)
              .ok());
      for (const GLenum capability : kOdd) glDisable(capability);
      glDisable(GL_SCISSOR_TEST);
      glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
      for (GLuint unit = 0; unit < 3; ++unit) glBindSampler(unit, 0);
      for (const GLenum mode : kOddPixels) glPixelStorei(mode, 0);
      glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
      glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
      target->resolve();
      image = target->read();
    }
    return image;
  };
  EXPECT_EQ(drawn(CaptureBy::opengl, true, false), drawn(CaptureBy::opengl, false, false));
  const Rgba8Image plain = drawn(CaptureBy::rasterizer, false, false);
  EXPECT_EQ(drawn(CaptureBy::rasterizer, true, false), plain);
  const Rgba8Image part = drawn(CaptureBy::rasterizer, false, true);
  glDeleteSamplers(1, &sampler);
  // The caller's scissor is no such state: it says where the frame is.
  for (int y = 0; y < kHeight; ++y)
    for (int x = 0; x < kWidth; ++x)
      ASSERT_EQ(part(x, y), x < kWidth / 2 ? plain(x, y) : glm::u8vec4(0, 0, 0, 255))
          << x << " " << y;
}

}  // namespace
}  // namespace rilievo
