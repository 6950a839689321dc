#include "rilievo/keyframes/keyframe_light.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "rilievo/core/color.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/keyframes/join_quarters.h"

namespace rilievo {
namespace {

// Cells of a row: some ten pixels of a frame for each, as shadows' edges are blurred by the eye.
constexpr int kColumns = 160;
// How much cells count that are of another object, and the least distance of places (cells,
// squared) and of colours (relative, squared) that matters.
constexpr float kOther = 0.02f, kNear = 4, kLike = 0.01f;
// Colours that are darker are alike.
constexpr float kDark = 0.02f;
// How much a keyframe counts that shows only what no other one does.
constexpr float kSpareLight = 0.001f;
// No factor is larger: where rays see nothing but black it means nothing.
constexpr float kMostFactor = 4;
constexpr float kBlack = 0.005f;

glm::vec3 linear_of(std::uint32_t color) {
  const std::array<float, 256>& linear = linear_of_srgb_bytes();
  return {linear[color & 255], linear[color >> 8 & 255], linear[color >> 16 & 255]};
}

// The mean of what a keyframe shows of an object in texels [x0, x1) x [y0, y1).
bool mean_color(const Keyframe& key, std::uint32_t object, int x0, int x1, int y0, int y1,
                glm::vec3& mean) {
  const int scale = key.quarters() ? 2 : 1;
  glm::vec3 sum(0);
  int count = 0;
  for (int y = y0; y < y1; ++y)
    for (int x = x0; x < x1; ++x) {
      if (key.object(x, y) != object) continue;
      for (int i = 0; i < scale * scale; ++i) {
        const std::uint32_t color = key.color(scale * x + i % 2, scale * y + i / 2);
        if (color >> 30 != std::uint32_t(Quarter::own)) continue;
        sum += linear_of(color), ++count;
      }
    }
  if (count > 0) mean = sum / float(count);
  return count > 0;
}

// As bytes have it: no brighter than white, and a number.
glm::vec3 shown_color(const glm::vec4& linear) {
  std::uint32_t bytes;
  srgb_bytes_of(&linear, 1, &bytes);
  return linear_of(bytes);
}

}  // namespace

Result<> find_light(CaptureSource& rays, std::span<const std::uint32_t> objects, double time,
                    Keyframe& keyframe) {
  const int width = keyframe.camera.width, height = keyframe.camera.height;
  KeyframeLight& light = keyframe.light;
  light.camera = keyframe.camera;
  const int columns = std::min(width, kColumns),
            rows = std::clamp((columns * height + width / 2) / width, 1, height);
  light.camera.width = columns, light.camera.height = rows;
  CaptureRequest request;
  request.camera = light.camera;
  request.objects = objects;
  request.samples = 1;
  request.time = time;
  const Result<CapturedPicture> captured = rays.capture(request);
  if (!captured) return captured.error();
  const DepthImage& picture = captured->picture;
  light.cells.resize(columns, rows);
  parallel_for(0, rows, [&](int y) {
    const int y0 = y * height / rows, y1 = (y + 1) * height / rows;
    for (int x = 0; x < columns; ++x) {
      LightCell& cell = light.cells(x, y) = {};
      if (!picture.covered(x, y) || picture.object(x, y) == kNoObject) continue;
      const int x0 = x * width / columns, x1 = (x + 1) * width / columns;
      if (!mean_color(keyframe, picture.object(x, y), x0, x1, y0, y1, cell.source)) continue;
      cell.rays = shown_color(picture.color(x, y));
      cell.object = picture.object(x, y);
    }
  });
  return Done{};
}

void Relight::begin(std::span<const WarpedKeyframe> keyframes, const Camera& frame) {
  maps_.clear();
  for (const WarpedKeyframe& one : keyframes) {
    const KeyframeLight& light = one.keyframe->light;
    if (!light.cells.empty())
      maps_.push_back({&light, raster_map(light.camera, frame),
                       one.spare ? kSpareLight * one.weight : one.weight});
  }
}

std::uint32_t Relight::shown(float x, float y, float inverse_z, std::uint32_t object,
                             std::uint32_t color) const {
  const glm::vec3 by_rays = linear_of(color);
  glm::vec3 source(0), rays(0);
  for (const auto& [light, map, weight] : maps_) {
    const auto along = [&](const float(&row)[4]) {
      return row[0] * x + row[1] * y + row[2] + row[3] * inverse_z;
    };
    const float z = along(map.z);
    if (!(z > 0)) continue;
    const int width = light->cells.width(), height = light->cells.height();
    // A place beside the view has the light of its border.
    const auto cell_at = [](float at, int count) {
      return int(std::clamp(at, 0.0f, float(count - 1)));
    };
    const int cx = cell_at(along(map.x) / z, width), cy = cell_at(along(map.y) / z, height);
    for (const int step : kSteps)
      for (int dy = -kReach; dy <= kReach; ++dy)
        for (int dx = -kReach; dx <= kReach; ++dx) {
          if (step > 1 && dx == 0 && dy == 0) continue;
          const int at_x = cx + dx * step, at_y = cy + dy * step;
          if (at_x < 0 || at_y < 0 || at_x >= width || at_y >= height) continue;
          const LightCell& cell = light->cells(at_x, at_y);
          if (cell.object == kNoObject) continue;
          // 1 / (kLike + the squared difference of the colours, relative to both).
          const glm::vec3 difference = cell.rays - by_rays, sum = cell.rays + by_rays + kDark;
          const float whole = glm::dot(sum, sum);
          const float near = kNear + float((dx * dx + dy * dy) * step * step);
          const float counts = weight * (cell.object == object + 1 ? 1 : kOther) * whole /
                               ((kLike * whole + glm::dot(difference, difference)) * near);
          source += counts * cell.source, rays += counts * cell.rays;
        }
  }
  const float most = std::max({rays.r, rays.g, rays.b});
  if (!(most > 0)) return color;
  const glm::vec3 factor =
      glm::min((source + kBlack * most) / (rays + kBlack * most), glm::vec3(kMostFactor));
  const glm::vec4 lit(glm::min(by_rays * factor, glm::vec3(1)), 1);
  std::uint32_t bytes;
  srgb_bytes_of(&lit, 1, &bytes);
  return (bytes & 0xFFFFFFu) | (color & 0xFF000000u);
}

}  // namespace rilievo
