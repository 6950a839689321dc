// Texels in memory, row by row, without padding; row 0 is the top row, as in files.
//
// Texel (x, y) covers [x, x+1) x [y, y+1); its centre is (x + 0.5, y + 0.5).
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <span>
#include <vector>

#include "rilievo/core/expects.h"

namespace rilievo {

// A rectangle of texels that owns its memory.
template <class T>
class Image {
 public:
  Image() = default;
  Image(int width, int height, T fill = T{})
      : width_(width), height_(height), texels_(std::size_t(width) * std::size_t(height), fill) {
    RILIEVO_EXPECTS_GE(width, 0);
    RILIEVO_EXPECTS_GE(height, 0);
  }

  // Sets the size. Keeps its memory where that suffices; what the texels are is not specified.
  void resize(int width, int height) {
    RILIEVO_EXPECTS(width >= 0 && height >= 0);
    width_ = width, height_ = height;
    texels_.resize(std::size_t(width) * std::size_t(height));
  }

  [[nodiscard]] int width() const noexcept { return width_; }
  [[nodiscard]] int height() const noexcept { return height_; }
  [[nodiscard]] bool empty() const noexcept { return texels_.empty(); }

  [[nodiscard]] T& operator()(int x, int y) { return texels_[index(x, y)]; }
  [[nodiscard]] const T& operator()(int x, int y) const { return texels_[index(x, y)]; }

  [[nodiscard]] std::span<T> texels() noexcept { return texels_; }
  [[nodiscard]] std::span<const T> texels() const noexcept { return texels_; }
  [[nodiscard]] std::span<T> row(int y) {
    return {texels_.data() + index(0, y), std::size_t(width_)};
  }
  [[nodiscard]] std::span<const T> row(int y) const {
    return {texels_.data() + index(0, y), std::size_t(width_)};
  }

  friend bool operator==(const Image&, const Image&) = default;

 private:
  [[nodiscard]] std::size_t index(int x, int y) const {
    RILIEVO_EXPECTS(x >= 0 && x < width_ && y >= 0 && y < height_);
    return std::size_t(y) * std::size_t(width_) + std::size_t(x);
  }

  int width_ = 0, height_ = 0;
  std::vector<T> texels_;
};

// Linear colour; alpha premultiplied.
using ColorImage = Image<glm::vec4>;

}  // namespace rilievo
