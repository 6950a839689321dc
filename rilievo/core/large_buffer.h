// Where do many megabytes lie that are written anew for each frame? In large pages, where the
// system has them.
//
// The first touch of a page costs the same whether it is small or large, up to the zeroing: on
// virtual machines 10 microseconds and more for each 4 kB, which can be most of a program's first
// frame. So memory of 2 MB and more is aligned to pages of 2 MB and, on Linux, asked for in those
// (transparent huge pages), and nothing is touched before it is used.
#pragma once

#include <cstddef>
#include <memory>
#include <type_traits>

namespace rilievo {

namespace detail {

struct FreeLargeMemory {
  std::size_t alignment = 0;
  void operator()(std::byte* memory) const noexcept;
};
using LargeMemory = std::unique_ptr<std::byte, FreeLargeMemory>;

[[nodiscard]] LargeMemory allocate_large(std::size_t bytes);

}  // namespace detail

// Elements of a plain type that are not initialized, and are lost when the buffer grows.
template <class T>
class LargeBuffer {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_default_constructible_v<T>);

 public:
  // Makes room for `size` elements. Where there is room already, elements keep their values;
  // otherwise all of them are undefined afterwards. The old memory is freed first.
  void require(std::size_t size) {
    if (size <= size_) return;
    memory_.reset();
    size_ = 0;
    memory_ = detail::allocate_large(size * sizeof(T));
    size_ = size;
  }

  // The number of elements that there is room for.
  [[nodiscard]] std::size_t size() const { return size_; }
  [[nodiscard]] T* data() { return reinterpret_cast<T*>(memory_.get()); }
  [[nodiscard]] const T* data() const { return reinterpret_cast<const T*>(memory_.get()); }
  [[nodiscard]] T& operator[](std::size_t i) { return data()[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const { return data()[i]; }

 private:
  detail::LargeMemory memory_;
  std::size_t size_ = 0;
};

}  // namespace rilievo
