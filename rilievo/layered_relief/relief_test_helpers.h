// Layered reliefs to test with, and the warp by its definition.
#pragma once

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "rilievo/layered_relief/prewarp.h"

namespace rilievo {

// A parallel camera whose pose is random; texels are not square.
inline Camera random_parallel_camera(std::mt19937& rng, int width, int height) {
  std::uniform_real_distribution<double> unit(-1, 1);
  const glm::dvec3 eye(unit(rng), unit(rng), unit(rng));
  Camera camera = look_at(3.0 * eye, {unit(rng), unit(rng), unit(rng)}, {0.1, 1, 0.2}, 1.0, width,
                          height, 2.0, 5.0);
  camera.projection = Projection::parallel;
  camera.window = {-1.1, 0.9, -0.8, 1.0};
  return camera;
}

// One in perspective.
inline Camera random_perspective_camera(std::mt19937& rng, int width, int height) {
  Camera camera = random_parallel_camera(rng, width, height);
  camera.projection = Projection::perspective;
  camera.window = {-0.45, 0.3, -0.35, 0.4};
  return camera;
}

// Balls and slanted walls that pass through each other, hit by hit; and a share of noise.
inline LayeredDepthImage random_layers(std::mt19937& rng, int width, int height, double noise = 0.1,
                                       bool perspective = false) {
  std::uniform_real_distribution<double> unit(0, 1);
  LayeredDepthImage layers;
  layers.name = "random";
  layers.camera = perspective ? random_perspective_camera(rng, width, height)
                              : random_parallel_camera(rng, width, height);
  const auto coordinate = [&] { return 2 * unit(rng) - 1; };
  struct Ball {
    double x, y, z, r;
  };
  std::vector<Ball> balls;
  for (int i = 0; i < 4; ++i)
    balls.push_back({coordinate(), coordinate(), 3.5 + 0.8 * coordinate(), 0.2 + 0.5 * unit(rng)});
  struct Wall {
    double x, y, z;
  };
  const Wall wall{0.5 * coordinate(), 0.5 * coordinate(), 3.6};
  layers.first.push_back(0);
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double px = 2 * (x + 0.5) / width - 1, py = 2 * (y + 0.5) / height - 1;
      std::vector<double> depths;
      for (const Ball& b : balls) {
        const double rest = b.r * b.r - (px - b.x) * (px - b.x) - (py - b.y) * (py - b.y);
        if (rest <= 0) continue;
        depths.push_back(b.z - std::sqrt(rest));
        depths.push_back(b.z + std::sqrt(rest));
      }
      if (px < 0.4) depths.push_back(wall.z + wall.x * px + wall.y * py);
      if (unit(rng) < noise) depths.push_back(3.5 + coordinate());
      std::sort(depths.begin(), depths.end());
      for (const double depth : depths) {
        LayerSample sample;
        sample.color = {float(unit(rng)), float(unit(rng)), float(unit(rng)), 1};
        sample.depth = sample.back = float(std::clamp(depth, 2.05, 4.95));
        layers.samples.push_back(sample);
      }
      layers.first.push_back(layers.samples.size());
    }
  return layers;
}

// An eye in front of the camera's near plane, to any side; ahead of a perspective relief's own eye,
// or back from it.
inline glm::dvec3 random_eye(std::mt19937& rng, const LayeredRelief& relief) {
  std::uniform_real_distribution<double> unit(-1, 1);
  if (relief.perspective()) {
    const glm::dmat3 axes(relief.camera.world_from_eye);
    const double aside = unit(rng), up = unit(rng), back = unit(rng);
    return relief.camera.position() + axes * glm::dvec3(aside, up, 1.9 * back);
  }
  const double distance = 0.3 + 4.0 * std::abs(unit(rng)) - relief.nearest_d();
  const ReliefFrame frame = relief.frame();
  const double w = relief.camera.width, h = relief.camera.height;
  return frame.world(w * (0.5 + 1.5 * unit(rng)), h * (0.5 + 1.5 * unit(rng)), -distance);
}

