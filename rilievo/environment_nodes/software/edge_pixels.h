// Which pixels of a frame does a silhouette cross? Internal to environment_nodes/software.
//
// Pixels in blocks of 8 x 8, as those of tiles: a word for each block, a bit for each pixel, row by
// row from the top. Marked pixels are numbered, so that what is kept of them alone lies together.
#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace rilievo {

// Marks of pixels.
class EdgePixels {
 public:
  static constexpr int kBlock = 8;

  // Nothing is marked.
  void begin(int width, int height) {
    columns_ = (width + kBlock - 1) / kBlock;
    words_.assign(std::size_t(columns_) * std::size_t((height + kBlock - 1) / kBlock), 0);
  }
  // A pixel of the frame. Several threads may mark at a time.
  void mark(int x, int y) {
    std::atomic_ref(words_[index(x, y)])
        .fetch_or(std::uint64_t(1) << (y % kBlock * kBlock + x % kBlock),
                  std::memory_order_relaxed);
  }
  // Numbers what is marked.
  void number() {
    first_.resize(words_.size());
    count_ = 0;
    for (std::size_t i = 0; i < words_.size(); ++i)
      first_[i] = count_, count_ += std::uint32_t(std::popcount(words_[i]));
  }

  // Of the block that pixel (x, y) is in.
  [[nodiscard]] std::uint64_t word(int x, int y) const { return words_[index(x, y)]; }
  // Once they are numbered.
  [[nodiscard]] std::size_t count() const { return count_; }
  // The number of the pixel at a bit of the block that (x, y) is in.
  [[nodiscard]] std::uint32_t number_of(int x, int y, int bit) const {
    const std::size_t i = index(x, y);
    return first_[i] + std::uint32_t(std::popcount(words_[i] & ((std::uint64_t(1) << bit) - 1)));
  }
  // Calls visit(x, y, number) for each.
  template <class Visit>
  void for_each(const Visit& visit) const {
    std::uint32_t number = 0;
    for (std::size_t i = 0; i < words_.size(); ++i)
      for (std::uint64_t word = words_[i]; word != 0; word &= word - 1) {
        const int bit = std::countr_zero(word), column = int(i) % columns_, row = int(i) / columns_;
        visit(column * kBlock + bit % kBlock, row * kBlock + bit / kBlock, number++);
      }
  }
  // Is any pixel of a rectangle marked? All its pixels must be in the frame.
  [[nodiscard]] bool any(int x0, int y0, int x1, int y1) const {
    for (int by = y0 / kBlock; by <= y1 / kBlock; ++by)
      for (int bx = x0 / kBlock; bx <= x1 / kBlock; ++bx) {
        const std::uint64_t word =
            words_[std::size_t(by) * std::size_t(columns_) + std::size_t(bx)];
        if (word == 0) continue;
        const auto bits = [](int low, int high, int block) {
          const int from = low > block * kBlock ? low - block * kBlock : 0,
                    to = high < block * kBlock + kBlock - 1 ? high - block * kBlock : kBlock - 1;
          return ((2u << to) - 1) & ~((1u << from) - 1);
        };
        const std::uint64_t columns = 0x0101010101010101u * std::uint64_t(bits(x0, x1, bx));
        for (unsigned rows = bits(y0, y1, by); rows != 0; rows &= rows - 1)
          if (word & columns & (std::uint64_t(0xff) << (kBlock * std::countr_zero(rows))))
            return true;
      }
    return false;
  }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return std::size_t(y / kBlock) * std::size_t(columns_) + std::size_t(x / kBlock);
  }

  int columns_ = 0;  // of blocks
  std::vector<std::uint64_t> words_;
  std::vector<std::uint32_t> first_;  // of each block
  std::uint32_t count_ = 0;
};

}  // namespace rilievo
