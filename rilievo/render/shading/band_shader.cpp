#include "rilievo/render/shading/band_shader.h"

#include <algorithm>
#include <bit>

#include "rilievo/core/expects.h"

namespace rilievo {

void BandShader::shade(const PictureView& view, int from, int to) {
  RILIEVO_EXPECTS(0 <= from && from < to && to <= from + kBand);
  const std::size_t width = std::size_t(view.samples.width);
  const std::size_t texels = std::size_t(to - from) * width;
  covered_.resize(texels);
  nearest_.resize(texels);
  for (int y = from; y < to; ++y)
    view.samples.samples == 4 ? find_seen<4>(view, y, y - from) : find_seen<1>(view, y, y - from);
  sums_.assign(texels, glm::vec3(0.0f));
  seen_.shade(view.scene, [&](const SeenTriangles::Shaded& shaded) {
    const auto& rgb = shaded.colors.rgb;
    for (std::size_t i = 0; i < shaded.pixels.size(); ++i) {
      const SeenTriangles::Pixel& pixel = shaded.pixels[i];
      sums_[std::size_t(pixel.y - from) * width + pixel.x] +=
          float(std::popcount(pixel.samples)) * glm::vec3(rgb[0][i], rgb[1][i], rgb[2][i]);
    }
  });
}

// Depth and coverage of a row, and what is to be shaded there.
template <int samples>
void BandShader::find_seen(const PictureView& view, int y, int row) {
  const int width = view.samples.width;
  const float* depths = view.samples.depths(y);
  const std::uint32_t* triangles = view.samples.triangles(y);
  const std::size_t first = std::size_t(row) * std::size_t(width);
  const auto add = [&](std::uint32_t triangle, int x, unsigned set) {
    seen_.add(view.scene.meshes,
              {triangle, std::uint16_t(x), std::uint16_t(y), std::uint16_t(set)});
  };
  for (int x = 0; x < width; ++x, depths += samples, triangles += samples) {
    float nearest = 1.0f;
    int covered = 0;
    bool alike = true;
    for (int s = 0; s < samples; ++s) {
      nearest = std::min(nearest, depths[s]);
      covered += depths[s] < 1.0f;
      alike &= triangles[s] == triangles[0];
    }
    nearest_[first + std::size_t(x)] = nearest;
    covered_[first + std::size_t(x)] = std::uint8_t(covered);
    if (covered == 0) continue;
    if (covered == samples && alike) {
      add(triangles[0], x, (1u << samples) - 1);
      continue;
    }
    for (int s = 0; s < samples; ++s) {
      if (depths[s] >= 1.0f) continue;
      unsigned same = 0;
      for (int k = 0; k < samples; ++k)
        same |= unsigned(depths[k] < 1.0f && triangles[k] == triangles[s]) << k;
      if (same >> s << s == same) add(triangles[s], x, same);  // s is the first
    }
  }
}

}  // namespace rilievo
