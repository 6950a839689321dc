// Do two cameras see the same? Internal: not a stable interface.
#pragma once

#include <algorithm>
#include <glm/glm.hpp>

#include "rilievo/core/camera.h"

namespace rilievo {

// The same pixels, but for rounding.
inline bool same_view(const Camera& a, const Camera& b) {
  double most = 0;
  for (int c = 0; c < 3; ++c)
    most = std::max(most, glm::length(a.world_from_eye[c] - b.world_from_eye[c]));
  return most < 1e-7 && glm::length(a.position() - b.position()) < 1e-6 * a.z_near &&
         a.window == b.window && a.width == b.width && a.height == b.height;
}

// The same place and direction?
inline bool same_pose(const Camera& a, const Camera& b) {
  Camera like_a = b;
  like_a.window = a.window, like_a.width = a.width, like_a.height = a.height;
  return same_view(a, like_a);
}

}  // namespace rilievo
