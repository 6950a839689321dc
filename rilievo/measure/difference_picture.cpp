#include <algorithm>
#include <array>
#include <cstdlib>

#include "rilievo/measure/report.h"

namespace rilievo {
namespace {

// Black, violet, orange, white: evenly spaced, and rising in lightness.
constexpr std::array<glm::vec3, 5> kHeat = {glm::vec3(0, 0, 0), glm::vec3(72, 20, 110),
                                            glm::vec3(190, 55, 84), glm::vec3(250, 160, 30),
                                            glm::vec3(255, 255, 240)};

glm::u8vec4 heat(float t) {
  const float at = std::clamp(t, 0.0f, 1.0f) * float(kHeat.size() - 1);
  const std::size_t i = std::min(std::size_t(at), kHeat.size() - 2);
  const glm::vec3 c = glm::mix(kHeat[i], kHeat[i + 1], at - float(i));
  return {glm::u8vec3(c + 0.5f), 255};
}

}  // namespace

Rgba8Image difference_picture(const Rgba8Image& a, const Rgba8Image& b, int full_scale) {
  RILIEVO_EXPECTS(a.width() == b.width() && a.height() == b.height());
  RILIEVO_EXPECTS_GT(full_scale, 0);
  std::array<glm::u8vec4, 256> colors;
  for (int d = 0; d < 256; ++d) colors[d] = heat(float(d) / float(full_scale));
  Rgba8Image out(a.width(), a.height());
  for (std::size_t i = 0; i < out.texels().size(); ++i) {
    int most = 0;
    for (int c = 0; c < 3; ++c)
      most = std::max(most, std::abs(int(a.texels()[i][c]) - int(b.texels()[i][c])));
    out.texels()[i] = colors[most];
  }
  return out;
}

}  // namespace rilievo
