// Memory of many megabytes that costs little when it is first used: by large pages.
//
// The system maps a page when a program first touches it. On a virtual machine that takes about 10
// microseconds for each page of 4 kB, which delays a program's first frame; a page of 2 MB takes
// little longer than clearing it. Buffers of 2 MB and more therefore begin at a multiple of 2 MB
// and, on Linux, ask for transparent huge pages. Elements are not initialized, so that a page is
// mapped only when it is used.
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

// An array of elements that are not initialized, and are lost when it grows.
template <class T>
class LargeBuffer {
  static_assert(std::is_trivially_copyable_v<T> && std::is_trivially_default_constructible_v<T>);

 public:
  // Makes the capacity at least `count`. If it grows, all elements are undefined afterwards, and
  // the old memory is freed before the new one is allocated.
  void require(std::size_t count) {
    if (count <= capacity_) return;
    memory_.reset();
    capacity_ = 0;
    memory_ = detail::allocate_large(count * sizeof(T));
    capacity_ = count;
  }

  // In elements.
  [[nodiscard]] std::size_t capacity() const { return capacity_; }
  [[nodiscard]] T* data() { return reinterpret_cast<T*>(memory_.get()); }
  [[nodiscard]] const T* data() const { return reinterpret_cast<const T*>(memory_.get()); }
  [[nodiscard]] T& operator[](std::size_t i) { return data()[i]; }
  [[nodiscard]] const T& operator[](std::size_t i) const { return data()[i]; }

 private:
  detail::LargeMemory memory_;
  std::size_t capacity_ = 0;
};

}  // namespace rilievo
