// A body whose sides differ, as six parallel pictures see it.
#pragma once

#include <cmath>
#include <utility>

#include "rilievo/layered_relief/relief_pictures.h"

namespace rilievo {

// A ball whose outer side is red and whose inner side is blue, wherever it is seen from.
inline ReliefPictures two_sided_ball(int size) {
  ReliefPictures made;
  const Box box{glm::vec3(-1), glm::vec3(1)};
  const auto directions = relief_directions(6);
  for (const glm::dvec3& direction : *directions) {
    LayeredDepthImage layers;
    layers.camera = *relief_camera(box, direction, size);
    const Camera& camera = layers.camera;
    layers.first.push_back(0);
    for (int y = 0; y < camera.height; ++y)
      for (int x = 0; x < camera.width; ++x) {
        const glm::dvec3 at = world_from_raster(camera, {x + 0.5, y + 0.5}, 0.0);
        const glm::dvec3 forward = camera.forward();
        const double middle = -glm::dot(at, forward);
        const double across = glm::length(at + middle * forward);
        if (across < 0.9) {
          const double half = std::sqrt(0.81 - across * across);
          for (const double z : {middle - half, middle + half}) {
            LayerSample sample;
            sample.color = z < middle ? glm::vec4(1, 0, 0, 1) : glm::vec4(0, 0, 1, 1);
            sample.depth = sample.back = float(z);
            sample.object = 1;
            layers.samples.push_back(sample);
          }
        }
        layers.first.push_back(layers.samples.size());
      }
    made.pictures.push_back({std::move(layers), 0, 0, 0});
  }
  return made;
}

}  // namespace rilievo
