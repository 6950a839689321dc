#include "rilievo/capture/gl/capture_picture.h"

#include <algorithm>
#include <vector>

#include "rilievo/gl/flip_rows.h"
#include "rilievo/render/opengl/frame_target.h"

namespace rilievo {
namespace {

// Linear colour, resolved; row 0 on top. Coverage in alpha: the clear is 0, what is drawn is 1.
Result<ColorImage> draw_color(SceneRenderer& renderer, const Camera& camera,
                              std::span<const std::uint32_t> objects,
                              const CaptureOptions& options) {
  const int w = camera.width, h = camera.height;
  const auto renderbuffer = [&](GLenum format) {
    GLuint name = 0;
    glCreateRenderbuffers(1, &name);
    glNamedRenderbufferStorageMultisample(name, options.samples > 1 ? options.samples : 0, format,
                                          w, h);
    return gl::Renderbuffer(name);
  };
  const gl::Renderbuffer color = renderbuffer(GL_RGBA16F),
                         depth = renderbuffer(GL_DEPTH_COMPONENT32F);
  const gl::Framebuffer framebuffer = gl::make_framebuffer(), resolved = gl::make_framebuffer();
  glNamedFramebufferRenderbuffer(framebuffer, GL_COLOR_ATTACHMENT0, GL_RENDERBUFFER, color);
  glNamedFramebufferRenderbuffer(framebuffer, GL_DEPTH_ATTACHMENT, GL_RENDERBUFFER, depth);
  const gl::Texture texture = gl::make_texture_2d(GL_RGBA16F, w, h);
  glNamedFramebufferTexture(resolved, GL_COLOR_ATTACHMENT0, texture, 0);
  if (glCheckNamedFramebufferStatus(framebuffer, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    return Error{"capture", "the driver refuses a float framebuffer of this size"};

  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, w, h);
  glDisable(GL_SCISSOR_TEST);
  glDepthMask(GL_TRUE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  const GLfloat transparent[] = {0, 0, 0, 0}, beaten = camera.keeps_farthest() ? 0 : 1;
  glClearNamedFramebufferfv(framebuffer, GL_COLOR, 0, transparent);
  glClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, &beaten);
  renderer.draw_opaque(camera, objects, OutputEncoding::linear);
  if (options.with_sky) renderer.draw_sky(camera, OutputEncoding::linear);
  glBlitNamedFramebuffer(framebuffer, resolved, 0, 0, w, h, 0, 0, w, h, GL_COLOR_BUFFER_BIT,
                         GL_NEAREST);
  ColorImage image(w, h);
  glBindFramebuffer(GL_READ_FRAMEBUFFER, resolved);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, w, h, GL_RGBA, GL_FLOAT, image.texels().data());
  gl::flip_rows(image);
  return image;
}

}  // namespace

Result<DepthImage> capture_picture(SceneRenderer& renderer, const Camera& camera,
                                   std::span<const std::uint32_t> objects,
                                   const CaptureOptions& options) {
  if (Result<> ok = validate(camera); !ok) return ok.error();
  // Depth and identifiers at the texels' centres, where they mean one surface ...
  Result<ProbeTarget> probe = ProbeTarget::create(camera.width, camera.height);
  if (!probe) return probe.error();
  probe->begin(camera.keeps_farthest());
  renderer.draw_objects(camera, objects);
  DepthImage picture;
  picture.name = renderer.scene().name;
  picture.camera = camera;
  picture.depth_kind = DepthKind::eye_z;
  picture.depth = probe->read_eye_z(camera);
  if (options.objects) picture.object = probe->read_objects();

  // ... and colours averaged over the texel.
  Result<ColorImage> color = draw_color(renderer, camera, objects, options);
  if (!color) return color.error();
  picture.color = std::move(*color);
  if (!options.with_sky)
    for (std::size_t i = 0; i < picture.depth.texels().size(); ++i)
      if (picture.depth.texels()[i] == kNoDepth) picture.color.texels()[i] = glm::vec4(0.0f);
  return picture;
}

Result<Image<float>> capture_nearest(SceneRenderer& renderer, const Camera& camera,
                                     std::span<const std::uint32_t> objects) {
  if (Result<> ok = validate(camera); !ok) return ok.error();
  Result<ProbeTarget> probe = ProbeTarget::create(camera.width, camera.height);
  if (!probe) return probe.error();
  probe->begin(false);
  renderer.draw_objects(camera, objects);
  return probe->read_eye_z(camera);
}

Result<Image<float>> capture_farthest(SceneRenderer& renderer, const Camera& camera,
                                      std::span<const std::uint32_t> objects) {
  if (Result<> ok = validate(camera); !ok) return ok.error();
  Result<ProbeTarget> probe = ProbeTarget::create(camera.width, camera.height);
  if (!probe) return probe.error();
  probe->begin(!camera.keeps_farthest());
  renderer.draw_hindmost(camera, objects);
  return probe->read_eye_z(camera);
}

Result<DepthImage> capture_picture(SceneRenderer& renderer, const Camera& camera,
                                   const CaptureOptions& options) {
  std::vector<std::uint32_t> visible;
  renderer.cull(camera, visible);
  return capture_picture(renderer, camera, visible, options);
}

}  // namespace rilievo
