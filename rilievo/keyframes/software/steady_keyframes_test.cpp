// Does a steady frame of keyframes allocate memory?
#include <gtest/gtest.h>

#include <cstdlib>
#include <new>

#include "rilievo/keyframes/software/keyframe_frames.h"
#include "rilievo/scene/builtin/builtin.h"

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
[[gnu::noinline]] void operator delete(void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete[](void* memory) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete(void* memory, std::size_t) noexcept { std::free(memory); }
[[gnu::noinline]] void operator delete[](void* memory, std::size_t) noexcept { std::free(memory); }

namespace rilievo {
namespace {

// The eye stands: keyframes are complete, and frames are warped, filled and drawn. Captures of
// keyframes make pictures, and are not meant.
TEST(KeyframeFrames, frames_of_an_eye_that_stands_allocate_nothing) {
  const BuiltinScene made = *make_builtin("builtin:stonehenge?triangles=20000");
  KeyframeFramesOptions options;
  options.keyframes.interval = 4;
  auto frames = KeyframeFrames::create(made.scene, options);
  ASSERT_TRUE(frames.ok());
  const Camera camera = camera_at(made.path, 0, 160, 100);
  const void* volatile probe = new int;
  EXPECT_GT(allocations_here, 0u);  // they are counted
  delete static_cast<const int*>(probe);
  for (int i = 0; i < 30; ++i) ASSERT_TRUE((*frames)->draw(camera, 0).ok());
  const std::size_t before = allocations_here;
  for (int i = 0; i < 20; ++i) {
    const bool drawn = (*frames)->draw(camera, 0).ok();
    if (!drawn) FAIL();
  }
  EXPECT_EQ(allocations_here - before, 0u);
}

}  // namespace
}  // namespace rilievo

#endif
