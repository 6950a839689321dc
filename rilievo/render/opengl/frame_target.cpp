#include "rilievo/render/opengl/frame_target.h"

#include <algorithm>
#include <vector>

#include "rilievo/core/depth_image.h"
#include "rilievo/gl/flip_rows.h"

namespace rilievo {
namespace {

Result<> check_size(int width, int height) {
  GLint limit = 0;
  glGetIntegerv(GL_MAX_TEXTURE_SIZE, &limit);
  if (width < 1 || height < 1 || width > limit || height > limit)
    return Error{"frame", "size " + std::to_string(width) + "x" + std::to_string(height) +
                              " is not between 1 and " + std::to_string(limit)};
  return Done{};
}

Result<> check_complete(GLuint framebuffer) {
  if (glCheckNamedFramebufferStatus(framebuffer, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    return Error{"frame", "the driver refuses this framebuffer"};
  return Done{};
}

gl::Renderbuffer make_renderbuffer(GLenum format, int width, int height, int samples) {
  GLuint name = 0;
  glCreateRenderbuffers(1, &name);
  // 0 samples: a plain renderbuffer.
  glNamedRenderbufferStorageMultisample(name, samples > 1 ? samples : 0, format, width, height);
  return gl::Renderbuffer(name);
}

// As eye_z; `empty` is what the depths were cleared to.
Image<float> read_depths(GLuint framebuffer, int width, int height, const Camera& camera,
                         float empty) {
  Image<float> depth(width, height);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width, height, GL_DEPTH_COMPONENT, GL_FLOAT, depth.texels().data());
  gl::flip_rows(depth);
  for (float& z : depth.texels())
    z = z == empty ? kNoDepth : float(eye_z_from(DepthKind::window_z, z, camera, {0, 0}));
  return depth;
}

}  // namespace

Result<FrameTarget> FrameTarget::create(int width, int height, int samples) {
  if (Result<> ok = check_size(width, height); !ok) return ok.error();
  GLint limit = 1;
  glGetIntegerv(GL_MAX_SAMPLES, &limit);
  if (samples < 1 || samples > limit)
    return Error{"frame", "samples per pixel must be between 1 and " + std::to_string(limit)};
  FrameTarget t;
  t.width_ = width, t.height_ = height, t.samples_ = samples;
  t.color_ = make_renderbuffer(GL_RGBA8, width, height, samples);
  t.depth_ = make_renderbuffer(GL_DEPTH_COMPONENT32F, width, height, samples);
  t.framebuffer_ = gl::make_framebuffer();
  glNamedFramebufferRenderbuffer(t.framebuffer_, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, t.color_);
  glNamedFramebufferRenderbuffer(t.framebuffer_, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, t.depth_);
  if (Result<> ok = check_complete(t.framebuffer_); !ok) return ok.error();
  t.resolved_ = gl::make_texture_2d(GL_RGBA8, width, height);
  t.resolved_framebuffer_ = gl::make_framebuffer();
  glNamedFramebufferTexture(t.resolved_framebuffer_, GL_COLOR_ATTACHMENT0, t.resolved_, 0);
  if (Result<> ok = check_complete(t.resolved_framebuffer_); !ok) return ok.error();
  return t;
}

void FrameTarget::begin() {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, width_, height_);
  glDisable(GL_SCISSOR_TEST);
  glDepthMask(GL_TRUE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  const GLfloat transparent[] = {0, 0, 0, 0}, far = 1;
  glClearNamedFramebufferfv(framebuffer_, GL_COLOR, 0, transparent);
  glClearNamedFramebufferfv(framebuffer_, GL_DEPTH, 0, &far);
}

void FrameTarget::resolve() {
  glBlitNamedFramebuffer(framebuffer_, resolved_framebuffer_, 0, 0, width_, height_, 0, 0, width_,
                         height_, GL_COLOR_BUFFER_BIT, GL_NEAREST);
}

Rgba8Image FrameTarget::read() const {
  Rgba8Image image(width_, height_);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, resolved_framebuffer_);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width_, height_, GL_RGBA, GL_UNSIGNED_BYTE, image.texels().data());
  gl::flip_rows(image);
  // A frame covers the screen: what its alpha holds is of no concern to who looks at it.
  for (glm::u8vec4& texel : image.texels()) texel.a = 255;
  return image;
}

Image<float> FrameTarget::read_eye_z(const Camera& camera) const {
  const gl::Texture depth = gl::make_texture_2d(GL_DEPTH_COMPONENT32F, width_, height_);
  const gl::Framebuffer framebuffer = gl::make_framebuffer();
  glNamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, depth, 0);
  glBlitNamedFramebuffer(framebuffer_, framebuffer, 0, 0, width_, height_, 0, 0, width_, height_,
                         GL_DEPTH_BUFFER_BIT, GL_NEAREST);
  return read_depths(framebuffer, width_, height_, camera, 1);
}

Result<ProbeTarget> ProbeTarget::create(int width, int height) {
  if (Result<> ok = check_size(width, height); !ok) return ok.error();
  ProbeTarget t;
  t.width_ = width, t.height_ = height;
  t.object_ = gl::make_texture_2d(GL_R32UI, width, height);
  t.depth_ = gl::make_texture_2d(GL_DEPTH_COMPONENT32F, width, height);
  t.framebuffer_ = gl::make_framebuffer();
  glNamedFramebufferTexture(t.framebuffer_, GL_COLOR_ATTACHMENT0, t.object_, 0);
  glNamedFramebufferTexture(t.framebuffer_, GL_DEPTH_ATTACHMENT, t.depth_, 0);
  if (Result<> ok = check_complete(t.framebuffer_); !ok) return ok.error();
  return t;
}

void ProbeTarget::begin(bool keeps_farthest) {
  keeps_farthest_ = keeps_farthest;
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, width_, height_);
  glDisable(GL_SCISSOR_TEST);
  glDepthMask(GL_TRUE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  const GLuint nothing[] = {kNoObject, 0, 0, 0};
  const GLfloat far = keeps_farthest ? 0 : 1;
  glClearNamedFramebufferuiv(framebuffer_, GL_COLOR, 0, nothing);
  glClearNamedFramebufferfv(framebuffer_, GL_DEPTH, 0, &far);
}

Image<std::uint32_t> ProbeTarget::read_objects() const {
  Image<std::uint32_t> objects(width_, height_);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer_);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, width_, height_, GL_RED_INTEGER, GL_UNSIGNED_INT, objects.texels().data());
  gl::flip_rows(objects);
  return objects;
}

Image<float> ProbeTarget::read_eye_z(const Camera& camera) const {
  return read_depths(framebuffer_, width_, height_, camera, keeps_farthest_ ? 0 : 1);
}

}  // namespace rilievo
