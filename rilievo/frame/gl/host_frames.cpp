#include "rilievo/frame/gl/host_frames.h"

#include <cmath>
#include <utility>

#include "rilievo/frame/gl/present_pass.h"
#include "rilievo/gl/state_guard.h"

namespace rilievo {
namespace {

// With d = eye_z, window_z of a camera: f / (f - n) - f n / (f - n) / d.
struct WindowDepth {
  double offset, scale;
};
WindowDepth window_depth(const Camera& camera) {
  const double n = camera.z_near, f = camera.z_far;
  return {f / (f - n), -f * n / (f - n)};
}

// Are these the same but for the rounding of a depth buffer?
bool same_depths(const HostCamera& host) {
  const WindowDepth own = window_depth(host.camera);
  return std::abs(host.depth_offset - own.offset) < 1e-7 &&
         std::abs(host.depth_scale / own.scale - 1) < 1e-7;
}

}  // namespace

// A framebuffer of its own, whose depths can be read.
struct HostFrames::Target {
  PresentPass pass;
  int width = 0, height = 0;
  gl::Texture color, resolved, depth;
  gl::Framebuffer framebuffer, resolved_framebuffer;

  Result<> resize(int new_width, int new_height, int samples) {
    if (width == new_width && height == new_height) return Done{};
    width = new_width, height = new_height;
    const auto make = [&](GLenum format) {
      return samples > 1 ? gl::make_texture_2d_multisample(format, width, height, samples)
                         : gl::make_texture_2d(format, width, height);
    };
    color = make(GL_RGBA8), depth = make(GL_DEPTH_COMPONENT32F);
    framebuffer = gl::make_framebuffer();
    glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, color, 0);
    glNamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, depth, 0);
    resolved = gl::make_texture_2d(GL_RGBA8, width, height);
    resolved_framebuffer = gl::make_framebuffer();
    glNamedFramebufferTexture(resolved_framebuffer, GL_COLOR_ATTACHMENT0, resolved, 0);
    for (const GLuint made : {GLuint(framebuffer), GLuint(resolved_framebuffer)})
      if (glCheckNamedFramebufferStatus(made, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
        return Error{"frame", "the driver refuses this framebuffer"};
    return Done{};
  }
  void begin() const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, width, height);
    glDisable(GL_SCISSOR_TEST);
    glDepthMask(GL_TRUE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
    const GLfloat transparent[] = {0, 0, 0, 0}, far = 1;
    glClearNamedFramebufferfv(framebuffer, GL_COLOR, 0, transparent);
    glClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, &far);
  }
  void resolve() const {
    glBlitNamedFramebuffer(framebuffer, resolved_framebuffer, 0, 0, width, height, 0, 0, width,
                           height, GL_COLOR_BUFFER_BIT, GL_NEAREST);
  }
};

HostFrames::HostFrames(FrameSource& frames, const HostOptions& options)
    : frames_(frames), options_(options), target_(std::make_unique<Target>()) {}
HostFrames::~HostFrames() = default;

Result<std::unique_ptr<HostFrames>> HostFrames::create(FrameSource& frames,
                                                       const HostOptions& options) {
  Result<PresentPass> pass = PresentPass::create();
  if (!pass) return pass.error();
  std::unique_ptr<HostFrames> made(new HostFrames(frames, options));
  made->target_->pass = std::move(*pass);
  return {std::move(made)};
}

Result<> HostFrames::draw(const HostCamera& host, double time) {
  const Camera& camera = host.camera;
  if (!options_.linear && same_depths(host)) return frames_.draw(camera, time);
  const gl::StateGuard guard;
  if (Result<> made = target_->resize(camera.width, camera.height, options_.samples); !made)
    return made;
  target_->begin();
  if (Result<> drawn = frames_.draw(camera, time); !drawn) return drawn;
  target_->resolve();
  guard.bind_frame();
  // From window_z w = own.offset + own.scale / d to the host's depth.
  const WindowDepth own = window_depth(camera);
  const double scale = host.depth_scale / own.scale;
  const DepthMap depths{float(host.depth_offset - scale * own.offset), float(scale), host.reversed};
  target_->pass.draw_color({target_->resolved, 0, target_->depth, options_.samples, false}, depths,
                           options_.samples, options_.linear);
  return Done{};
}

}  // namespace rilievo