struct PlacedSample {
  int u = 0, v = 0;
  std::uint32_t code = 0;
};

// Gives every sample its own colour, the index of its entry in the list, in all four streams.
inline std::vector<PlacedSample> label_samples(LayeredRelief& relief) {
  std::vector<PlacedSample> list;
  for (int t = 0; t < relief.tiles_x * relief.tiles_y; ++t) {
    const std::uint32_t from = relief.first[std::size_t(t)], to = relief.first[std::size_t(t) + 1];
    for (std::uint32_t i = from; i < to; ++i) {
      ReliefSample& s = relief.streams[0][i];
      s.color = std::uint32_t(list.size());
      list.push_back({t % relief.tiles_x * relief.tile_size + int(s.u()),
                      t / relief.tiles_x * relief.tile_size + int(s.v()), s.code()});
    }
    // Samples in the same place are alike; they are labelled in their order.
    for (unsigned order = 1; order < 4; ++order) {
      std::vector<bool> taken(to - from, false);
      for (std::uint32_t i = from; i < to; ++i)
        for (std::uint32_t k = from; k < to; ++k)
          if (relief.streams[order][i].place == relief.streams[0][k].place && !taken[k - from]) {
            relief.streams[order][i].color = relief.streams[0][k].color;
            taken[k - from] = true;
            break;
          }
    }
  }
  return list;
}

inline constexpr std::uint32_t kNoSample = 0xffffffff;

// The forward warp with a z-buffer: each sample at its texel, or over its splat. `min` is the
// result's upper left texel on the source plane's grid.
inline std::vector<std::uint32_t> oracle_warp(const LayeredRelief& relief,
                                              const std::vector<PlacedSample>& samples,
                                              const ReliefWarp& warp, Splat splat, double size,
                                              double resolution, const glm::ivec2& min, int width,
                                              int height) {
  std::vector<std::uint32_t> shown(std::size_t(width) * std::size_t(height), kNoSample);
  for (std::uint32_t i = 0; i < samples.size(); ++i) {
    const PlacedSample& s = samples[i];
    const double d = relief.d(s.code);
    glm::ivec2 from, to;
    const glm::dvec2 centre = resolution * warp.moved(s.u + 0.5, s.v + 0.5, d) - glm::dvec2(min);
    if (splat == Splat::nearest) {
      from = glm::ivec2(glm::floor(centre));
      to = from + 1;
    } else {
      const double half = 0.5 * size * resolution * warp.magnification(d);
      from = glm::ivec2(glm::floor(centre - half + 0.5));
      to = glm::ivec2(glm::floor(centre + half + 0.5));
    }
    from = glm::max(from, glm::ivec2(0));
    to = glm::min(to, glm::ivec2(width, height));
    for (int y = from.y; y < to.y; ++y)
      for (int x = from.x; x < to.x; ++x) {
        std::uint32_t& texel = shown[std::size_t(y) * std::size_t(width) + std::size_t(x)];
        if (texel == kNoSample || s.code < samples[texel].code) texel = i;
      }
  }
  return shown;
}

// The result's upper left texel on the grid, from its camera.
inline glm::ivec2 grid_origin(const LayeredRelief& relief, const Prewarped& result,
                              double resolution) {
  const Camera& camera = result.geometry.capture;
  if (relief.perspective()) {
    const ImageWindow &now = camera.window, &source = relief.camera.window;
    return glm::ivec2(glm::round(
        resolution *
        glm::dvec2((now.left - source.left) / (source.right - source.left) * relief.camera.width,
                   (source.top - now.top) / (source.top - source.bottom) * relief.camera.height)));
  }
  const glm::dvec3 corner = world_from_raster(camera, {0, 0}, result.geometry.plane_z);
  const ReliefFrame frame = relief.frame();
  const glm::dvec3 from = corner - frame.origin;
  const glm::dvec2 at(glm::dot(from, frame.a) / glm::dot(frame.a, frame.a),
                      glm::dot(from, frame.b) / glm::dot(frame.b, frame.b));
  return glm::ivec2(glm::round(at * resolution));
}

}  // namespace rilievo
