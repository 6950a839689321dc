// Direct splatting of a layered relief into a frame, for tests and measures (S4.9)
//
// The method of [Shade, Gortler, He, Szeliski 1998], to compare the pre-warp with: each sample is
// projected and drawn as a square of the size of a source texel at its depth, or as a Gaussian of
// that width, blended over what was drawn before. Samples are drawn in occlusion-compatible order
// without a depth test. A Gaussian frame by the pre-warp's own camera is a pre-warp with Gaussian
// splats.
#pragma once

#include <algorithm>
#include <cmath>

#include "rilievo/core/color.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/layered_relief/prewarp.h"
#include "rilievo/layered_relief/prewarp_runs.h"

namespace rilievo {

// The footprint of a sample.
enum class SplatShape { square, gaussian };

// A frame. Colours are sRGB-encoded, then premultiplied, in floating point; depth is the eye_z of
// samples with an opacity of at least one half.
struct SplattedFrame {
  Camera camera;
  Image<glm::vec4> color;
  Image<float> depth;
};

namespace splatting {

// A Gaussian is cut off where it hides a fiftieth.
inline constexpr float kCutOff = 1.4f;  // in widths of a texel, with the deviation below
inline constexpr float kDeviation = 0.5f;

inline void add_splat(SplattedFrame& frame, SplatShape shape, const glm::vec2& at,
                      const glm::vec2& size, float z, const glm::vec4& color) {
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

// Interpolated texels: the colour, and the least Delta of those with a weight of at least a quarter
// (of the first, if none has).
struct MixedTexels {
  glm::vec4 color{0};
  std::uint32_t delta = kEmptyCode;
};

// At (u, v) between texels' centres, no more than one texel outside the picture.
inline MixedTexels mix_texels(const Prewarped& picture, double u, double v) {
  const int w = picture.width(), h = picture.height();
  // Not negative, so that truncation is floor.
  const int x = int(u + 1) - 1, y = int(v + 1) - 1;
  const glm::vec2 share(u - x, v - y);
  MixedTexels mixed;
  for (int corner = 0; corner < 4; ++corner) {
    const int at_x = x + (corner & 1), at_y = y + (corner >> 1);
    if (at_x < 0 || at_y < 0 || at_x >= w || at_y >= h) continue;
    const std::size_t at = std::size_t(at_y) * std::size_t(w) + std::size_t(at_x);
    const std::uint32_t delta = picture.delta[at];
    if (delta == kEmptyCode) continue;
    const float weight =
        (corner & 1 ? share.x : 1 - share.x) * (corner >> 1 ? share.y : 1 - share.y);
    mixed.color += weight / 255.0f * glm::vec4(picture.color[at]);
    if (weight >= 0.25f || mixed.delta == kEmptyCode) mixed.delta = std::min(mixed.delta, delta);
  }
  return mixed;
}

}  // namespace splatting

// An empty frame.
[[nodiscard]] inline SplattedFrame empty_frame(const Camera& camera) {
  return {camera, Image<glm::vec4>(camera.width, camera.height, glm::vec4(0)),
          Image<float>(camera.width, camera.height, kNoDepth)};
}

// Splats a relief. Requires a perspective camera whose eye is in front of the source plane. Samples
// behind the near plane are left out.
[[nodiscard]] inline SplattedFrame splat_layers(const LayeredRelief& relief, const Camera& camera,
                                                SplatShape shape) {
  RILIEVO_EXPECTS(camera.projection == Projection::perspective && !relief.perspective());
  using namespace splatting;
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

// Draws a pre-warped picture into a frame whose camera has the picture's eye: colours are
// interpolated, the depth is that of the nearest texel (S4.10). Replaces farther pixels. Rows run
// in parallel.
inline void map_picture(const Prewarped& picture, SplattedFrame& frame) {
  const Camera &from = picture.geometry.capture, &camera = frame.camera;
  const int w = picture.width(), h = picture.height();
  if (picture.color.empty()) return;
  // One eye: a pixel's line of sight is a texel's. Along a row it changes by `step`; its texel is
  // (x, y) / z of `texel_from_ray` times it.
  const glm::dmat3 from_eye(eye_from_world(from) * camera.world_from_eye);
  const double across = w / (from.window.right - from.window.left);
  const double down = h / (from.window.top - from.window.bottom);
  const glm::dmat3 texel_from_ray({across, 0, 0}, {0, -down, 0},
                                  {from.window.left * across, -from.window.top * down, -1});
  const double l = camera.window.left, r = camera.window.right;
  const double b = camera.window.bottom, t = camera.window.top;
  const glm::dmat3 texel_from_eye = texel_from_ray * from_eye;
  const glm::dvec3 step = texel_from_eye * glm::dvec3((r - l) / camera.width, 0, 0);
  parallel_for(0, camera.height, [&](int y) {
    const double row = t - (y + 0.5) / camera.height * (t - b);
    const glm::dvec3 first = texel_from_eye * glm::dvec3(l + 0.5 / camera.width * (r - l), row, -1);
    for (int x = 0; x < camera.width; ++x) {
      const glm::dvec3 ray = first + double(x) * step;
      if (!(ray.z > 0)) continue;
      const double per_ahead = 1 / ray.z, u = ray.x * per_ahead, v = ray.y * per_ahead;
      if (!(u > -0.5 && v > -0.5 && u < w + 0.5 && v < h + 0.5)) continue;
      const splatting::MixedTexels mixed = splatting::mix_texels(picture, u - 0.5, v - 0.5);
      if (mixed.color.a <= 0) continue;
      const double eye_z =
          eye_z_from(DepthKind::window_z, decode_delta(mixed.delta, 16), from, {u, v});
      const auto z = float(eye_z * per_ahead);
      if (z >= frame.depth(x, y)) continue;
      glm::vec4& pixel = frame.color(x, y);
      pixel = mixed.color + (1 - mixed.color.a) * pixel;
      if (mixed.color.a >= 0.5f) frame.depth(x, y) = z;
    }
  });
}

// The frame as a pre-warp's result, with Deltas made of its depths.
[[nodiscard]] inline Prewarped picture_of(const SplattedFrame& frame,
                                          const PictureGeometry& geometry) {
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

// The frame over a background of one linear colour.
[[nodiscard]] inline Rgba8Image frame_over(const SplattedFrame& frame,
                                           const glm::vec3& background) {
  const int w = frame.color.width(), h = frame.color.height();
  Rgba8Image out(w, h);
  glm::vec3 behind;
  for (int c = 0; c < 3; ++c) behind[c] = srgb_from_linear(background[c]);
  parallel_for(0, h, [&](int y) {
    for (int x = 0; x < w; ++x) {
      const glm::vec4& color = frame.color(x, y);
      const glm::vec3 sum = glm::vec3(color) + (1 - color.a) * behind;
      out(x, y) = glm::u8vec4(glm::u8vec3(255.0f * glm::clamp(sum, 0.0f, 1.0f) + 0.5f), 255);
    }
  });
  return out;
}

}  // namespace rilievo
