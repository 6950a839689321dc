// The farthest surface of texels that show a thin one (core/texel_rule.h).
#pragma once

#include "rilievo/capture/capture_source.h"

namespace rilievo {

// Where no ray through a texel's centre meets a surface, but a thin one goes through the texel,
// this is the farthest one, too. For captures whose `farthest` comes from such rays.
inline void bound_thin_texels(CapturedPicture& captured) {
  const std::span<const float> depth = captured.picture.depth.texels();
  std::size_t i = 0;
  for (float& farthest : captured.farthest.texels()) {
    if (farthest == kNoDepth) farthest = depth[i];
    ++i;
  }
}

}  // namespace rilievo
