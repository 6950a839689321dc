// What does the cache need to know of a nailboard's error? For the drawables of all backends.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/core/camera.h"
#include "rilievo/core/picture_geometry.h"
#include "rilievo/kind/drawable.h"

namespace rilievo {

// The error model of a picture: bound_total_px, infinite for a motion that is not rigid.
[[nodiscard]] ErrorModel nailboard_error_model(const PictureGeometry& geometry);

}  // namespace rilievo
