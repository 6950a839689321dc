#include "rilievo/capture/pose_origin.h"

#include <vector>

#include "rilievo/scene/far_origin.h"

namespace rilievo {

WorldSpace take_origin_off(std::span<glm::dmat4* const> poses) {
  // What cameras see is some metres away; up to 200 m floats have steps of 15 um.
  std::vector<glm::dvec3> points;
  for (const glm::dmat4* pose : poses)
    for (const double side : {-8.0, 8.0})
      points.push_back(glm::dvec3((*pose)[3]) + glm::dvec3(side));
  const WorldSpace world{far_origin(std::move(points))};
  for (glm::dmat4* pose : poses) (*pose)[3] -= glm::dvec4(world.origin, 0);
  return world;
}

}  // namespace rilievo
