// A texel (x, y) of `main` lies in the direction d = (X, Y, -1) of its eye space, affine in x and
// y. With R from its axes to the other's and w = -(R d).z, it lies at ((R d).x / w, (R d).y / w) in
// tangents of the other; what is there at a distance z lies at z / w from main's plane of the eye.
// All of it is linear in (x, y, 1) but for one division.
#include "rilievo/relief_impostor/merge_warps.h"

#include <algorithm>
#include <cmath>

#include "rilievo/core/depth.h"
#include "rilievo/core/expects.h"
#include "rilievo/relief_impostor/warp_passes.h"

namespace rilievo {
namespace {

// Depths that differ by a smaller share belong to the same surface: pictures have 12 bits of depth,
// and where surfaces are seen at a grazing angle, a texel's error is several times its size.
constexpr float kSame = 0.01f;
// Of a texel's flags.
constexpr std::uint16_t kTorn = kTornBit >> 16;
// A picture is alone where the other's eye is so many times as far.
constexpr double kOwnEye = 0.01;

// 1 / eye_z = first + per_code code.
struct InverseDepth {
  float first = 0, per_code = 0;
  explicit InverseDepth(const PictureGeometry& geometry) {
    const double n = geometry.capture.z_near, f = geometry.capture.z_far;
    first = float(1 / n), per_code = float((1 / f - 1 / n) / delta_steps(16));
  }
  [[nodiscard]] float of(std::uint32_t code) const { return first + per_code * float(code); }
  [[nodiscard]] std::uint16_t code(float inverse) const {
    return std::uint16_t(
        std::clamp((inverse - first) / per_code + 0.5f, 0.0f, float(kEmptyWarped - 1)));
  }
};

// What the other warp shows at a place.
struct Tap {
  float color[4] = {};  // premultiplied, 0 to 255
  float inverse_depth = 0;
  bool known = false;  // seen, not torn
};

class OtherWarp {
 public:
  OtherWarp(const Prewarped& warp, std::span<const std::uint16_t> flags)
      : warp_(warp), flags_(flags), depth_(warp.geometry) {}

  // Between four texels, without those of other surfaces.
  [[nodiscard]] Tap at(float u, float v) const {
    Tap tap;
    const float x = u - 0.5f, y = v - 0.5f;
    if (!(x > -1 && y > -1 && x < float(warp_.width()) && y < float(warp_.height()))) return tap;
    const int left = int(std::floor(x)), top = int(std::floor(y));
    const float fx = x - float(left), fy = y - float(top);
    const float weights[4] = {(1 - fx) * (1 - fy), fx * (1 - fy), (1 - fx) * fy, fx * fy};
    std::size_t texels[4];
    bool inside[4];
    int best = -1;
    for (int k = 0; k < 4; ++k) {
      const int column = left + (k & 1), row = top + (k >> 1);
      inside[k] = column >= 0 && row >= 0 && column < warp_.width() && row < warp_.height();
      texels[k] =
          inside[k] ? std::size_t(row) * std::size_t(warp_.width()) + std::size_t(column) : 0;
      inside[k] = inside[k] && warp_.delta[texels[k]] != kEmptyWarped;
      if (inside[k] && (best < 0 || weights[k] > weights[best])) best = k;
    }
    if (best < 0 || (flags_[texels[best]] & kTorn)) return tap;
    tap.known = true;
    tap.inverse_depth = depth_.of(warp_.delta[texels[best]]);
    float sum = 0;
    for (int k = 0; k < 4; ++k) {
      if (!inside[k]) {
        sum += weights[k];  // transparent
        continue;
      }
      const float inverse = depth_.of(warp_.delta[texels[k]]);
      if (std::abs(inverse - tap.inverse_depth) > kSame * tap.inverse_depth) continue;
      sum += weights[k];
      for (int c = 0; c < 4; ++c) tap.color[c] += weights[k] * float(warp_.color[texels[k]][c]);
    }
    for (float& channel : tap.color) channel /= sum;
    return tap;
  }

