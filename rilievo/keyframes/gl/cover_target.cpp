#include "rilievo/keyframes/gl/cover_target.h"

#include <algorithm>
#include <string>

namespace rilievo {

Result<CoverTarget> CoverTarget::create(int width, int height, int samples) {
  CoverTarget target;
  GLint most = 1;
  glGetIntegerv(GL_MAX_DEPTH_TEXTURE_SAMPLES, &most);
  target.width_ = width, target.height_ = height;
  target.samples_ = std::clamp(samples, 1, std::max(most, 1));
  target.depth_ =
      gl::make_texture_2d_multisample(GL_DEPTH_COMPONENT32F, width, height, target.samples_);
  target.framebuffer_ = gl::make_framebuffer();
  glNamedFramebufferTexture(target.framebuffer_, GL_DEPTH_ATTACHMENT, target.depth_, 0);
  glNamedFramebufferDrawBuffer(target.framebuffer_, GL_NONE);
  if (glCheckNamedFramebufferStatus(target.framebuffer_, GL_DRAW_FRAMEBUFFER) !=
      GL_FRAMEBUFFER_COMPLETE)
    return Error{"cover", "OpenGL makes no depths of " + std::to_string(width) + " x " +
                              std::to_string(height) + " pixels"};
  return target;
}

void CoverTarget::begin() {
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, width_, height_);
  glDisable(GL_SCISSOR_TEST);
  glDepthMask(GL_TRUE);
  const GLfloat far = 1;
  glClearNamedFramebufferfv(framebuffer_, GL_DEPTH, 0, &far);
}

}  // namespace rilievo
