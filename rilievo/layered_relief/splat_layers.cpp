#include "rilievo/layered_relief/splat_layers.h"

#include <algorithm>
#include <cmath>

#include "rilievo/core/parallel_for.h"
#include "rilievo/layered_relief/prewarp_runs.h"

namespace rilievo {
namespace {

// A Gaussian is cut off where it hides a fiftieth.
constexpr float kCutOff = 1.4f;  // in widths of a texel, with the deviation below
constexpr float kDeviation = 0.5f;

void add_splat(SplattedFrame& frame, SplatShape shape, const glm::vec2& at, const glm::vec2& size,
               float z, const glm::vec4& color) {
  const int w = frame.color.width(), h = frame.color.height();
  const glm::vec2 reach =
      shape == SplatShape::square ? 0.5f * size : glm::max(kCutOff * size, glm::vec2(0.75f));
  const int x0 = std::max(int(std::floor(at.x - reach.x + 0.5f)), 0);
  const int y0 = std::max(int(std::floor(at.y - reach.y + 0.5f)), 0);
  const int x1 = std::min(int(std::floor(at.x + reach.x + 0.5f)), w);
  const int y1 = std::min(int(std::floor(at.y + reach.y + 0.5f)), h);
  // No narrower than a pixel, else small samples are lost.
  const glm::vec2 deviation = kDeviation * glm::max(size, glm::vec2(1.0f));
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      if (shape == SplatShape::square) {
        frame.color(x, y) = color;
        frame.depth(x, y) = z;
        continue;
      }
      const glm::vec2 from = (glm::vec2(x, y) + 0.5f - at) / deviation;
      const float weight = std::exp(-0.5f * glm::dot(from, from));
      glm::vec4& pixel = frame.color(x, y);
      pixel = weight * color + (1 - weight * color.a) * pixel;
      if (weight >= 0.5f) frame.depth(x, y) = z;
    }
}

}  // namespace

SplattedFrame empty_frame(const Camera& camera) {
  return {camera, Image<glm::vec4>(camera.width, camera.height, glm::vec4(0)),
          Image<float>(camera.width, camera.height, kNoDepth)};
}

SplattedFrame splat_layers(const LayeredRelief& relief, const Camera& camera, SplatShape shape) {
  RILIEVO_EXPECTS(camera.projection == Projection::perspective);
  SplattedFrame frame = empty_frame(camera);
  const ReliefFrame source = relief.frame();
  const auto warp = relief_warp(source, camera.position());
  if (!warp) return frame;
  std::vector<PrewarpRun> runs;
  find_runs(relief, *warp, sheets_of(relief, *warp),
            {.min = glm::dvec2(-1e300), .max = glm::dvec2(1e300)}, runs);

  // Raster positions are projective in u, v and the code.
  const glm::dmat4 clip = clip_from_world(camera);
  const auto raster_row = [&](const glm::dvec4& p) {
    const glm::dvec4 c = clip * p;
    return glm::vec3(
        glm::dvec3(0.5 * camera.width * (c.x + c.w), 0.5 * camera.height * (c.w - c.y), c.w));
  };
  const glm::vec3 at_0 = raster_row(glm::dvec4(source.world(0.5, 0.5, relief.first_d), 1));
  const glm::vec3 per_u = raster_row(glm::dvec4(source.a, 0));
  const glm::vec3 per_v = raster_row(glm::dvec4(source.b, 0));
  const glm::vec3 per_code = raster_row(glm::dvec4(relief.d_step * source.f, 0));
  const glm::vec2 texel(
      glm::length(source.a) * camera.width / (camera.window.right - camera.window.left),
      glm::length(source.b) * camera.height / (camera.window.top - camera.window.bottom));
  for (const PrewarpRun& run : runs)
    for (std::uint32_t i = 0; i < run.count; ++i) {
      const ReliefSample& sample = run.samples[i];
      if (!run.all_columns && (sample.u() < run.u_from || sample.u() >= run.u_to)) continue;
      const glm::vec3 at = at_0 + (run.u + float(sample.u())) * per_u +
                           (run.v + float(sample.v())) * per_v + float(sample.code()) * per_code;
      if (!(at.z > camera.z_near)) continue;
      glm::vec4 color;
      for (int c = 0; c < 4; ++c) color[c] = float(sample.color >> (8 * c) & 0xff) / 255.0f;
      add_splat(frame, shape, glm::vec2(at) / at.z, texel / at.z, at.z, color);
    }
  return frame;
}