 private:
  const Prewarped& warp_;
  std::span<const std::uint16_t> flags_;
  InverseDepth depth_;
};

glm::u8vec4 rounded(const float (&color)[4]) {
  glm::u8vec4 bytes;
  for (int c = 0; c < 4; ++c) bytes[c] = std::uint8_t(std::min(color[c] + 0.5f, 255.0f));
  return bytes;
}

// Premultiplied `front` before `behind`.
glm::u8vec4 over(const glm::u8vec4& front, const glm::u8vec4& behind) {
  const float through = 1 - float(front.a) / 255;
  float sum[4];
  for (int c = 0; c < 4; ++c) sum[c] = float(front[c]) + through * float(behind[c]);
  return rounded(sum);
}

}  // namespace

std::optional<glm::dvec4> rectangle_on(const PictureGeometry& picture, const Prewarped& warp) {
  const Camera& from = warp.geometry.capture;
  const glm::dvec3 eye = from.position(), forward = picture.capture.forward();
  const double height = picture.plane_z - glm::dot(eye - picture.capture.position(), forward);
  if (!(height > 0)) return std::nullopt;
  glm::dvec4 sides(1e300, 1e300, -1e300, -1e300);
  for (int k = 0; k < 4; ++k) {
    const glm::dvec2 corner((k & 1) * from.width, (k >> 1) * from.height);
    const glm::dvec3 way = world_from_raster(from, corner, 1) - eye;
    const double towards = glm::dot(way, forward);
    if (!(towards > 0.1 * glm::length(way))) return std::nullopt;
    const glm::dvec3 at = raster_from_world(picture.capture, eye + way * (height / towards));
    sides = {std::min(sides.x, at.x), std::min(sides.y, at.y), std::max(sides.z, at.x),
             std::max(sides.w, at.y)};
  }
  return sides;
}

void merge_warps(Prewarped& main, std::span<std::uint16_t> main_flags, const Prewarped& other,
                 std::span<const std::uint16_t> other_flags, double share) {
  RILIEVO_EXPECTS(main_flags.size() == main.color.size());
  RILIEVO_EXPECTS(other_flags.size() == other.color.size());
  const Camera &to = main.geometry.capture, &from = other.geometry.capture;
  const glm::dmat3 turn =
      glm::transpose(glm::dmat3(from.world_from_eye)) * glm::dmat3(to.world_from_eye);
  const ImageWindow &a = to.window, &b = from.window;
  // (u w, v w, w) of (x, y, 1).
  const glm::dmat3 direction(glm::dvec3((a.right - a.left) / to.width, 0, 0),
                             glm::dvec3(0, (a.bottom - a.top) / to.height, 0),
                             glm::dvec3(a.left, a.top, -1));
  const double across = from.width / (b.right - b.left), down = from.height / (b.top - b.bottom);
  const glm::dmat3 texel(glm::dvec3(across, 0, 0), glm::dvec3(0, -down, 0),
                         glm::dvec3(b.left * across, -b.top * down, -1));
  const glm::mat3 map(texel * turn * direction);

  const OtherWarp source(other, other_flags);
  const InverseDepth depth(main.geometry);
  const auto part = float(share);
  for (int y = 0; y < main.height(); ++y)
    for (int x = 0; x < main.width(); ++x) {
      const glm::vec3 at = map * glm::vec3(float(x) + 0.5f, float(y) + 0.5f, 1.0f);
      if (!(at.z > 0)) continue;
      const Tap tap = source.at(at.x / at.z, at.y / at.z);
      if (!tap.known || tap.color[3] < float(kFaintAlpha)) continue;
      const std::size_t i = std::size_t(y) * std::size_t(main.width()) + std::size_t(x);
      glm::u8vec4& color = main.color[i];
      std::uint16_t& code = main.delta[i];
      const float inverse = at.z * tap.inverse_depth;
      const auto take = [&] {
        color = rounded(tap.color);
        code = depth.code(inverse);
        main_flags[i] = 0;
      };
      if (code == kEmptyWarped || (main_flags[i] & kTorn)) {
        take();
        continue;
      }
      const float own = depth.of(code);
      if (std::abs(inverse - own) <= kSame * own) {
        // The same surface. Where one picture has its silhouette, the other may know more.
        if (tap.color[3] > float(color.a) + 0.5f) {
          take();
        } else if (tap.color[3] >= 254.5f && part > 0) {
          float mixed[4];
          for (int c = 0; c < 4; ++c)
            mixed[c] = float(color[c]) + part * (tap.color[c] - float(color[c]));
          color = rounded(mixed);
        }
      } else if (inverse > own) {
        const glm::u8vec4 behind = color;
        color = over(rounded(tap.color), behind);
        if (tap.color[3] >= 128) code = depth.code(inverse);
      } else if (color.a < 255) {
        if (color.a < 128) code = depth.code(inverse);
        color = over(color, rounded(tap.color));
      }
    }
}

std::optional<WarpedTexels> warp_pair(const ImpostorPicture& one, const ImpostorPicture& two,
                                      const glm::dvec3& eye, const ImpostorWarpOptions& options,
                                      WarpPairScratch& scratch, Prewarped& result) {
  const double from_one = glm::distance(one.geometry.capture.position(), eye),
               from_two = glm::distance(two.geometry.capture.position(), eye);
  const bool first = from_one <= from_two;
  const ImpostorPicture &main = first ? one : two, &other = first ? two : one;
  const double near = std::min(from_one, from_two), far = std::max(from_one, from_two);
  ImpostorWarpOptions with = options;
  bool both = near > kOwnEye * far &&
              warp_impostor(other, eye, options, scratch.other, scratch.board).has_value();
  if (both) with.room = rectangle_on(main.geometry, scratch.board);
  both = both && with.room;
  const auto counted = warp_impostor(main, eye, with, scratch.main, result);
  if (!counted) return warp_impostor(other, eye, options, scratch.other, result);
  if (!both) return counted;
  // From beyond both, the farther one only adds what the nearer one does not know.
  const bool between =
      glm::dot(one.geometry.capture.position() - eye, two.geometry.capture.position() - eye) < 0;
  merge_warps(result, scratch.main.flags, scratch.board, scratch.other.flags,
              between ? near / (near + far) : 0.0);
  return counted;
}

}  // namespace rilievo
