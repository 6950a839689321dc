// Cf. [Schaufler 1997]. How we differ: the plane stands where parallax is balanced instead of on
// the near plane; texels carry coverage beside the reserved Delta, so that edges can be antialiased
// by alpha-to-coverage where the frame has several samples.
#include "rilievo/nailboard/nailboard.h"

#include <algorithm>
#include <cmath>

namespace rilievo {
namespace {

double window_z_of(const Camera& frame, const glm::dvec3& world) {
  const glm::dvec4 clip = clip_from_world(frame) * glm::dvec4(world, 1);
  return 0.5 * clip.z / clip.w + 0.5;
}

// Where the line of sight from `frame`'s eye through `through` meets the plane eye_z == `eye_z` of
// the capturing camera.
glm::dvec3 on_plane(const Camera& capture, const Camera& frame, const glm::dvec3& through,
                    double eye_z) {
  const glm::dvec3 eye = frame.position(), direction = through - eye, axis = capture.forward();
  const double t = (eye_z - glm::dot(axis, eye - capture.position())) / glm::dot(axis, direction);
  return eye + t * direction;
}

}  // namespace

double exact_depth(const PictureGeometry& picture, const Camera& frame, const glm::dvec2& raster,
                   double delta) {
  const double eye_z = eye_z_from(DepthKind::window_z, delta, picture.capture, raster);
  return window_z_of(frame, world_from_raster(picture.capture, raster, eye_z));
}

double linear_depth(const PictureGeometry& picture, const Camera& frame, const glm::dvec2& raster,
                    double delta) {
  const glm::dvec3 q = world_from_raster(picture.capture, raster, picture.plane_z);
  const double z_n =
      window_z_of(frame, on_plane(picture.capture, frame, q, picture.capture.z_near));
  const double z_f = window_z_of(frame, on_plane(picture.capture, frame, q, picture.capture.z_far));
  return z_n + (z_f - z_n) * delta;
}

double flat_depth(const PictureGeometry& picture, const Camera& frame, const glm::dvec2& raster) {
  return window_z_of(frame, world_from_raster(picture.capture, raster, picture.plane_z));
}

namespace {

// Gives empty texels beside others the nearest one's Delta: see Nailboard::delta.
void spread_delta(Nailboard& board) {
  const Image<std::uint16_t> delta = board.delta;
  const int w = delta.width(), h = delta.height();
  const auto transparent = std::uint16_t(delta_transparent(board.geometry.delta_bits));
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      if (delta(x, y) != transparent) continue;
      std::uint16_t& nearest = board.delta(x, y);
      for (int v = std::max(0, y - 1); v <= std::min(h - 1, y + 1); ++v)
        for (int u = std::max(0, x - 1); u <= std::min(w - 1, x + 1); ++u)
          nearest = std::min(nearest, delta(u, v));  // the transparent code is the largest
    }
}

}  // namespace

Nailboard make_nailboard(const DepthImage& picture, int delta_bits) {
  const int w = picture.camera.width, h = picture.camera.height;
  Nailboard board;
  board.geometry = picture_geometry(picture.camera);
  board.geometry.delta_bits = delta_bits;
  board.color = Rgba8Image(w, h);
  board.delta = Image<std::uint16_t>(w, h, std::uint16_t(delta_transparent(delta_bits)));
  const auto byte = [](float v) {
    return std::uint8_t(std::lround(std::clamp(v, 0.0f, 1.0f) * 255.0f));
  };
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const glm::vec4& c = picture.color(x, y);
      if (!picture.covered(x, y) || c.a <= 0) continue;
      glm::u8vec4& texel = board.color(x, y);
      for (int k = 0; k < 3; ++k)
        texel[k] = byte(srgb_from_linear(std::clamp(c[k] / c.a, 0.0f, 1.0f)) * c.a);
      texel.a = byte(c.a);
      const glm::dvec2 raster(x + 0.5, y + 0.5);
      const double eye_z =
          eye_z_from(picture.depth_kind, picture.depth(x, y), picture.camera, raster);
      const double window_z = depth_from_eye_z(DepthKind::window_z, eye_z, picture.camera, raster);
      board.delta(x, y) = std::uint16_t(encode_delta(float(window_z), delta_bits));
    }
  spread_delta(board);
  return board;
}

DepthImage depth_image_from(const Nailboard& board) {
  const Camera& camera = board.geometry.capture;
  const int bits = board.geometry.delta_bits;
  DepthImage picture;
  picture.camera = camera;
  picture.depth_kind = DepthKind::eye_z;
  picture.color = ColorImage(camera.width, camera.height);
  picture.depth = Image<float>(camera.width, camera.height, kNoDepth);
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const glm::u8vec4& texel = board.color(x, y);
      if (board.delta(x, y) == delta_transparent(bits) || texel.a == 0) continue;
      const float a = float(texel.a) / 255.0f;
      glm::vec4& c = picture.color(x, y);
      for (int k = 0; k < 3; ++k) c[k] = linear_from_srgb(float(texel[k]) / float(texel.a)) * a;
      c.a = a;
      picture.depth(x, y) = float(eye_z_from(
          DepthKind::window_z, decode_delta(board.delta(x, y), bits), camera, {x + 0.5, y + 0.5}));
    }
  return picture;
}

}  // namespace rilievo
