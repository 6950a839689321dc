#include "rilievo/layered_impostor/gl/silhouette_band.h"

#include <algorithm>
#include <cmath>

namespace rilievo {
namespace {

float toward_viewers(const TexelSurface& surface) {
  return surface.camera.keeps_farthest() ? -1.0f : 1.0f;
}

}  // namespace

Image<float> silhouette_band(const TexelSurface& surface) {
  const Image<SurfaceTexel>& texels = surface.texels;
  const int w = texels.width(), h = texels.height();
  const float sigma = toward_viewers(surface);
  const float texel_per_q = float(patch_gap_per_q(surface.camera) / kPatchGap);
  Image<float> band(w, h, 0.0f);
  for (int y = 0; y < h; ++y)
    for (int x = 0; x < w; ++x) {
      if (texels(x, y).q != 0) continue;
      float front = -1e30f;
      for (int v = std::max(y - 1, 0); v <= std::min(y + 1, h - 1); ++v)
        for (int u = std::max(x - 1, 0); u <= std::min(x + 1, w - 1); ++u) {
          if (texels(u, v).q == 0) continue;
          const DepthInterval patch = depth_interval(texels(u, v));
          front = std::max({front, sigma / patch.front, sigma / patch.back});
        }
      if (front > -1e30f) band(x, y) = -std::abs(front + texel_per_q * std::abs(front));
    }
  return band;
}

void add_band(const Image<float>& band, const TexelSurface& surface, const CellTexture& layout,
              Image<glm::vec2>& cells) {
  const float sigma = toward_viewers(surface);
  for (int y = 0; y < band.height(); ++y)
    for (int x = 0; x < band.width(); ++x) {
      if (band(x, y) == 0) continue;
      int side = SurfacePyramid::kBlock;
      for (const int first : layout.level_at) {
        float& front = cells(first + x / side, y / side).x;
        front = std::max(front, -sigma * band(x, y));
        side *= SurfacePyramid::kFactor;
      }
    }
}

}  // namespace rilievo
