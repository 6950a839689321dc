// In which blocks of 8 x 8 pixels of a frame is a node drawn? Internal to
// environment_nodes/software. Rows from the top, as those of tiles.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace rilievo {

// Marks of blocks, and sums of them, by which any rectangle is asked in constant time
// [Crow 1984, Summed-Area Tables].
class FrameBlocks {
 public:
  static constexpr int kBlock = 8;

  // Nothing is marked.
  void begin(int width, int height) {
    columns_ = (width + kBlock - 1) / kBlock, rows_ = (height + kBlock - 1) / kBlock;
    marked_.assign(std::size_t(columns_) * std::size_t(rows_), 0);
  }
  [[nodiscard]] int columns() const { return columns_; }
  [[nodiscard]] int rows() const { return rows_; }
  // Marks the blocks from (x0, y0) to (x1, y1), both included, as far as they lie in the frame.
  void mark(int x0, int y0, int x1, int y1) {
    x0 = std::max(x0, 0), y0 = std::max(y0, 0);
    x1 = std::min(x1, columns_ - 1), y1 = std::min(y1, rows_ - 1);
    for (int y = y0; y <= y1; ++y)
      for (int x = x0; x <= x1; ++x) marked_[index(x, y)] = 1;
  }
  // Sums what is marked, once all is.
  void finish() {
    const std::size_t wide = std::size_t(columns_) + 1;
    sums_.assign(wide * (std::size_t(rows_) + 1), 0);
    for (std::size_t y = 0; y < std::size_t(rows_); ++y) {
      std::uint32_t row = 0;
      for (std::size_t x = 0; x < std::size_t(columns_); ++x) {
        row += marked_[y * std::size_t(columns_) + x];
        sums_[(y + 1) * wide + x + 1] = sums_[y * wide + x + 1] + row;
      }
    }
  }

  // Is the block of a pixel marked?
  [[nodiscard]] bool holds(int x, int y) const {
    return marked_[index(x / kBlock, y / kBlock)] != 0;
  }
  // Once they are summed: is any block marked that the pixels from (x0, y0) to (x1, y1), both
  // included and in the frame, lie in?
  [[nodiscard]] bool any(int x0, int y0, int x1, int y1) const {
    const std::size_t wide = std::size_t(columns_) + 1;
    const auto sum = [&](int x, int y) { return sums_[std::size_t(y) * wide + std::size_t(x)]; };
    const int left = x0 / kBlock, top = y0 / kBlock, right = x1 / kBlock + 1,
              bottom = y1 / kBlock + 1;
    return sum(right, bottom) + sum(left, top) != sum(left, bottom) + sum(right, top);
  }
  // The share of the blocks that is marked, once they are summed.
  [[nodiscard]] double share() const {
    return marked_.empty() ? 0 : double(sums_.back()) / double(marked_.size());
  }

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    return std::size_t(y) * std::size_t(columns_) + std::size_t(x);
  }

  int columns_ = 0, rows_ = 0;
  std::vector<std::uint8_t> marked_;
  std::vector<std::uint32_t> sums_;
};

}  // namespace rilievo