void map_picture(const Prewarped& picture, SplattedFrame& frame) {
  const Camera &from = picture.geometry.capture, &camera = frame.camera;
  const int w = picture.width(), h = picture.height();
  if (picture.color.empty()) return;
  // One eye: a pixel's line of sight is a texel's.
  const glm::dmat4 from_eye = eye_from_world(from) * camera.world_from_eye;
  const glm::dvec3 axis(0, 0, -1);
  const auto texel = [&](int x, int y) { return std::size_t(y) * std::size_t(w) + std::size_t(x); };
  parallel_for(0, camera.height, [&](int y) {
    for (int x = 0; x < camera.width; ++x) {
      const auto& [l, r, b, t] = camera.window;
      const glm::dvec3 ray =
          glm::dmat3(from_eye) * glm::dvec3(l + (x + 0.5) / camera.width * (r - l),
                                            t - (y + 0.5) / camera.height * (t - b), -1);
      const double ahead = glm::dot(ray, axis);
      if (!(ahead > 0)) continue;
      const glm::dvec2 at(
          (ray.x / ahead - from.window.left) / (from.window.right - from.window.left) * w,
          (from.window.top - ray.y / ahead) / (from.window.top - from.window.bottom) * h);
      if (!(at.x > -0.5 && at.y > -0.5 && at.x < w + 0.5 && at.y < h + 0.5)) continue;
      const glm::dvec2 cell = glm::floor(at - 0.5);
      const glm::vec2 share(at - 0.5 - cell);
      glm::vec4 color(0);
      float z = kNoDepth;
      for (int corner = 0; corner < 4; ++corner) {
        const int u = int(cell.x) + (corner & 1), v = int(cell.y) + (corner >> 1);
        if (u < 0 || v < 0 || u >= w || v >= h) continue;
        const std::uint16_t delta = picture.delta[texel(u, v)];
        if (delta == kEmptyCode) continue;
        const float weight =
            (corner & 1 ? share.x : 1 - share.x) * (corner >> 1 ? share.y : 1 - share.y);
        color += weight / 255.0f * glm::vec4(picture.color[texel(u, v)]);
        // The nearest texel's, or that of the nearest surface whose colour reaches here.
        const double eye_z =
            eye_z_from(DepthKind::window_z, decode_delta(delta, 16), from, {u + 0.5, v + 0.5});
        const float depth = float(eye_z / ahead);
        if (weight >= 0.25f || z == kNoDepth) z = std::min(z, depth);
      }
      if (color.a <= 0 || z >= frame.depth(x, y)) continue;
      glm::vec4& pixel = frame.color(x, y);
      pixel = color + (1 - color.a) * pixel;
      if (color.a >= 0.5f) frame.depth(x, y) = z;
    }
  });
}

Prewarped picture_of(const SplattedFrame& frame, const PictureGeometry& geometry) {
  Prewarped picture;
  picture.geometry = geometry;
  for (int y = 0; y < frame.color.height(); ++y)
    for (int x = 0; x < frame.color.width(); ++x) {
      const glm::vec4& color = frame.color(x, y);
      picture.color.emplace_back(glm::round(255.0f * glm::clamp(color, 0.0f, 1.0f)));
      const double z = frame.depth(x, y);
      picture.delta.push_back(
          z == double(kNoDepth)
              ? std::uint16_t(kEmptyCode)
              : std::uint16_t(encode_delta(
                    float(depth_from_eye_z(DepthKind::window_z, z, geometry.capture, {})), 16)));
    }
  return picture;
}

Rgba8Image frame_over(const SplattedFrame& frame, const glm::vec3& background) {
  const int w = frame.color.width(), h = frame.color.height();
  Rgba8Image out(w, h);
  glm::vec3 behind;
  for (int c = 0; c < 3; ++c) behind[c] = srgb_from_linear(background[c]);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const glm::vec4& color = frame.color(x, y);
      const glm::vec3 sum = glm::vec3(color) + (1 - color.a) * behind;
      out(x, y) = glm::u8vec4(glm::u8vec3(glm::round(255.0f * glm::clamp(sum, 0.0f, 1.0f))), 255);
    }
  return out;
}

}  // namespace rilievo
