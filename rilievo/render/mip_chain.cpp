// A box filter, also where a size is odd: then a texel covers two texels of the level above and a
// part of a third one, each weighted by how much of it is covered. What is outside of the texture
// has no weight, whatever its wrap mode: areas never reach beyond it.
#include "rilievo/render/mip_chain.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "rilievo/core/color.h"
#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"

namespace rilievo {
namespace {

// From linear light to a byte: by 12 bits of it, and a step of the byte found.
struct Curves {
  std::array<float, 256> upper;         // the least linear light that is rounded to the next byte
  std::array<std::uint8_t, 4097> byte;  // of k / 4096
};

const Curves& srgb_curves() {
  static const Curves curves = [] {
    Curves c;
    for (int i = 0; i < 256; ++i)
      c.upper[std::size_t(i)] = i < 255 ? linear_from_srgb((float(i) + 0.5f) / 255.0f) : 2.0f;
    std::uint8_t byte = 0;
    for (int k = 0; k <= 4096; ++k) {
      while (float(k) / 4096.0f >= c.upper[byte]) ++byte;
      c.byte[std::size_t(k)] = byte;
    }
    return c;
  }();
  return curves;
}

std::uint8_t encode(const Curves& curves, float linear) {
  std::uint8_t byte = curves.byte[std::size_t(std::clamp(linear, 0.0f, 1.0f) * 4096.0f)];
  while (linear >= curves.upper[byte]) ++byte;
  return byte;
}

std::uint8_t encode(float value) {
  return std::uint8_t(std::clamp(value, 0.0f, 1.0f) * 255.0f + 0.5f);
}

// The texels of a row or column above that texel i of `small` covers, of `large`.
struct Covered {
  int first = 0, count = 0;
  float weight[3] = {0, 0, 0};  // sum 1
};

Covered covered(int i, int large, int small) {
  if (large == small) return {i, 1, {1, 0, 0}};
  const double scale = double(large) / small, from = i * scale, to = (i + 1) * scale;
  Covered c;
  c.first = std::min(int(from), large - 1);
  for (int k = c.first; k < large && double(k) < to - 1e-9; ++k) {
    RILIEVO_EXPECTS(c.count < 3);
    c.weight[c.count++] = float((std::min(to, k + 1.0) - std::max(from, double(k))) / scale);
  }
  return c;
}

}  // namespace

MipChain build_mip_chain(const Rgba8Image& texture, bool srgb, MipColors colors) {
  RILIEVO_EXPECTS(!texture.empty());
  MipChain chain;
  std::size_t size = 0;
  for (int width = texture.width(), height = texture.height();;
       width = std::max(1, width / 2), height = std::max(1, height / 2)) {
    chain.levels.push_back({width, height, size});
    if (chain.levels.size() > 1) size += std::size_t(width) * std::size_t(height);
    if (width == 1 && height == 1) break;
  }
  chain.texels.resize(size);
  const Curves& curves = srgb_curves();
  const std::array<float, 256>& linear = linear_of_srgb_bytes();
  for (std::size_t l = 1; l < chain.levels.size(); ++l) {
    const MipChain::Level& above = chain.levels[l - 1];
    const MipChain::Level& level = chain.levels[l];
    const glm::u8vec4* from = l == 1 ? texture.texels().data() : chain.texels.data() + above.offset;
    std::vector<Covered> columns;
    for (int x = 0; x < level.width; ++x) columns.push_back(covered(x, above.width, level.width));
    parallel_for(0, level.height, [&](int y) {
      const Covered rows = covered(y, above.height, level.height);
      glm::u8vec4* to =
          chain.texels.data() + level.offset + std::size_t(y) * std::size_t(level.width);
      for (int x = 0; x < level.width; ++x) {
        const Covered& column = columns[std::size_t(x)];
        glm::vec4 sum(0.0f);
        glm::vec3 shown(0.0f);
        for (int j = 0; j < rows.count; ++j)
          for (int i = 0; i < column.count; ++i) {
            const glm::u8vec4 c = from[std::size_t(rows.first + j) * std::size_t(above.width) +
                                       std::size_t(column.first + i)];
            const float weight = rows.weight[j] * column.weight[i];
            const auto part = [&](std::uint8_t byte) {
              return srgb ? linear[byte] : float(byte) * (1.0f / 255.0f);
            };
            const glm::vec3 color(part(c.r), part(c.g), part(c.b));
            const float alpha = float(c.a) * (1.0f / 255.0f);
            sum += weight * glm::vec4(color, alpha);
            shown += weight * alpha * color;
          }
        if (colors == MipColors::of_what_shows && sum.a > 0) sum = glm::vec4(shown / sum.a, sum.a);
        to[x] = srgb ? glm::u8vec4(encode(curves, sum.r), encode(curves, sum.g),
                                   encode(curves, sum.b), encode(sum.a))
                     : glm::u8vec4(encode(sum.r), encode(sum.g), encode(sum.b), encode(sum.a));
      }
    });
  }
  return chain;
}

}  // namespace rilievo
