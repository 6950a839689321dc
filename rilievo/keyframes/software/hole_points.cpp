#include "rilievo/keyframes/software/hole_points.h"

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>

#include "rilievo/core/parallel_for.h"
#include "rilievo/core/touch_memory.h"
#include "rilievo/keyframes/warp_keyframes.h"

namespace rilievo {
namespace {

// Points that a call of a thread places.
constexpr std::size_t kRun = 4096;
// How far the origin may be from the eye, in distances of the near plane: single precision is then
// off by less than a tenth of a pixel at that plane.
constexpr double kFarOrigin = 1000;
// In a key: the point is within kReach. No sign is lost, 1 / eye_z has none.
constexpr std::uint64_t kClose = std::uint64_t(1) << 63;

float along(const float (&row)[4], const glm::vec4& place) {
  return row[0] * place.x + row[1] * place.y + row[2] * place.z + row[3] * place.w;
}

void raise(std::uint64_t& value, std::uint64_t to) {
  const std::atomic_ref<std::uint64_t> shared(value);
  std::uint64_t before = shared.load(std::memory_order_relaxed);
  while (before < to && !shared.compare_exchange_weak(before, to, std::memory_order_relaxed)) {
  }
}

}  // namespace

void HolePoints::show(const Camera& camera, std::span<const FramePixel> holes,
                      std::span<const bool> included) {
  shown_.assign(holes.size(), 0);
  if (points_.empty()) return;
  if (index_.width() != camera.width || index_.height() != camera.height)
    index_ = Image<std::uint32_t>(camera.width, camera.height);
  for (std::size_t i = 0; i < holes.size(); ++i)
    index_(holes[i].x, holes[i].y) = std::uint32_t(i + 1);
  const RasterMap to = raster_map(camera, origin_);
  const auto width = float(camera.width), height = float(camera.height);
  const auto near = float(camera.z_near);
  parallel_for(std::size_t(0), (points_.size() + kRun - 1) / kRun, [&](std::size_t run) {
    const std::size_t end = std::min((run + 1) * kRun, points_.size());
    for (std::size_t i = run * kRun; i < end; ++i) {
      const Point& point = points_[i];
      const bool surface = point.place.w > 0;
      if (surface && !included[point.object]) continue;
      const float z = along(to.z, point.place);
      if (!(z > (surface ? near : 0.0f))) continue;
      // The middle of pixel x is at x + 0.5.
      const float x = along(to.x, point.place) / z - 0.5f, y = along(to.y, point.place) / z - 0.5f;
      if (!(x > -1 && x < width && y > -1 && y < height)) continue;
      const std::uint64_t key =
          std::uint64_t(std::bit_cast<std::uint32_t>(surface ? 1 / z : 0.0f)) << 32 | (i + 1);
      const int x0 = std::max(int(std::ceil(x - kFarReach)), 0),
                x1 = std::min(int(std::floor(x + kFarReach)), camera.width - 1);
      const int y0 = std::max(int(std::ceil(y - kFarReach)), 0),
                y1 = std::min(int(std::floor(y + kFarReach)), camera.height - 1);
      for (int py = y0; py <= y1; ++py)
        for (int px = x0; px <= x1; ++px)
          if (const std::uint32_t hole = index_(px, py); hole != 0) {
            const bool close = std::max(std::abs(x - float(px)), std::abs(y - float(py))) <= kReach;
            raise(shown_[hole - 1], close ? key | kClose : key);
          }
    }
  });
  for (const FramePixel& hole : holes) index_(hole.x, hole.y) = 0;
}

float HolePoints::inverse_z(std::size_t hole) const {
  return std::bit_cast<float>(std::uint32_t((shown_[hole] & ~kClose) >> 32));
}

void HolePoints::keep(const Camera& camera, std::span<const FoundInHole> found) {
  used_.assign(points_.size(), 0);
  for (const std::uint64_t key : shown_)
    if (key != 0) used_[std::uint32_t(key) - 1] = 1;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < points_.size(); ++i)
    if (used_[i]) points_[kept++] = points_[i];
  points_.resize(kept);
  shown_.clear();
  // Near points are as exact as the distance from the origin allows.
  if (const glm::dvec3 way = camera.position() - origin_;
      glm::length(way) > kFarOrigin * camera.z_near) {
    for (Point& point : points_)
      if (point.place.w > 0) point.place = glm::vec4(glm::vec3(glm::dvec3(point.place) - way), 1);
    origin_ = camera.position();
  }
  points_.resize(kept + found.size());
  parallel_for(std::size_t(0), (found.size() + kRun - 1) / kRun, [&](std::size_t run) {
    const std::size_t end = std::min((run + 1) * kRun, found.size());
    for (std::size_t i = run * kRun; i < end; ++i) {
      const FoundInHole& one = found[i];
      const glm::dvec2 raster(one.pixel.x + 0.5, one.pixel.y + 0.5);
      const glm::vec4 place =
          one.inverse_z > 0
              ? glm::vec4(world_from_raster(camera, raster, 1 / double(one.inverse_z)) - origin_, 1)
              : glm::vec4(world_from_raster(camera, raster, 1) - camera.position(), 0);
      points_[kept + i] = {place, one.color, one.object};
    }
  });
}

void HolePoints::clear() { points_.clear(), shown_.clear(); }

void HolePoints::take_memory(int width, int height, std::size_t holes) {
  touch_memory(points_, 2 * holes);
  touch_memory(shown_, 2 * holes);
  touch_memory(used_, 2 * holes);
  index_ = Image<std::uint32_t>(width, height);
}

}  // namespace rilievo
