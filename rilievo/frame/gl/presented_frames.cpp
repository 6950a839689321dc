#include "rilievo/frame/gl/presented_frames.h"

#include <utility>

#include "rilievo/core/expects.h"
#include "rilievo/frame/gl/present_pass.h"
#include "rilievo/gl/state_guard.h"
#include "rilievo/kind/drawable.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo {
namespace {

// With d = eye_z: window_z = f (d - n) / (d (f - n)) = f / (f - n) (1 - n / d).
DepthMap from_inverse_z(const Camera& camera) {
  const double n = camera.z_near, f = camera.z_far;
  return {float(f / (f - n)), float(-n * f / (f - n)), false};
}

}  // namespace

struct PresentedFrames::Textures {
  PresentPass pass;
  int width = 0, height = 0;
  gl::Texture color, objects, depth;

  void resize(int new_width, int new_height) {
    if (width == new_width && height == new_height) return;
    width = new_width, height = new_height;
    color = gl::make_texture_2d(GL_RGBA8, width, height);
    objects = gl::make_texture_2d(GL_R32UI, width, height);
    depth = gl::make_texture_2d(GL_R32F, width, height);
    // Without filters: integers cannot be read with them.
    for (const GLuint texture : {GLuint(color), GLuint(objects), GLuint(depth)}) {
      glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
      glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
    }
  }
};

PresentedFrames::PresentedFrames(std::unique_ptr<FrameSource> frames)
    : frames_(std::move(frames)) {}
PresentedFrames::~PresentedFrames() = default;

Result<std::unique_ptr<PresentedFrames>> PresentedFrames::create(
    std::unique_ptr<FrameSource> frames) {
  RILIEVO_EXPECTS(frames && frames->software_target());
  Result<PresentPass> pass = PresentPass::create();
  if (!pass) return pass.error();
  std::unique_ptr<PresentedFrames> made(new PresentedFrames(std::move(frames)));
  made->textures_ = std::make_unique<Textures>();
  made->textures_->pass = std::move(*pass);
  return {std::move(made)};
}

void PresentedFrames::upload(const Camera& camera, Output output) {
  const SoftwareTarget& frame = *frames_->software_target();
  Textures& t = *textures_;
  t.resize(frame.width(), frame.height());
  const gl::StateGuard guard;
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  const auto put = [&](const gl::Texture& texture, GLenum format, GLenum type, const void* data) {
    glTextureSubImage2D(texture, 0, 0, 0, t.width, t.height, format, type, data);
  };
  put(t.depth, GL_RED, GL_FLOAT, frame.inverse_z().texels().data());
  const PresentedTextures textures{t.color, t.objects, t.depth, 1, true};
  if (output == Output::color) {
    put(t.color, GL_RGBA, GL_UNSIGNED_BYTE, frame.color().texels().data());
    t.pass.draw_color(textures, from_inverse_z(camera), frame.samples());
  } else {
    put(t.objects, GL_RED_INTEGER, GL_UNSIGNED_INT, frame.objects().texels().data());
    t.pass.draw_objects(textures, from_inverse_z(camera));
  }
}

Result<> PresentedFrames::draw(const Camera& camera, double time) {
  camera_ = camera;
  if (Result<> drawn = frames_->draw(camera, time); !drawn) return drawn;
  upload(camera, Output::color);
  return Done{};
}

Result<> PresentedFrames::draw_objects() {
  if (Result<> drawn = frames_->draw_objects(); !drawn) return drawn;
  upload(camera_, Output::object_id);
  return Done{};
}

}  // namespace rilievo
