#include "rilievo/render/raster/blended_triangle.h"

#include <algorithm>
#include <cmath>
#include <optional>

#include "rilievo/render/raster/clip_polygon.h"
#include "rilievo/render/software/frame_tile.h"

namespace rilievo {
namespace {

constexpr int kUnit = BlendedTriangle::kUnit;

// Triangles are cut where they reach farther to the sides, in pixels. Coordinates are then below
// 2^31 in units, the largest frame's height of 2^22 pixels included, and differences below 2^29. An
// area is the difference of two products of differences, an edge function the sum of two products
// of a difference and a coordinate: below 2^61, and 64 bits hold up to 2^63.
constexpr double kReach = 1e6;

// To the nearest, without a call.
std::int64_t rounded(double v) { return std::int64_t(v < 0 ? v - 0.5 : v + 0.5); }

// Of pixel (x, y), kUnit a pixel.
glm::i64vec2 sample_at(int x, int y, int s, int samples) {
  const float sx = samples == 1 ? 0.5f : FrameTile::kSampleX[s],
              sy = samples == 1 ? 0.5f : FrameTile::kSampleY[s];
  return {std::int64_t(float(kUnit) * sx) + std::int64_t(x) * kUnit,
          std::int64_t(float(kUnit) * sy) + std::int64_t(y) * kUnit};
}

// Does it cover a sample? Only small ones are looked at: most of what is far away covers none.
bool may_cover(const BlendedTriangle& t, int samples) {
  if (t.x1 - t.x0 > 2 || t.y1 - t.y0 > 2) return true;
  const TriangleEdges edges(t);
  for (int y = t.y0; y < t.y1; ++y)
    for (int x = t.x0; x < t.x1; ++x)
      if (edges.samples_in(x, y, samples) != 0) return true;
  return false;
}

// One triangle, if it can be seen in the frame. Corners as in place_blended().
std::optional<BlendedTriangle> place_triangle(const Camera& camera, int samples,
                                              const RasterInstance& in, std::uint32_t number,
                                              const glm::dvec3 (&corner)[3]) {
  BlendedTriangle t;
  double per_w[3];
  for (int k = 0; k < 3; ++k) {
    per_w[k] = 1 / corner[k].z;
    const double x = corner[k].x / corner[k].z, y = corner[k].y / corner[k].z;
    // What was cut lies at kReach but for rounding: this is no number.
    if (!(std::abs(x) < 1.001 * kReach && std::abs(y) < 1.001 * kReach)) return std::nullopt;
    t.x[k] = rounded(x * kUnit), t.y[k] = rounded((camera.height - y) * kUnit);
  }
  std::int64_t area = (t.x[1] - t.x[0]) * (t.y[2] - t.y[0]) - (t.x[2] - t.x[0]) * (t.y[1] - t.y[0]);
  if (area == 0 || !(area < 0 ? in.front : in.back)) return std::nullopt;
  if (area > 0) {
    std::swap(t.x[1], t.x[2]), std::swap(t.y[1], t.y[2]), std::swap(per_w[1], per_w[2]);
    area = -area;
  }
  const auto pixels = [](std::int64_t a, std::int64_t b, std::int64_t c, int limit, int& from,
                         int& to) {
    const auto clamped = [&](std::int64_t v) { return int(std::clamp<std::int64_t>(v, 0, limit)); };
    from = clamped(std::min({a, b, c}) / kUnit);
    to = clamped(std::max({a, b, c}) / kUnit + 1);
  };
  pixels(t.x[0], t.x[1], t.x[2], camera.width, t.x0, t.x1);
  pixels(t.y[0], t.y[1], t.y[2], camera.height, t.y0, t.y1);
  if (t.x0 >= t.x1 || t.y0 >= t.y1 || !may_cover(t, samples)) return std::nullopt;
  // 1 / eye_z is affine.
  const double x1 = double(t.x[1] - t.x[0]) / kUnit, y1 = double(t.y[1] - t.y[0]) / kUnit,
               x2 = double(t.x[2] - t.x[0]) / kUnit, y2 = double(t.y[2] - t.y[0]) / kUnit;
  const double det = x1 * y2 - x2 * y1, d1 = per_w[1] - per_w[0], d2 = per_w[2] - per_w[0];
  t.per_x = (d1 * y2 - d2 * y1) / det, t.per_y = (d2 * x1 - d1 * x2) / det;
  t.inverse_z = per_w[0] - (double(t.x[0]) * t.per_x + double(t.y[0]) * t.per_y) / kUnit;
  t.number = number;
  return t;
}

// Cuts a polygon at kReach on all four sides.
void cut_to_reach(std::vector<glm::dvec3>& polygon) {
  static thread_local std::vector<glm::dvec3> scratch;  // kept, so that drawing does not allocate
  for (int side = 0; side < 4; ++side)
    clip_polygon(
        polygon, scratch,
        [&](const glm::dvec3& p) { return kReach * p.z + (side % 2 ? 1 : -1) * p[side / 2]; },
        [](const glm::dvec3& in, const glm::dvec3& out, double share) {
          return glm::mix(in, out, share);
        });
}

}  // namespace

float nearest_in(const BlendedTriangle& t, const PixelRange& range) {
  const double nearest = t.inverse_z + std::max(t.per_x * range.x0, t.per_x * range.x1) +
                         std::max(t.per_y * range.y0, t.per_y * range.y1);
  // Rounding to single precision must not make it less.
  return float(nearest + 1e-6 * std::abs(nearest));
}

TriangleEdges::TriangleEdges(const BlendedTriangle& t) {
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3;
    const std::int64_t dx = t.x[b] - t.x[a], dy = t.y[b] - t.y[a];
    const bool own = dy > 0 || (dy == 0 && dx > 0);
    edges_[a] = {-dy * t.x[a] + dx * t.y[a] + (own ? 1 : 0), dy, -dx};
  }
}

