#include "rilievo/web_walk/dilate.h"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

namespace rilievo {
namespace {

// A block of WebP's chroma is 16 texels wide: what lies farther changes no edge.
constexpr int kRings = 16;

}  // namespace

void dilate_colors(Rgba8Image& picture) {
  const int w = picture.width(), h = picture.height();
  Image<std::uint8_t> known(w, h);
  std::vector<glm::ivec2> border, next;
  glm::dvec3 sum(0);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      known(x, y) = picture(x, y).a > 0;
      if (known(x, y))
        sum += glm::dvec3(glm::u8vec3(picture(x, y)));
      else
        border.emplace_back(x, y);
    }
  const std::size_t count = picture.texels().size() - border.size();
  if (count == 0) return;
  std::vector<std::pair<glm::ivec2, glm::u8vec3>> filled;
  for (int ring = 0; ring < kRings && !border.empty(); ++ring) {
    filled.clear();
    next.clear();
    for (const glm::ivec2& at : border) {
      glm::ivec3 around(0);
      int neighbours = 0;
      for (int y = std::max(0, at.y - 1); y <= std::min(h - 1, at.y + 1); ++y)
        for (int x = std::max(0, at.x - 1); x <= std::min(w - 1, at.x + 1); ++x) {
          if (!known(x, y)) continue;
          around += glm::ivec3(glm::u8vec3(picture(x, y)));
          ++neighbours;
        }
      if (neighbours == 0)
        next.push_back(at);
      else
        filled.emplace_back(at, glm::u8vec3((around + neighbours / 2) / neighbours));
    }
    for (const auto& [at, color] : filled) {
      picture(at.x, at.y) = glm::u8vec4(color, picture(at.x, at.y).a);
      known(at.x, at.y) = 1;
    }
    std::swap(border, next);
  }
  const glm::u8vec3 mean(sum / double(count) + 0.5);
  for (const glm::ivec2& at : border)
    picture(at.x, at.y) = glm::u8vec4(mean, picture(at.x, at.y).a);
}

}  // namespace rilievo
