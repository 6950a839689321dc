// What is a picture of a layered impostor kept as for drawing, and how large is it? Internal to
// `layered_impostor`.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "rilievo/core/color.h"
#include "rilievo/core/depth_image.h"
#include "rilievo/core/image.h"
#include "rilievo/warp/surface_pyramid.h"

namespace rilievo {

// Bytes of a texel, by texture.
inline constexpr int kColorBytes = 4;     // colour, sRGB-encoded under its alpha
inline constexpr int kQBytes = 4;         // 1 / eye_z
inline constexpr int kSlopeBytes = 8;     // its slopes to the four sides
inline constexpr int kLinksBytes = 1;     // which neighbours are the same surface
inline constexpr int kIntervalBytes = 4;  // depths between which a slice shows the texel
inline constexpr int kCellBytes = 8;      // of the pyramid: front and back of a cell

// The pyramid of a picture of this size, its levels side by side.
struct CellTexture {
  int columns = 0, rows = 0;
  std::array<int, SurfacePyramid::kLevels> level_at{};
};
[[nodiscard]] CellTexture cell_texture(int width, int height);
// The front of each cell, and the magnitude of its back, negative if there are holes in it; 0 where
// there is no cell.
[[nodiscard]] Image<glm::vec2> pyramid_cells(const TexelSurface& surface,
                                             const CellTexture& layout);

// Linear, premultiplied colours as frames are encoded: sRGB, which alpha then multiplies.
[[nodiscard]] Image<glm::u8vec4> encoded_colors(const ColorImage& color);

// The objects that pictures show.
struct ShownObjects {
  bool several = false;
  std::uint32_t only = kNoObject;  // the object, if it is one
};
[[nodiscard]] ShownObjects shown_objects(std::span<const DepthImage> pictures);

}  // namespace rilievo
