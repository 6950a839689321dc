// The objects that a drawable stands for, and where.
#pragma once

#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <optional>
#include <vector>

#include "rilievo/kind/drawable.h"

namespace rilievo {

// A baked representation with the objects that it stands for.
struct ObjectDrawable {
  std::unique_ptr<Drawable> drawable;
  std::vector<std::uint32_t> objects;   // indices into Scene::objects, ascending
  glm::dmat4 object_from_capture{1.0};  // the inverse of the pose at the bake
  bool together = false;                // one instance shows all objects at once
};

// The motion from the world at the bake to an object with this pose; none unless it is rigid or a
// uniform scale.
[[nodiscard]] std::optional<glm::dmat4> motion_of(const ObjectDrawable& drawable,
                                                  const glm::mat4& pose);

}  // namespace rilievo
