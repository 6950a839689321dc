// The sky behind the centres of a picture's texels. Internal to render/shading.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/core/camera.h"
#include "rilievo/render/shading/shading_model.h"

namespace rilievo {

// Where the sky is, behind the centres of texels.
class SkyRays {
 public:
  explicit SkyRays(const Camera& camera) {
    const glm::dmat3 axes(camera.world_from_eye);
    const ImageWindow& w = camera.window;
    const bool parallel = camera.projection == Projection::parallel;
    per_x_ = (parallel ? 0 : (w.right - w.left) / camera.width) * axes[0];
    per_y_ = (parallel ? 0 : (w.top - w.bottom) / camera.height) * axes[1];
    first_ = (parallel ? glm::dvec3(0) : axes * glm::dvec3(w.left, w.bottom, 0)) - axes[2] +
             0.5 * (per_x_ + per_y_);
  }
  // y from the bottom.
  [[nodiscard]] glm::vec3 radiance(const Sky& sky, int x, int y) const {
    const glm::dvec3 to = glm::normalize(first_ + double(x) * per_x_ + double(y) * per_y_);
    const auto color = shading_model::sky_radiance(sky, float(to.y));
    return {color.x, color.y, color.z};
  }

 private:
  glm::dvec3 first_, per_x_, per_y_;
};

}  // namespace rilievo
