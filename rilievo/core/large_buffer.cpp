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

LargeMemory allocate_large(std::size_t bytes) {
  const bool large = bytes >= kLargePage;
  const std::size_t alignment = large ? kLargePage : kSmallAlignment;
  LargeMemory memory(static_cast<std::byte*>(::operator new(bytes, std::align_val_t(alignment))),
                     FreeLargeMemory{alignment});
#ifdef __linux__
  // A wish: where it is refused, pages are small, as what is left of the last page always is.
  if (large) madvise(memory.get(), bytes / kLargePage * kLargePage, MADV_HUGEPAGE);
#endif
  return memory;
}

}  // namespace rilievo::detail
