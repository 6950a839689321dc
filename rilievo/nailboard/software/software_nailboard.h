// How is a nailboard kept for drawing on processors?
//
// Colours and codes of Delta in planes of their own, in padded rows, the top row first. Cells of
// 8 x 8 texels say what is worth looking at: the nearest code, whether there is any, and whether
// all texels are opaque. An atlas on the GPU (nailboard/gl/nailboard_atlas.h) holds the same.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "rilievo/nailboard/encode_picture.h"
#include "rilievo/nailboard/encode_prewarped.h"
#include "rilievo/nailboard/nailboard.h"

namespace rilievo {

// A nailboard in memory. Filled anew, it allocates only if it grows; filling uses all cores.
class SoftwareNailboard {
 public:
  static constexpr int kCell = 8;  // texels a side
  // So many entries beyond the last one of color() and of code_pairs() may be read.
  static constexpr int kReadBeyond = 16;

  // Copies a nailboard.
  void assign(const Nailboard& nailboard);
  // Copies a picture as an atlas takes it: rows from the bottom, encoded with `delta_bits`.
  void assign(int width, int height, std::span<const glm::u8vec4> color,
              const AtlasPicture& encoded, int delta_bits);
  // Copies a piece of a pre-warped picture, as encode_prewarped() encodes it.
  void assign(const Prewarped& picture, const PicturePiece& piece);
  // The identifiers of the objects that the texels show; `from_bottom`: the bottom row first.
  void assign_objects(std::span<const std::uint32_t> objects, bool from_bottom);

  // A copy as assign() takes it; `geometry` is the picture's.
  [[nodiscard]] Nailboard copy(const PictureGeometry& geometry) const;

  [[nodiscard]] int width() const { return width_; }
  [[nodiscard]] int height() const { return height_; }
  [[nodiscard]] int delta_bits() const { return delta_bits_; }
  // Entries from one row to the next, even; a row has at least one more than texels.
  [[nodiscard]] int stride() const { return stride_; }
  [[nodiscard]] int cells_across() const { return (width_ + kCell - 1) / kCell; }
  [[nodiscard]] int cells_down() const { return (height_ + kCell - 1) / kCell; }

  // The texels, sRGB, premultiplied, R in the lowest byte. Three rows more than the picture's.
  [[nodiscard]] const std::uint32_t* color() const { return color_.data(); }
  // The codes of two texels a word, the left one in the lower half; above steps(): nothing.
  [[nodiscard]] const std::uint32_t* code_pairs() const { return code_pairs_.data(); }
  [[nodiscard]] std::uint32_t code(int x, int y) const {
    const int i = y * stride_ + x;
    return code_pairs_[std::size_t(i >> 1)] >> (16 * (i & 1)) & 0xffffu;
  }
  // Frees the memory of assign_objects(); the next assign() does, too.
  void drop_objects() { std::vector<std::uint32_t>().swap(objects_); }
  // Of each texel, in rows of stride(); null if there are none.
  [[nodiscard]] const std::uint32_t* objects() const {
    return objects_.empty() ? nullptr : objects_.data();
  }
  // The nearest code of each cell; above steps(): the cell is empty.
  [[nodiscard]] const std::uint16_t* cell_nearest() const { return cell_nearest_.data(); }
  // Is each texel of the cell opaque, with a Delta?
  [[nodiscard]] const std::uint8_t* cell_opaque() const { return cell_opaque_.data(); }
  // Of the whole picture.
  [[nodiscard]] std::uint32_t nearest() const { return nearest_; }
  [[nodiscard]] std::uint32_t steps() const { return delta_steps(delta_bits_); }
  // The memory that it holds, which suffices for the largest picture so far.
  [[nodiscard]] std::size_t bytes() const;
  // The memory that a picture of this size needs, without objects.
  [[nodiscard]] static std::size_t bytes_of(int width, int height);

 private:
  // Of the vectors below, in elements.
  struct Sizes {
    std::size_t stride, shown, color, code_pairs, cells;
  };
  [[nodiscard]] static Sizes sizes_of(int width, int height);
  template <class Row>
  void fill(int width, int height, int delta_bits, const Row& row);

  int width_ = 0, height_ = 0, stride_ = 0, delta_bits_ = 0;
  std::uint32_t nearest_ = 0;
  std::vector<std::uint32_t> color_, code_pairs_, objects_;
  std::vector<std::uint16_t> cell_nearest_;
  std::vector<std::uint8_t> cell_opaque_;
};

}  // namespace rilievo