bool TriangleEdges::beside(const PixelRange& range) const {
  return std::ranges::any_of(edges_, [&](const Edge& edge) {
    return edge(std::int64_t(edge.per_x > 0 ? range.x1 : range.x0) * kUnit,
                std::int64_t(edge.per_y > 0 ? range.y1 : range.y0) * kUnit) <= 0;
  });
}

unsigned TriangleEdges::samples_in(int x, int y, int samples) const {
  bool inside = true;
  for (const Edge& edge : edges_) {
    const std::int64_t middle = edge(std::int64_t(x) * kUnit + kUnit / 2,
                                     std::int64_t(y) * kUnit + kUnit / 2),
                       within = (std::abs(edge.per_x) + std::abs(edge.per_y)) * (kUnit / 2);
    if (middle + within <= 0) return 0;
    inside = inside && middle - within > 0;
  }
  if (inside) return (1u << samples) - 1;
  unsigned covered = 0;
  for (int s = 0; s < samples; ++s) {
    const glm::i64vec2 p = sample_at(x, y, s, samples);
    if (edges_[0](p.x, p.y) > 0 && edges_[1](p.x, p.y) > 0 && edges_[2](p.x, p.y) > 0)
      covered |= 1u << s;
  }
  return covered;
}

void place_blended(const Camera& camera, int samples, const RasterInstance& in,
                   std::uint32_t number, const std::uint32_t* indices,
                   std::vector<BlendedTriangle>& placed) {
  // x w, y w and w, in pixels; y points up.
  glm::dvec3 corner[3];
  bool far = false;
  for (int k = 0; k < 3; ++k) {
    const glm::vec4 p(in.positions[indices[k]], 1);
    corner[k] = {glm::dot(in.row_x, p), glm::dot(in.row_y, p), glm::dot(in.row_w, p)};
    const double w = corner[k].z;
    if (!(w > double(in.min_w)) || w <= 0) return;
    far = far || !(std::abs(corner[k].x) < kReach * w && std::abs(corner[k].y) < kReach * w);
  }
  const auto place = [&](const glm::dvec3(&of)[3]) {
    if (const auto t = place_triangle(camera, samples, in, number, of)) placed.push_back(*t);
  };
  if (!far) return place(corner);
  static thread_local std::vector<glm::dvec3> polygon;
  polygon.assign(corner, corner + 3);
  cut_to_reach(polygon);
  for (std::size_t k = 2; k < polygon.size(); ++k) place({polygon[0], polygon[k - 1], polygon[k]});
}

}  // namespace rilievo
