// For tests of environment nodes: nodes of what is known in closed form.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <vector>

#include "rilievo/core/depth_image.h"
#include "rilievo/environment_nodes/cube_grid.h"
#include "rilievo/environment_nodes/delaunay.h"
#include "rilievo/environment_nodes/node_mesh.h"

namespace rilievo {

// Distance from the node along a direction of any length, in lengths of the direction; infinite
// where there is nothing.
using DistanceAlong = std::function<double(const glm::dvec3& direction)>;
using ColorAlong = std::function<glm::vec4(const glm::dvec3& direction, double distance)>;

inline EnvironmentMap make_node(int size, const DistanceAlong& distance,
                                const ColorAlong& color = nullptr,
                                const glm::dvec3& eye = {0, 0, 0}) {
  EnvironmentMap map;
  const std::array<Camera, 6> cameras = environment_cameras(eye, size, 0.01, 1e4);
  for (std::size_t f = 0; f < 6; ++f) {
    DepthImage& face = map.faces[f];
    face.camera = cameras[f];
    face.color = ColorImage(size, size);
    face.depth = Image<float>(size, size, kNoDepth);
    for (int y = 0; y < size; ++y)
      for (int x = 0; x < size; ++x) {
        // One metre along the face's axis, so that the distance is eye_z.
        const glm::dvec3 to = world_from_raster(cameras[f], {x + 0.5, y + 0.5}, 1.0) - eye;
        const double d = distance(to);
        if (std::isfinite(d)) face.depth(x, y) = float(d);
        face.color(x, y) = color ? color(to, d) : glm::vec4(0.5f, 0.5f, 0.5f, 1.0f);
      }
  }
  return map;
}

// The inside of the box from `low` to `high` around the node.
inline DistanceAlong box_around(const glm::dvec3& low, const glm::dvec3& high) {
  return [=](const glm::dvec3& d) {
    double nearest = std::numeric_limits<double>::infinity();
    for (int k = 0; k < 3; ++k)
      if (d[k] != 0) nearest = std::min(nearest, (d[k] > 0 ? high[k] : low[k]) / d[k]);
    return nearest;
  };
}

inline DistanceAlong ball(const glm::dvec3& center, double radius) {
  return [=](const glm::dvec3& d) {
    const double a = glm::dot(d, d), b = glm::dot(d, center);
    const double c = glm::dot(center, center) - radius * radius, root = b * b - a * c;
    if (root < 0 || b <= 0) return std::numeric_limits<double>::infinity();
    return (b - std::sqrt(root)) / a;
  };
}

inline DistanceAlong nearest_of(std::vector<DistanceAlong> all) {
  return [all = std::move(all)](const glm::dvec3& d) {
    double nearest = std::numeric_limits<double>::infinity();
    for (const DistanceAlong& one : all) nearest = std::min(nearest, one(d));
    return nearest;
  };
}

// A room with two balls in it.
inline DistanceAlong furnished_room() {
  return nearest_of({box_around({-4, -1.6, -3}, {5, 2, 4}), ball({1.5, -0.6, -1.4}, 0.6),
                     ball({-1.2, 0.3, 1.9}, 0.5)});
}

// The mesh's disparity at every texel's centre of a face, of the nearest surface there; kNothing
// where there is none. Slow: every triangle is asked about every texel in its box.
inline Image<float> drawn_disparity(const NodeMesh& mesh, int f) {
  const int n = mesh.face_size;
  Image<float> drawn(n, n, kNothing);
  const FaceAxes& axes = face_axes()[std::size_t(f)];
  const TriangleRange range = mesh.surfaces[std::size_t(f)];
  for (std::uint32_t t = range.first; t < range.first + range.count; ++t) {
    glm::dvec2 p[3];
    double d[3];
    for (int k = 0; k < 3; ++k) {
      const NodeVertex& v = mesh.vertices[mesh.indices[3 * t + std::uint32_t(k)]];
      p[k] = 0.5 * n *
             glm::dvec2(1 + glm::dot(v.direction, glm::vec3(axes.right)),
                        1 - glm::dot(v.direction, glm::vec3(axes.up)));
      d[k] = v.disparity;
    }
    const auto cross = [](const glm::dvec2& a, const glm::dvec2& b) {
      return a.x * b.y - a.y * b.x;
    };
    const double area = cross(p[1] - p[0], p[2] - p[0]);
    const glm::dvec2 low = glm::min(p[0], glm::min(p[1], p[2]));
    const glm::dvec2 high = glm::max(p[0], glm::max(p[1], p[2]));
    for (int y = std::max(0, int(low.y) - 1); y <= std::min(n - 1, int(high.y) + 1); ++y)
      for (int x = std::max(0, int(low.x) - 1); x <= std::min(n - 1, int(high.x) + 1); ++x) {
        const glm::dvec2 q(x + 0.5, y + 0.5);
        double w[3];
        for (int k = 0; k < 3; ++k) w[k] = cross(p[(k + 1) % 3] - q, p[(k + 2) % 3] - q) / area;
        // Vertices lie on texels' centres: on an edge is inside.
        if (w[0] < -1e-9 || w[1] < -1e-9 || w[2] < -1e-9) continue;
        drawn(x, y) = std::max(drawn(x, y), float(w[0] * d[0] + w[1] * d[1] + w[2] * d[2]));
      }
  }
  return drawn;
}

// Do the open segments a-b and c-d cross?
[[nodiscard]] inline bool cross_properly(const glm::ivec2& a, const glm::ivec2& b,
                                         const glm::ivec2& c, const glm::ivec2& d) {
  const auto side = [](std::int64_t v) { return (v > 0) - (v < 0); };
  return side(orientation(a, b, c)) * side(orientation(a, b, d)) < 0 &&
         side(orientation(c, d, a)) * side(orientation(c, d, b)) < 0;
}

}  // namespace rilievo
