// Counts what each thread allocates. Replaces the operators of the whole program: one file of a
// test program includes it.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>

// ThreadSanitizer has operators of its own, which allow no others.
#if defined(__has_feature)
#if __has_feature(thread_sanitizer)
#define RILIEVO_OPERATORS_ARE_TAKEN 1
#endif
#endif

#ifndef RILIEVO_OPERATORS_ARE_TAKEN

namespace {

thread_local std::size_t allocations_here = 0;

void* counted_allocation(std::size_t size) {
  ++allocations_here;
  if (void* memory = std::malloc(size ? size : 1)) return memory;
  throw std::bad_alloc();
}

}  // namespace

// Counted for each thread; the rest as usual. Not inlined: GCC warns of pairs that it looks into.
[[gnu::noinline]] void* operator new(std::size_t size) { return counted_allocation(size); }
[[gnu::noinline]] void* operator new[](std::size_t size) { return counted_allocation(size); }
void* operator new(std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations_here;
  return std::malloc(size ? size : 1);
}
void* operator new[](std::size_t size, const std::nothrow_t&) noexcept {
  ++allocations_here;
  return std::malloc(size ? size : 1);
}
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete[](void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

#endif
