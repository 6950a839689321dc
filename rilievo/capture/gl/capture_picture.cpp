#include "rilievo/capture/gl/capture_picture.h"

#include <algorithm>
#include <bit>
#include <string>
#include <vector>

#include "rilievo/capture/gl/sample_target.h"
#include "rilievo/core/texel_rule.h"
#include "rilievo/gl/flip_rows.h"
#include "rilievo/render/opengl/frame_target.h"

namespace rilievo {
namespace {

// Linear colour of one sample a texel, rows from the bottom; the clear is transparent.
Result<ColorImage> draw_centers(SceneRenderer& renderer, const Camera& camera,
                                std::span<const std::uint32_t> objects, bool with_sky) {
  const int w = camera.width, h = camera.height;
  const gl::Texture color = gl::make_texture_2d(GL_RGBA16F, w, h),
                    depth = gl::make_texture_2d(GL_DEPTH_COMPONENT32F, w, h);
  const gl::Framebuffer framebuffer = gl::make_framebuffer();
  glNamedFramebufferTexture(framebuffer, GL_COLOR_ATTACHMENT0, color, 0);
  glNamedFramebufferTexture(framebuffer, GL_DEPTH_ATTACHMENT, depth, 0);
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
  if (!objects.empty()) renderer.draw_opaque(camera, objects, OutputEncoding::linear);
  if (with_sky) renderer.draw_sky(camera, OutputEncoding::linear);
  ColorImage image(w, h);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glReadPixels(0, 0, w, h, GL_RGBA, GL_FLOAT, image.texels().data());
  return image;
}

// What the samples and the centres of texels show, and the colours of samples. Rows from the
// bottom.
struct DrawnSamples {
  TexelSamples texels;
  std::vector<glm::vec4> color;  // as TexelSamples::sample
};

Result<DrawnSamples> draw_samples(SceneRenderer& renderer, const Camera& camera,
                                  std::span<const std::uint32_t> objects, int samples) {
  const Result<GLuint> extract =
      renderer.kept_program("capture's samples", SampleTarget::make_extract_program);
  if (!extract) return extract.error();
  Result<SampleTarget> target =
      SampleTarget::create(camera.width, camera.height, samples, *extract);
  if (!target) return target.error();
  target->begin_color(camera.keeps_farthest());
  renderer.draw_opaque(camera, objects, OutputEncoding::linear);
  target->begin_objects(camera.keeps_farthest());
  renderer.draw_objects(camera, objects);
  const std::vector<glm::vec2> places = target->places();
  if (places.empty() || places.size() > 8)
    return Error{"capture", "the driver has no framebuffer of " + std::to_string(samples) +
                                " samples, or of more than 8"};
  DrawnSamples drawn{TexelSamples(camera, places), {}};
  drawn.color.resize(drawn.texels.sample.size());
  SampleTarget::Samples read;
  for (std::size_t s = 0; s < places.size(); ++s) {
    target->read(int(s), read);
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const std::size_t i = drawn.texels.first(x, y) + s;
        drawn.color[i] = read.color(x, y);
        if (read.object(x, y) == kNoObject) continue;
        drawn.texels.sample[i] = drawn.texels.nearness.of_window_z(read.window_z(x, y));
        drawn.texels.sample_object[i] = read.object(x, y);
      }
  }
  return drawn;
}

// The colours of the surfaces that texels show, premultiplied by the share of samples that show
// anything.
Result<> color_by_samples(SceneRenderer& renderer, std::span<const std::uint32_t> objects,
                          const CaptureOptions& options, const Image<std::uint32_t>& centers,
                          DepthImage& picture) {
  const Camera& camera = picture.camera;
  Result<DrawnSamples> drawn = draw_samples(renderer, camera, objects, options.samples);
  if (!drawn) return drawn.error();
  TexelSamples& texels = drawn->texels;
  const int last = camera.height - 1, samples = texels.samples();
  for (int y = 0; y <= last; ++y)
    for (int x = 0; x < camera.width; ++x) {
      if (!picture.covered(x, last - y)) continue;
      texels.center(x, y) = texels.nearness.of_eye_z(picture.depth(x, last - y));
      texels.center_object(x, y) = centers(x, last - y);
    }
  const ShownSamples shown = choose_samples(texels);
  for (const ThinTexel& thin : shown.thin) {
    picture.depth(thin.x, last - thin.y) = float(texels.nearness.eye_z(thin.nearness));
    if (options.objects) picture.object(thin.x, last - thin.y) = thin.object;
  }
  ColorImage of_centers;  // drawn if they are needed
  for (int y = 0; y <= last; ++y)
    for (int x = 0; x < camera.width; ++x) {
      if (!picture.covered(x, last - y)) continue;
      const std::size_t first = texels.first(x, y);
      const std::uint8_t mask = shown.mask(x, y);
      int covered = 0;
      glm::vec3 sum(0);
      for (int s = 0; s < samples; ++s) {
        covered += texels.sample[first + std::size_t(s)] != kNoNearness;
        if (mask >> s & 1) sum += glm::vec3(drawn->color[first + std::size_t(s)]);
      }
      if (mask == 0) {
        if (of_centers.empty()) {
          Result<ColorImage> centers_drawn = draw_centers(renderer, camera, objects, false);
          if (!centers_drawn) return centers_drawn.error();
          of_centers = std::move(*centers_drawn);
        }
        sum = glm::vec3(of_centers(x, y));
      } else {
        sum /= float(std::popcount(mask));
      }
      // A sky, which is there already, is behind what covers a texel in part.
      if (options.with_sky && covered > 0)
        sum = glm::mix(glm::vec3(picture.color(x, last - y)), sum, float(covered) / float(samples));
      // A thing that only the centre shows is at least as large as one sample's part.
      const float alpha = options.with_sky ? 1.0f : float(std::max(covered, 1)) / float(samples);
      picture.color(x, last - y) = alpha * glm::vec4(sum, 1.0f);
    }
  return Done{};
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
  const Image<std::uint32_t> centers = probe->read_objects();
  if (options.objects) picture.object = centers;

  // ... and the colour of that surface: at the centre, or averaged over the texel.
  const bool one = options.samples <= 1;
  if (one || options.with_sky) {
    Result<ColorImage> color = draw_centers(
        renderer, camera, one ? objects : std::span<const std::uint32_t>(), options.with_sky);
    if (!color) return color.error();
    picture.color = std::move(*color);
    gl::flip_rows(picture.color);
  } else {
    picture.color = ColorImage(camera.width, camera.height);
  }
  if (!one)
    if (Result<> done = color_by_samples(renderer, objects, options, centers, picture); !done)
      return done.error();
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
