#include "bench/traced_frame.h"

#include <algorithm>
#include <glm/glm.hpp>
#include <utility>
#include <vector>

#include "rilievo/capture/shaders/software_shader.h"
#include "rilievo/compare/reference_frames.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/render/shading/sky_rays.h"

namespace rilievo::bench {
namespace {

constexpr int kStrips = 4;  // of a frame: 90 MB each, of 1280 x 720 pixels with 4 x 4 texels

// As it is displayed: a surface's texel as a whole one, whatever else its samples saw; a program's
// texel as it is.
Rgba8Image displayed(DepthImage& picture, const Sky& sky, bool by_program) {
  const SkyRays rays(picture.camera);
  const int height = picture.camera.height;
  parallel_for(0, height, [&](int y) {
    for (int x = 0; x < picture.camera.width; ++x) {
      glm::vec4& color = picture.color(x, y);
      const auto behind = [&] { return rays.radiance(sky, x, height - 1 - y); };
      glm::vec3 light(color);
      if (color.a > 0 && by_program)
        light += (1 - color.a) * behind();
      else if (!picture.covered(x, y))
        light = behind();
      else if (color.a > 0)
        light /= color.a;
      color = glm::vec4(light, 1);
    }
  });
  return srgb8_from_linear(picture.color);
}

glm::u8vec4 bilinear(const Rgba8Image& frame, double x, double y) {
  x = std::clamp(x - 0.5, 0.0, frame.width() - 1.0),
  y = std::clamp(y - 0.5, 0.0, frame.height() - 1.0);
  const int x0 = int(x), y0 = int(y);
  const int x1 = std::min(x0 + 1, frame.width() - 1), y1 = std::min(y0 + 1, frame.height() - 1);
  const float u = float(x - x0), v = float(y - y0);
  const glm::vec4 above = glm::mix(glm::vec4(frame(x0, y0)), glm::vec4(frame(x1, y0)), u);
  const glm::vec4 below = glm::mix(glm::vec4(frame(x0, y1)), glm::vec4(frame(x1, y1)), u);
  return glm::u8vec4(glm::mix(above, below, v) + 0.5f);
}

}  // namespace

Result<TracedFrames> TracedFrames::create(const Scene& scene, const std::string& source, int side,
                                          int samples) {
  Result<RayScene> rays = RayScene::create(scene);
  if (!rays) return rays.error();
  TracedFrames frames(scene, std::make_unique<RayScene>(std::move(*rays)), side, samples);
  ShaderInput input;
  input.rays = frames.rays_.get();
  input.exec.world = scene.world;
  Result<std::unique_ptr<CaptureSource>> made = make_shader(source, input);
  if (!made) return made.error();
  frames.source_ = std::move(*made);
  frames.by_program_ = !program_named(source).empty();
  return {std::move(frames)};
}

Result<TracedFrame> TracedFrames::frame(const Camera& camera) const {
  TracedFrame made{.camera = camera, .color = Rgba8Image(camera.width, camera.height)};
  std::vector<float> depths;
  const int rows = (camera.height + kStrips - 1) / kStrips;
  for (int first = 0; first < camera.height; first += rows) {
    CaptureRequest request;
    request.camera = supersampled(
        camera_of_part(camera, 0, first, camera.width, std::min(rows, camera.height - first)),
        side_);
    request.samples = samples_;
    request.with_sky = by_program_;
    Result<CapturedPicture> strip = source_->capture(request);
    if (!strip) return strip.error();
    DepthImage& picture = strip->picture;
    average_into(displayed(picture, scene_->sky, by_program_), side_, 0, first, made.color);
    for (const float depth : picture.depth.texels())
      if (depth != kNoDepth) depths.push_back(depth);
  }
  if (!depths.empty()) {
    const auto middle = depths.begin() + std::ptrdiff_t(depths.size() / 2);
    std::nth_element(depths.begin(), middle, depths.end());
    made.median_z = *middle;
  }
  return {std::move(made)};
}

Rgba8Image draw_on_plane(const TracedFrame& frame, const Camera& eye) {
  Rgba8Image shown(eye.width, eye.height);
  const double z = frame.median_z > 0 ? frame.median_z : eye.z_far;
  const glm::dmat4 old_from_world = eye_from_world(frame.camera);
  const glm::dvec3 from = glm::dvec3(old_from_world * glm::dvec4(eye.position(), 1));
  for (int y = 0; y < eye.height; ++y)
    for (int x = 0; x < eye.width; ++x) {
      const glm::dvec3 to =
          glm::dvec3(old_from_world * glm::dvec4(world_from_raster(eye, {x + 0.5, y + 0.5}, 1), 1));
      const glm::dvec3 way = to - from;
      // Where the line of sight leaves the plane: what lies that way far off.
      double along = (-z - from.z) / way.z;
      if (!(along > 0)) along = 1e6;
      const glm::dvec3 at =
          glm::dvec3(frame.camera.world_from_eye * glm::dvec4(from + along * way, 1));
      const glm::dvec3 raster = raster_from_world(frame.camera, at);
      shown(x, y) =
          raster.z > 0 ? bilinear(frame.color, raster.x, raster.y) : glm::u8vec4(0, 0, 0, 255);
    }
  return shown;
}

}  // namespace rilievo::bench
