#include "rilievo/nailboard/cpu/memory_nailboard.h"

#include <algorithm>
#include <cstring>

#include "rilievo/core/expects.h"

namespace rilievo {

void MemoryNailboard::resize(int width, int height, int delta_bits) {
  RILIEVO_EXPECTS(1 <= width && width <= 16384 && 1 <= height && height <= 16384);
  RILIEVO_EXPECTS(2 <= delta_bits && delta_bits <= 16);
  width_ = width, height_ = height, delta_bits_ = delta_bits;
  // One texel beyond the last is read, with weight 0, and one more row, which nobody uses. Rows are
  // no power of two apart: those of a block would meet in one set of the cache.
  stride_ = (width + 1 + 15) / 16 * 16;
  if (stride_ % 256 == 0) stride_ += 16;
  const std::size_t texels = std::size_t(stride_) * std::size_t(height + 2);
  color_.assign(texels + kReadBeyond, 0);
  code_pairs_.assign(texels / 2 + kReadBeyond, 0xffffffffu);
  objects_.clear();
}

template <class Code>
void MemoryNailboard::set_row(int y, const glm::u8vec4* color, const Code* codes) {
  const std::size_t row = std::size_t(y) * std::size_t(stride_);
  std::memcpy(&color_[row], color, std::size_t(width_) * sizeof *color);
  for (int x = 0; x < width_; ++x) {
    const int shift = 16 * (x & 1);
    std::uint32_t& pair = code_pairs_[(row + std::size_t(x)) / 2];
    pair = (pair & ~(0xffffu << shift)) | std::uint32_t(codes[x]) << shift;
  }
}

void MemoryNailboard::find_cells() {
  const std::size_t count = std::size_t(cells_across()) * std::size_t(cells_down());
  cell_nearest_.assign(count, 0xffff);
  cell_opaque_.assign(count, 1);
  for (int y = 0; y < height_; ++y)
    for (int x = 0; x < width_; ++x) {
      const std::size_t cell =
          std::size_t(y / kCell) * std::size_t(cells_across()) + std::size_t(x / kCell);
      const std::uint32_t here = code(x, y);
      cell_nearest_[cell] = std::min(cell_nearest_[cell], std::uint16_t(here));
      const std::size_t texel = std::size_t(y) * std::size_t(stride_) + std::size_t(x);
      if (color_[texel] >> 24 != 255 || here > steps()) cell_opaque_[cell] = 0;
    }
  nearest_ = *std::min_element(cell_nearest_.begin(), cell_nearest_.end());
}

void MemoryNailboard::assign(const Nailboard& nailboard) {
  const int width = nailboard.color.width(), height = nailboard.color.height();
  resize(width, height, nailboard.geometry.delta_bits);
  for (int y = 0; y < height; ++y)
    set_row(y, nailboard.color.row(y).data(), nailboard.delta.row(y).data());
  find_cells();
}

void MemoryNailboard::assign(int width, int height, std::span<const glm::u8vec4> color,
                             const AtlasPicture& encoded, int delta_bits) {
  RILIEVO_EXPECTS_EQ(color.size(), std::size_t(width) * std::size_t(height));
  resize(width, height, delta_bits);
  for (int y = 0; y < height; ++y) {
    const std::size_t from = std::size_t(height - 1 - y) * std::size_t(width);
    if (delta_bits > 8)
      set_row(y, &color[from], &encoded.codes16[from]);
    else
      set_row(y, &color[from], &encoded.codes8[from]);
  }
  find_cells();
}

void MemoryNailboard::assign_objects(std::span<const std::uint32_t> objects, bool from_bottom) {
  RILIEVO_EXPECTS_EQ(objects.size(), std::size_t(width_) * std::size_t(height_));
  objects_.assign(color_.size(), kNoObject);
  for (int y = 0; y < height_; ++y)
    std::copy_n(&objects[std::size_t(from_bottom ? height_ - 1 - y : y) * std::size_t(width_)],
                width_, &objects_[std::size_t(y) * std::size_t(stride_)]);
}

Nailboard MemoryNailboard::copy(const PictureGeometry& geometry) const {
  Nailboard copy{geometry, Rgba8Image(width_, height_), Image<std::uint16_t>(width_, height_)};
  for (int y = 0; y < height_; ++y) {
    std::memcpy(copy.color.row(y).data(), &color_[std::size_t(y) * std::size_t(stride_)],
                std::size_t(width_) * sizeof(glm::u8vec4));
    for (int x = 0; x < width_; ++x) copy.delta(x, y) = std::uint16_t(code(x, y));
  }
  return copy;
}

std::size_t MemoryNailboard::bytes() const {
  return (color_.size() + code_pairs_.size() + objects_.size()) * sizeof(std::uint32_t) +
         cell_nearest_.size() * sizeof(std::uint16_t) + cell_opaque_.size();
}

}  // namespace rilievo
