#include "rilievo/keyframes/warp_sources.h"

#include <array>
#include <cmath>
#include <glm/glm.hpp>

#include "rilievo/core/expects.h"

namespace rilievo {
namespace {

// Does the keyframe show nothing but the sky in columns [x0, x1] and rows [y0, y1] of the frame,
// and a texel around them? Where the sky is seen is a ratio of affine functions again. Of a
// keyframe with hidden texels it is not known: these have no depth, either.
bool shows_plain_sky(const WarpSource& source, float x0, float x1, float y0, float y1) {
  const Keyframe& key = *source.keyframe;
  if (!key.hidden.empty()) return false;
  const RasterMap& map = source.from_frame;
  float left = INFINITY, right = -INFINITY, top = INFINITY, bottom = -INFINITY;
  for (int i = 0; i < 4; ++i) {
    const float x = i & 1 ? x1 : x0, y = i & 2 ? y1 : y0;
    const auto row = [&](const float(&r)[4]) { return r[0] * x + r[1] * y + r[2]; };
    const float z = row(map.z);
    if (!(z > 1e-3f && z <= kMostMagnified)) return false;
    const float at_x = row(map.x) / z, at_y = row(map.y) / z;
    left = std::min(left, at_x), right = std::max(right, at_x);
    top = std::min(top, at_y), bottom = std::max(bottom, at_y);
  }
  // A place lies between the centres of four texels.
  constexpr float kAround = 2;
  if (!(left >= kAround && top >= kAround && right <= float(key.camera.width) - kAround &&
        bottom <= float(key.camera.height) - kAround))
    return false;
  for (int by = int(top - kAround) / Keyframe::kRows;
       by <= int(bottom + kAround - 1) / Keyframe::kRows; ++by)
    for (int bx = int(left - kAround) / Keyframe::kColumns;
         bx <= int(right + kAround - 1) / Keyframe::kColumns; ++bx)
      if (!key.blocks(bx, by).empty()) return false;
  return true;
}

double pixels_per_tangent(const Camera& camera) {
  return camera.width / (camera.window.right - camera.window.left);
}

// Of vectors of the world, from the target's eye, whose sum, by four coordinates, is a place.
RasterMap map_of(const Camera& to, const std::array<glm::dvec3, 4>& columns) {
  const glm::dmat3 axes(to.world_from_eye);
  const ImageWindow& t = to.window;
  RasterMap map{};
  for (std::size_t i = 0; i < 4; ++i) {
    const glm::dvec3 eye = glm::transpose(axes) * columns[i];
    const double z = -eye.z;
    map.x[i] = float((eye.x - t.left * z) / (t.right - t.left) * to.width);
    map.y[i] = float((t.top * z - eye.y) / (t.top - t.bottom) * to.height);
    map.z[i] = float(z);
  }
  return map;
}

}  // namespace

RasterMap raster_map(const Camera& to, const Camera& from) {
  // World space: R(x, y), and E from the target's eye.
  const glm::dmat3 axes(from.world_from_eye);
  const ImageWindow& w = from.window;
  return map_of(
      to, {(w.right - w.left) / from.width * axes[0], (w.bottom - w.top) / from.height * axes[1],
           axes * glm::dvec3(w.left, w.top, -1), from.position() - to.position()});
}

RasterMap raster_map(const Camera& to, const glm::dvec3& origin) {
  return map_of(to, {glm::dvec3(1, 0, 0), {0, 1, 0}, {0, 0, 1}, origin - to.position()});
}

void find_warp_sources(std::span<const WarpedKeyframe> keyframes, const Camera& frame,
                       std::vector<WarpSource>& sources) {
  RILIEVO_EXPECTS(!keyframes.empty());
  sources.clear();
  for (const bool spare : {false, true})
    for (const WarpedKeyframe& one : keyframes) {
      RILIEVO_EXPECTS(one.keyframe && one.weight > 0);
      if (one.spare != spare) continue;
      const Camera& camera = one.keyframe->camera;
      sources.push_back({one.keyframe, raster_map(frame, camera), raster_map(camera, frame),
                         one.weight, spare,
                         float(pixels_per_tangent(frame) / pixels_per_tangent(camera))});
    }
}

std::optional<SamePixels> find_same_pixels(std::span<const WarpSource> sources,
                                           const Camera& frame) {
  for (std::size_t i = 0; i < sources.size(); ++i) {
    const WarpSource& source = sources[i];
    const Keyframe& key = *source.keyframe;
    if (source.spare || !key.quarters() || !key.hidden.empty()) continue;
    const RasterMap& map = source.from_frame;
    const float width = float(frame.width), height = float(frame.height);
    const float near = float(1 / frame.z_near);
    // The most that any pixel is beside its texel.
    constexpr float kSamePlace = 0.01f;
    const auto differs = [&](const float(&row)[4], float x, float y, float one) {
      return std::abs(row[0] - x) * width + std::abs(row[1] - y) * height + std::abs(row[2] - one) +
             std::abs(row[3]) * near;
    };
    const float from_x = std::round(map.x[2]), from_y = std::round(map.y[2]);
    if (differs(map.x, 1, 0, from_x) > kSamePlace || differs(map.y, 0, 1, from_y) > kSamePlace ||
        differs(map.z, 0, 0, 1) * std::max(width, height) > kSamePlace)
      continue;
    const int left = int(from_x), top = int(from_y);
    if (left >= 0 && top >= 0 && left + frame.width <= key.camera.width &&
        top + frame.height <= key.camera.height)
      return SamePixels{i, left, top};
  }
  return std::nullopt;
}

void find_plain_sky(std::span<const WarpSource> sources, int first, int rows, int width,
                    std::uint8_t* plain) {
  for (int x = 0; x < width; x += kPlainSkyColumns) {
    const int end = std::min(x + kPlainSkyColumns, width);
    *plain++ = std::ranges::any_of(sources, [&](const WarpSource& source) {
      return shows_plain_sky(source, float(x), float(end), float(first), float(first + rows));
    });
  }
}

}  // namespace rilievo
