#include "rilievo/capture/gl/capture_layers.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "rilievo/core/expects.h"
#include "rilievo/gl/object.h"

namespace rilievo {
namespace {

// One layer of the whole picture, rows from the bottom.
struct Pass {
  std::vector<float> depth;  // window_z; 1: nothing
  std::vector<glm::vec4> color;
  std::vector<std::uint32_t> object;
};

class Peeler {
 public:
  Peeler(const Camera& camera, float least_roughness)
      : camera_(camera), least_roughness_(least_roughness) {
    const int w = camera.width, h = camera.height;
    for (gl::Texture& depth : depths_) depth = gl::make_texture_2d(GL_DEPTH_COMPONENT32F, w, h);
    color_ = gl::make_texture_2d(GL_RGBA16F, w, h);
    object_ = gl::make_texture_2d(GL_R32UI, w, h);
    objects_framebuffer_ = gl::make_framebuffer();
    color_framebuffer_ = gl::make_framebuffer();
    glNamedFramebufferTexture(objects_framebuffer_, GL_COLOR_ATTACHMENT0, object_, 0);
    glNamedFramebufferTexture(color_framebuffer_, GL_COLOR_ATTACHMENT0, color_, 0);
    const std::size_t texels = std::size_t(w) * std::size_t(h);
    pass_.depth.resize(texels), pass_.color.resize(texels), pass_.object.resize(texels);
    const GLfloat nearest = 0;
    glNamedFramebufferTexture(objects_framebuffer_, GL_DEPTH_ATTACHMENT, depths_[0], 0);
    glClearNamedFramebufferfv(objects_framebuffer_, GL_DEPTH, 0, &nearest);
  }

  [[nodiscard]] bool complete() {
    glNamedFramebufferTexture(color_framebuffer_, GL_DEPTH_ATTACHMENT, depths_[1], 0);
    return glCheckNamedFramebufferStatus(objects_framebuffer_, GL_DRAW_FRAMEBUFFER) ==
               GL_FRAMEBUFFER_COMPLETE &&
           glCheckNamedFramebufferStatus(color_framebuffer_, GL_DRAW_FRAMEBUFFER) ==
               GL_FRAMEBUFFER_COMPLETE;
  }

  // What lies behind the last pass; null if nothing does.
  const Pass* next(SceneRenderer& renderer, std::span<const std::uint32_t> objects) {
    const gl::Texture &peeled = depths_[last_], &depth = depths_[1 - last_];
    last_ = 1 - last_;
    glNamedFramebufferTexture(objects_framebuffer_, GL_DEPTH_ATTACHMENT, depth, 0);
    glNamedFramebufferTexture(color_framebuffer_, GL_DEPTH_ATTACHMENT, depth, 0);
    const GLuint nothing[] = {kNoObject, 0, 0, 0};
    const GLfloat far = 1, transparent[] = {0, 0, 0, 0};
    bind(objects_framebuffer_);
    glClearNamedFramebufferuiv(objects_framebuffer_, GL_COLOR, 0, nothing);
    glClearNamedFramebufferfv(objects_framebuffer_, GL_DEPTH, 0, &far);
    renderer.draw_objects_behind(camera_, objects, peeled);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    read(objects_framebuffer_, GL_DEPTH_COMPONENT, GL_FLOAT, pass_.depth.data());
    if (std::all_of(pass_.depth.begin(), pass_.depth.end(), [](float z) { return z == 1.0f; }))
      return nullptr;
    read(objects_framebuffer_, GL_RED_INTEGER, GL_UNSIGNED_INT, pass_.object.data());
    bind(color_framebuffer_);
    glClearNamedFramebufferfv(color_framebuffer_, GL_COLOR, 0, transparent);
    renderer.draw_at_depth(camera_, objects, least_roughness_);
    read(color_framebuffer_, GL_RGBA, GL_FLOAT, pass_.color.data());
    return &pass_;
  }

 private:
  void bind(const gl::Framebuffer& framebuffer) const {
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
    glViewport(0, 0, camera_.width, camera_.height);
    glDisable(GL_SCISSOR_TEST);
    glDepthMask(GL_TRUE);
    glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  }
  void read(const gl::Framebuffer& framebuffer, GLenum format, GLenum type, void* texels) const {
    glBindFramebuffer(GL_READ_FRAMEBUFFER, framebuffer);
    glReadPixels(0, 0, camera_.width, camera_.height, format, type, texels);
  }

  Camera camera_;
  float least_roughness_;
  gl::Texture depths_[2], color_, object_;
  gl::Framebuffer objects_framebuffer_, color_framebuffer_;
  int last_ = 0;  // which depths hold the last pass
  Pass pass_;
};

}  // namespace

Result<LayeredDepthImage> capture_layers(SceneRenderer& renderer, const Camera& camera,
                                         std::span<const std::uint32_t> objects,
                                         const PeelOptions& options) {
  if (Result<> ok = validate(camera); !ok) return ok.error();
  RILIEVO_EXPECTS(!camera.keeps_farthest());
  Peeler peeler(camera, options.least_roughness);
  if (!peeler.complete())
    return Error{"capture", "the driver refuses a float framebuffer of this size"};
  const int w = camera.width, h = camera.height;
  std::vector<std::vector<LayerSample>> lines(std::size_t(w) * std::size_t(h));
  // No line of sight crosses more surfaces; what several times as many passes do not end is noise.
  for (int pass = 0; pass < 4 * options.max_layers; ++pass) {
    const Pass* layer = peeler.next(renderer, objects);
    if (!layer) break;
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        const std::size_t i = std::size_t(h - 1 - y) * std::size_t(w) + std::size_t(x);
        if (layer->depth[i] == 1.0f) continue;
        std::vector<LayerSample>& line = lines[std::size_t(y) * std::size_t(w) + std::size_t(x)];
        LayerSample sample;
        sample.depth = sample.back =
            float(eye_z_from(DepthKind::window_z, layer->depth[i], camera, {x + 0.5, y + 0.5}));
        if (int(line.size()) >= options.max_layers ||
            (!line.empty() && double(sample.depth) - double(line.back().depth) <= options.merge))
          continue;
        sample.color = glm::vec4(glm::vec3(layer->color[i]), 1.0f);
        sample.object = layer->object[i];
        line.push_back(sample);
      }
  }
  LayeredDepthImage layers;
  layers.name = renderer.scene().name;
  layers.camera = camera;
  layers.first.reserve(lines.size() + 1);
  layers.first.push_back(0);
  for (const std::vector<LayerSample>& line : lines) {
    layers.samples.insert(layers.samples.end(), line.begin(), line.end());
    layers.first.push_back(layers.samples.size());
  }
  return layers;
}

}  // namespace rilievo
