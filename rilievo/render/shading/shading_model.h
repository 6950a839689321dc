// How is one point shaded? The shading model for one number at a time.
//
// For float (the same bytes as a SIMD lane) or double: for renderers that shade single points, such
// as a ray tracer, and for tests.
#pragma once

#include <cmath>
#include <cstdint>
#include <cstring>
#include <glm/glm.hpp>
#include <numbers>

#include "rilievo/render/shading/surface.h"

namespace rilievo::shading_model {

#include "rilievo/render/shading/scalar_numbers.inl"
// A template over these numbers.
#include "rilievo/render/shading/shading_model.inl"

}  // namespace rilievo::shading_model
