#include "rilievo/layered_impostor/picture_textures.h"

#include <algorithm>
#include <cmath>

#include "rilievo/layered_impostor/draw_options.h"

namespace rilievo {

CellTexture cell_texture(int width, int height) {
  CellTexture texture;
  int side = SurfacePyramid::kBlock;
  texture.rows = (height + side - 1) / side;
  for (int& at : texture.level_at) {
    at = texture.columns;
    texture.columns += (width + side - 1) / side;
    side *= SurfacePyramid::kFactor;
  }
  return texture;
}

Image<glm::vec2> pyramid_cells(const TexelSurface& surface, const CellTexture& layout) {
  Image<glm::vec2> cells(layout.columns, layout.rows, glm::vec2(0));
  const SurfacePyramid pyramid = make_surface_pyramid(surface);
  for (std::size_t level = 0; level < pyramid.levels.size(); ++level) {
    const Image<SurfaceCell>& from = pyramid.levels[level];
    for (int y = 0; y < from.height(); ++y)
      for (int x = 0; x < from.width(); ++x) {
        const SurfaceCell& cell = from(x, y);
        cells(layout.level_at[level] + x, y) = {cell.front,
                                                std::abs(cell.back) * (cell.holes ? -1.0f : 1.0f)};
      }
  }
  return cells;
}

std::size_t layered_texture_bytes(int views, int width, int height, LayeredMethod method) {
  const std::size_t texels = std::size_t(width) * std::size_t(height);
  const CellTexture cells = cell_texture(width, height);
  return std::size_t(views) *
         (method == LayeredMethod::surfaces
              ? texels * (kColorBytes + kQBytes + kSlopeBytes + kLinksBytes) +
                    std::size_t(cells.columns) * std::size_t(cells.rows) * kCellBytes
              : texels * (kColorBytes + kIntervalBytes));
}

Image<glm::u8vec4> encoded_colors(const ColorImage& color) {
  Image<glm::u8vec4> out(color.width(), color.height());
  for (std::size_t i = 0; i < color.texels().size(); ++i) {
    const glm::vec4 c = color.texels()[i];
    const float alpha = std::clamp(c.a, 0.0f, 1.0f);
    glm::vec4 e(0.0f, 0.0f, 0.0f, alpha);
    for (int k = 0; k < 3 && alpha > 0; ++k) e[k] = alpha * srgb_from_linear(c[k] / c.a);
    out.texels()[i] = glm::u8vec4(glm::clamp(e, 0.0f, 1.0f) * 255.0f + 0.5f);
  }
  return out;
}

ShownObjects shown_objects(std::span<const DepthImage> pictures) {
  std::uint32_t only = kNoObject;
  for (const DepthImage& picture : pictures)
    for (const std::uint32_t object : picture.object.texels()) {
      if (object == kNoObject) continue;
      if (only == kNoObject) only = object;
      if (object != only) return {.several = true};
    }
  return {.only = only};
}

}  // namespace rilievo
