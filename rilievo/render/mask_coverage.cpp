#include "rilievo/render/mask_coverage.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/scene/scene.h"

namespace rilievo {
namespace {

constexpr int kOpaqueMask = 16 * 255;  // the weights of a bilinear sample are whole 16ths

// How many samples of a level have an alpha, in units of 1 / kOpaqueMask.
using Histogram = std::array<std::int64_t, std::size_t(kOpaqueMask) + 1>;

// Adds rows [first, end): what bilinear interpolation gives at four places in each texel, a quarter
// of a texel from its centre. That is what a frame reads, not the texels themselves.
void add_rows(std::span<const glm::u8vec4> texels, int width, int height, int first, int end,
              Histogram& count) {
  for (int y = first; y < end; ++y)
    for (int x = 0; x < width; ++x) {
      const auto alpha = [&](int i, int j) {
        return int(texels[std::size_t(std::clamp(j, 0, height - 1)) * std::size_t(width) +
                          std::size_t(std::clamp(i, 0, width - 1))]
                       .a);
      };
      for (int down = -1; down <= 1; down += 2)
        for (int across = -1; across <= 1; across += 2)
          ++count[std::size_t(9 * alpha(x, y) + 3 * alpha(x + across, y) + 3 * alpha(x, y + down) +
                              alpha(x + across, y + down))];
    }
}

Histogram histogram_of(std::span<const glm::u8vec4> texels, int width, int height) {
  constexpr int kParts = 16;
  std::vector<Histogram> counts(kParts);
  parallel_for(0, kParts, [&](int i) {
    add_rows(texels, width, height, int(std::int64_t(height) * i / kParts),
             int(std::int64_t(height) * (i + 1) / kParts), counts[std::size_t(i)]);
  });
  Histogram count{};
  for (const Histogram& part : counts)
    for (std::size_t alpha = 0; alpha < count.size(); ++alpha) count[alpha] += part[alpha];
  return count;
}

// The threshold at which the share that passes is nearest to `share`: in the middle between the
// least alpha that passes and the next one below.
double threshold_for(const Histogram& count, std::int64_t samples, double share) {
  std::int64_t passing = 0;
  int least = kOpaqueMask + 1;  // of those that pass
  for (int alpha = kOpaqueMask; alpha >= 0; --alpha) {
    const std::int64_t here = count[std::size_t(alpha)];
    if (here == 0) continue;
    const double with = double(passing + here) / double(samples) - share;
    const double without = share - double(passing) / double(samples);
    if (with > without) return 0.5 * (least + alpha);
    passing += here;
    least = alpha;
  }
  return 0.5 * least;
}

}  // namespace

float mask_threshold(const Material& material) {
  if (material.alpha_mode != AlphaMode::mask || material.alpha_cutoff <= 0 ||
      material.base_color.a < material.alpha_cutoff)
    return 0;
  return material.alpha_cutoff / material.base_color.a;
}

MipChain build_mask_mip_chain(const Rgba8Image& texture, bool srgb, float threshold) {
  RILIEVO_EXPECTS(threshold > 0 && threshold <= 1);
  MipChain chain = build_mip_chain(texture, srgb, MipColors::of_what_shows);
  const auto passing_share = [&](const Histogram& count, std::int64_t samples) {
    std::int64_t passing = 0;
    for (int alpha = int(std::ceil(double(threshold) * kOpaqueMask)); alpha <= kOpaqueMask; ++alpha)
      passing += count[std::size_t(alpha)];
    return double(passing) / double(samples);
  };
  const std::int64_t texels = std::int64_t(texture.width()) * texture.height();
  const double share =
      passing_share(histogram_of(texture.texels(), texture.width(), texture.height()), 4 * texels);
  if (share <= 0 || share >= 1) return chain;
  for (std::size_t l = 1; l < chain.levels.size(); ++l) {
    const MipChain::Level& level = chain.levels[l];
    const std::span<glm::u8vec4> own(chain.texels.data() + level.offset,
                                     std::size_t(level.width) * std::size_t(level.height));
    const Histogram count = histogram_of(own, level.width, level.height);
    const double here = threshold_for(count, 4 * std::int64_t(own.size()), share);
    const double factor = double(threshold) * kOpaqueMask / std::max(here, 0.5);
    // Rounded down where less is to pass: else all of what is opaque passes a threshold of 1.
    const double round = factor < 1 ? 0 : 0.5;
    for (glm::u8vec4& texel : own)
      texel.a = std::uint8_t(std::min(255.0, std::floor(double(texel.a) * factor + round)));
  }
  return chain;
}

}  // namespace rilievo
