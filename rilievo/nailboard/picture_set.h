// Pictures with depth as nailboards, ready to be drawn.
//
// nailboard/gl/atlas_pictures.h makes them for OpenGL, nailboard/software/software_pictures.h
// without.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "rilievo/core/depth_image.h"
#include "rilievo/kind/drawable.h"

namespace rilievo {

// A drawable of pictures.
struct PictureSet {
  std::unique_ptr<Drawable> drawable;
  std::vector<Instance> instances;  // one for each picture
};

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
