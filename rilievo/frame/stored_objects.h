// Which object does a stored picture show?
#pragma once

#include <cstdint>

#include "rilievo/core/depth_image.h"

namespace rilievo {

// The object that a picture shows if it is but one, else `otherwise`.
[[nodiscard]] inline std::uint32_t only_object(const DepthImage& picture, std::uint32_t otherwise) {
  std::uint32_t only = kNoObject;
  for (const std::uint32_t object : picture.object.texels()) {
    if (object == kNoObject || object == only) continue;
    if (only != kNoObject) return otherwise;
    only = object;
  }
  return only == kNoObject ? otherwise : only;
}

}  // namespace rilievo
