// Which samples does a triangle cover, and how deep? One triangle at a time, by OpenGL's rules:
// for skins, of which each pixel is asked before it is drawn. Internal to
// environment_nodes/software.
#pragma once

#include <algorithm>
#include <cstdint>
#include <glm/glm.hpp>

namespace rilievo {

// Inline: std::floor is a call where code is compiled for every x86-64 processor.
inline int floor_of(double v) {
  const int toward_zero = int(v);
  return toward_zero - int(double(toward_zero) > v);
}

// A triangle in the raster, corners rounded to 1/256 of a pixel, as OpenGL has them.
struct CornerEdges {
  static constexpr int kUnitBits = 8, kUnit = 1 << kUnitBits;
  int x0 = 0, y0 = 0, x1 = 0, y1 = 0;  // pixels that it can cover: x0 <= x < x1
  // Of an edge at + per_x x + per_y y: > 0 inside, y upwards; 0 on it, if it is not the triangle's.
  std::int64_t at[3] = {}, per_x[3] = {}, per_y[3] = {};
  double z = 0, z_per_x = 0, z_per_y = 0;

  CornerEdges(const glm::vec3& a, const glm::vec3& b, const glm::vec3& c) {
    const glm::vec3 corner[] = {a, b, c};
    std::int64_t x[3], y[3];
    for (int k = 0; k < 3; ++k) {
      x[k] = nearest(corner[k].x), y[k] = nearest(corner[k].y);
    }
    const std::int64_t area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    const glm::dvec3 u = glm::dvec3(b) - glm::dvec3(a), v = glm::dvec3(c) - glm::dvec3(a);
    const double det = u.x * v.y - u.y * v.x;
    if (area == 0 || det == 0) return;  // covers nothing
    const int way = area > 0 ? 1 : -1;
    for (int k = 0; k < 3; ++k) {
      const int m = (k + 1) % 3;
      const std::int64_t dx = way * (x[m] - x[k]), dy = way * (y[m] - y[k]);
      // Left and lower edges are the triangle's own, as in OpenGL's framebuffers.
      const bool own = dy < 0 || (dy == 0 && dx > 0);
      per_x[k] = -dy, per_y[k] = dx;
      at[k] = dy * x[k] - dx * y[k] + (own ? 1 : 0);
    }
    const auto [left, right] = std::minmax({x[0], x[1], x[2]});
    const auto [low, high] = std::minmax({y[0], y[1], y[2]});
    const auto pixel = [](std::int64_t v) { return int(v >> kUnitBits); };
    x0 = pixel(left), x1 = pixel(right) + 1, y0 = pixel(low), y1 = pixel(high) + 1;
    z_per_x = (u.z * v.y - u.y * v.z) / det, z_per_y = (u.x * v.z - u.z * v.x) / det;
    z = double(a.z) - z_per_x * double(a.x) - z_per_y * double(a.y);
  }
  // In units, of what lies in the middle that farther from 0.
  static std::int64_t nearest(float v) {
    return std::int64_t(double(v) * kUnit + (v < 0 ? -0.5 : 0.5));
  }
  [[nodiscard]] bool covers(const glm::vec2& p) const {
    const auto x = std::int64_t(p.x * kUnit), y = std::int64_t(p.y * kUnit);
    for (int k = 0; k < 3; ++k)
      if (!(at[k] + per_x[k] * x + per_y[k] * y > 0)) return false;
    return true;
  }
  [[nodiscard]] float depth(const glm::vec2& p) const {
    return float(z + z_per_x * double(p.x) + z_per_y * double(p.y));
  }
  // Keeps of [from, to) what row y of pixels can have covered, and perhaps a pixel more.
  void narrow_row(int y, int& from, int& to) const {
    for (int k = 0; k < 3; ++k) {
      if (per_x[k] == 0) continue;
      const std::int64_t best = at[k] + per_y[k] * kUnit * (y + (per_y[k] > 0 ? 1 : 0));
      const double x = std::clamp(-double(best) / double(per_x[k]) / kUnit, x0 - 2.0, x1 + 2.0);
      if (per_x[k] > 0)
        from = std::max(from, floor_of(x) - 1);
      else
        to = std::min(to, 1 - floor_of(-x));
    }
  }
};

}  // namespace rilievo
