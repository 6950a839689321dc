// What does ThreadSanitizer have to be told of the order of threads? Internal to rilievo/core.
//
// It does not see how TBB, a library that is not instrumented, orders its tasks. Under
// ThreadSanitizer the files that use this are not instrumented either (CMakeLists.txt), and tell
// just that order, and nothing about two tasks of a parallel_for, whose races are to be found.
#pragma once

#ifdef RILIEVO_THREAD_SANITIZER
#include <sanitizer/tsan_interface.h>
#endif

namespace rilievo::detail {

// What this thread did before happens before whatever a thread does after happens_after(what).
inline void happens_before([[maybe_unused]] char& what) {
#ifdef RILIEVO_THREAD_SANITIZER
  __tsan_release(&what);
#endif
}

inline void happens_after([[maybe_unused]] char& what) {
#ifdef RILIEVO_THREAD_SANITIZER
  __tsan_acquire(&what);
#endif
}

}  // namespace rilievo::detail
