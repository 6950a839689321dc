#include "rilievo/layered_impostor/picture_textures.h"

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

std::size_t layered_texture_bytes(int views, int width, int height, LayeredMethod method) {
  const std::size_t texels = std::size_t(width) * std::size_t(height);
  const CellTexture cells = cell_texture(width, height);
  return std::size_t(views) *
         (method == LayeredMethod::surfaces
              ? texels * (kColorBytes + kQBytes + kSlopeBytes + kLinksBytes) +
                    std::size_t(cells.columns) * std::size_t(cells.rows) * kCellBytes
              : texels * (kColorBytes + kIntervalBytes));
}

}  // namespace rilievo
