#include "rilievo/core/large_buffer.h"

#include <new>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace rilievo::detail {
namespace {

constexpr std::size_t kLargePage = std::size_t(1) << 21, kSmallAlignment = 64;

}  // namespace

void FreeLargeMemory::operator()(std::byte* memory) const noexcept {
  ::operator delete(memory, std::align_val_t(alignment));
}

std::size_t large_bytes(std::size_t bytes) {
  return bytes < kLargePage ? bytes : (bytes + kLargePage - 1) / kLargePage * kLargePage;
}

LargeMemory allocate_large(std::size_t bytes) {
  const bool large = bytes >= kLargePage;
  bytes = large_bytes(bytes);
  const std::size_t alignment = large ? kLargePage : kSmallAlignment;
  LargeMemory memory(static_cast<std::byte*>(::operator new(bytes, std::align_val_t(alignment))),
                     FreeLargeMemory{alignment});
#ifdef __linux__
  // A wish: where it is refused, pages are small.
  if (large) madvise(memory.get(), bytes, MADV_HUGEPAGE);
#endif
  return memory;
}

}  // namespace rilievo::detail
