// A texture whose texels are read one by one. Internal: not a stable interface.
#pragma once

#include "rilievo/gl/object.h"

namespace rilievo {

// Integers cannot be read with filters.
[[nodiscard]] inline gl::Texture make_unfiltered(GLenum format, int width, int height) {
  gl::Texture texture = gl::make_texture_2d(format, width, height);
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTextureParameteri(texture, filter, GL_NEAREST);
  return texture;
}

}  // namespace rilievo
