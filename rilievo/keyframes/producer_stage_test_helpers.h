// A scene and eyes in it, for tests of what makes keyframes.
#pragma once

#include <cmath>
#include <glm/glm.hpp>

#include "rilievo/capture/raster_source.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {

struct ProducerStage {
  BuiltinScene made = *make_builtin("builtin:stonehenge?triangles=20000");
  PlacedScene placed{made.scene};
  RasterSource source{placed};

  static Camera eye(double x, double turn = 0) {
    const glm::dvec3 at(x, 1.7, 12);
    return look_at(at, at + glm::dvec3(std::sin(turn), 0, -std::cos(turn)), {0, 1, 0}, 0.9, 96, 64,
                   0.1, 200);
  }
};

}  // namespace rilievo
