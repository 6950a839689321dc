#include "rilievo/relief_impostor/impostor_picture.h"

#include <algorithm>
#include <bit>

#include "rilievo/relief_impostor/warp_passes.h"

namespace rilievo {

ImpostorPicture impostor_picture(const Nailboard& nailboard) {
  RILIEVO_EXPECTS(nailboard.geometry.delta_bits == kLevelBits);
  RILIEVO_EXPECTS(nailboard.geometry.capture.projection == Projection::perspective);
  ImpostorPicture picture;
  picture.geometry = nailboard.geometry;
  const int w = picture.width(), h = picture.height();
  picture.pitch = warp_pitch(w);
  picture.texels.assign(std::size_t(picture.pitch) * std::size_t(h), WarpTexel{});
  picture.min = {w, h};
  picture.nearest = kEmptyLevel;
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      const glm::u8vec4 color = nailboard.color(x, y);
      const std::uint32_t level = nailboard.delta(x, y);
      if (color.a == 0 || level >= kEmptyLevel) continue;
      picture.texels[std::size_t(y) * std::size_t(picture.pitch) + std::size_t(x)] = {
          std::bit_cast<std::uint32_t>(color), level};
      picture.min = glm::min(picture.min, glm::ivec2(x, y));
      picture.max = glm::max(picture.max, glm::ivec2(x + 1, y + 1));
      picture.nearest = std::min(picture.nearest, level);
      picture.farthest = std::max(picture.farthest, level);
    }
  return picture;
}

ImpostorPicture impostor_picture(const DepthImage& picture) {
  return impostor_picture(make_nailboard(picture, kLevelBits));
}

}  // namespace rilievo
