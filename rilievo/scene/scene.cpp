#include "rilievo/scene/scene.h"

namespace rilievo {
Light default_sun() {
  Light sun;
  sun.direction = glm::normalize(glm::vec3(-0.45f, -0.8f, -0.4f));
  sun.intensity = glm::vec3(3.0f, 2.85f, 2.6f);
  return sun;
}
}  // namespace rilievo
