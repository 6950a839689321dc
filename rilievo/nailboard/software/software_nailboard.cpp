#include "rilievo/nailboard/software/software_nailboard.h"

#include <algorithm>
#include <bit>
#include <cstddef>
#include <cstring>

#include "rilievo/core/expects.h"
#include "rilievo/core/parallel_for.h"
#include "rilievo/nailboard/software/keep_rows.h"

namespace rilievo {
namespace {

static_assert(std::endian::native == std::endian::little, "two codes make a word");

constexpr std::uint16_t kNoCode = 0xffff;
constexpr std::uint32_t kNoPair = 0xffffffff;

// Room for `size` elements and no more, whose values are lost where it grows.
template <class T>
void make_room(std::vector<T>& elements, std::size_t size) {
  if (elements.capacity() < size) {
    elements.clear();  // nothing to copy
    elements.reserve(size);
  }
  elements.resize(size);
}

}  // namespace

SoftwareNailboard::Sizes SoftwareNailboard::sizes_of(int width, int height) {
  // One texel beyond the last is read, with weight 0, and more rows, which nobody uses. Rows are
  // no power of two apart: those of a block would meet in one set of the cache.
  std::size_t stride = (std::size_t(width) + 1 + 15) / 16 * 16;
  if (stride % 256 == 0) stride += 16;
  const std::size_t shown = stride * std::size_t(height);
  const auto cells = [](int texels) { return std::size_t((texels + kCell - 1) / kCell); };
  return {stride, shown, shown + 3 * stride + kReadBeyond, shown / 2 + stride + kReadBeyond,
          cells(width) * cells(height)};
}

// Rows are written and looked at by bands of cells. `row(y, codes)` fills in the codes of row y,
// from the top, and returns its colours.
template <class Row>
void SoftwareNailboard::fill(int width, int height, int delta_bits, const Row& row) {
  RILIEVO_EXPECTS(1 <= width && width <= 16384 && 1 <= height && height <= 16384);
  RILIEVO_EXPECTS(2 <= delta_bits && delta_bits <= 16);
  width_ = width, height_ = height, delta_bits_ = delta_bits;
  const Sizes sizes = sizes_of(width, height);
  const std::size_t stride = sizes.stride, shown = sizes.shown;
  stride_ = int(stride);
  make_room(color_, sizes.color);
  make_room(code_pairs_, sizes.code_pairs);
  std::fill(color_.begin() + std::ptrdiff_t(shown), color_.end(), 0);
  std::fill(code_pairs_.begin() + std::ptrdiff_t(shown / 2), code_pairs_.end(), kNoPair);
  drop_objects();
  make_room(cell_nearest_, sizes.cells);
  make_room(cell_opaque_, sizes.cells);
  parallel_for(0, cells_down(), [&](int band) {
    // Kept: a steady frame allocates nothing.
    static thread_local std::vector<std::uint16_t> codes;
    static thread_local BandColumns columns;
    codes.resize(stride);
    std::fill(codes.begin() + width, codes.end(), kNoCode);
    const int begin = band * kCell, end = std::min(height_, begin + kCell);
    for (int y = begin; y < end; ++y) {
      const auto* const texels = reinterpret_cast<const std::uint32_t*>(row(y, codes.data()));
      const std::size_t at = std::size_t(y) * stride;
      keep_row(texels, codes.data(), width, int(stride), y == begin, &color_[at],
               &code_pairs_[at / 2], columns);
    }
    const auto across = std::size_t(cells_across()), first = std::size_t(band) * across;
    keep_cells(columns, across, steps(), &cell_nearest_[first], &cell_opaque_[first]);
  });
  nearest_ = *std::min_element(cell_nearest_.begin(), cell_nearest_.end());
}

void SoftwareNailboard::assign(const Nailboard& nailboard) {
  fill(nailboard.color.width(), nailboard.color.height(), nailboard.geometry.delta_bits,
       [&](int y, std::uint16_t* codes) {
         std::ranges::copy(nailboard.delta.row(y), codes);
         return nailboard.color.row(y).data();
       });
}

void SoftwareNailboard::assign(int width, int height, std::span<const glm::u8vec4> color,
                               const AtlasPicture& encoded, int delta_bits) {
  RILIEVO_EXPECTS_EQ(color.size(), std::size_t(width) * std::size_t(height));
  fill(width, height, delta_bits, [&](int y, std::uint16_t* codes) {
    const std::size_t from = std::size_t(height - 1 - y) * std::size_t(width);
    if (delta_bits > 8)
      std::copy_n(&encoded.codes16[from], width, codes);
    else
      std::copy_n(&encoded.codes8[from], width, codes);
    return &color[from];
  });
}

void SoftwareNailboard::assign(const Prewarped& picture, const PicturePiece& piece) {
  fill(piece.width, piece.height, picture.geometry.delta_bits, [&](int y, std::uint16_t* codes) {
    codes_of_row(picture, piece, y, codes);
    return &picture.color[std::size_t(piece.y + y) * std::size_t(picture.width()) +
                          std::size_t(piece.x)];
  });
}

void SoftwareNailboard::assign_objects(std::span<const std::uint32_t> objects, bool from_bottom) {
  RILIEVO_EXPECTS_EQ(objects.size(), std::size_t(width_) * std::size_t(height_));
  objects_.assign(color_.size(), kNoObject);
  for (int y = 0; y < height_; ++y)
    std::copy_n(&objects[std::size_t(from_bottom ? height_ - 1 - y : y) * std::size_t(width_)],
                width_, &objects_[std::size_t(y) * std::size_t(stride_)]);
}

Nailboard SoftwareNailboard::copy(const PictureGeometry& geometry) const {
  Nailboard copy{geometry, Rgba8Image(width_, height_), Image<std::uint16_t>(width_, height_)};
  for (int y = 0; y < height_; ++y) {
    std::memcpy(copy.color.row(y).data(), &color_[std::size_t(y) * std::size_t(stride_)],
                std::size_t(width_) * sizeof(glm::u8vec4));
    for (int x = 0; x < width_; ++x) copy.delta(x, y) = std::uint16_t(code(x, y));
  }
  return copy;
}

std::size_t SoftwareNailboard::bytes() const {
  return (color_.capacity() + code_pairs_.capacity() + objects_.capacity()) *
             sizeof(std::uint32_t) +
         cell_nearest_.capacity() * sizeof(std::uint16_t) + cell_opaque_.capacity();
}

std::size_t SoftwareNailboard::bytes_of(int width, int height) {
  const Sizes sizes = sizes_of(width, height);
  return (sizes.color + sizes.code_pairs) * sizeof(std::uint32_t) +
         sizes.cells * (sizeof(std::uint16_t) + sizeof(std::uint8_t));
}

}  // namespace rilievo
