// How many of a test's cases are tried with sanitizers?
//
// A case costs some ten times as much there, and what sanitizers look for, a wrong access, does not
// need thousands. Without them a test tries all of its cases, the same first ones among them.
#pragma once

#include <algorithm>

namespace rilievo {

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
inline constexpr bool kSanitized = true;
#elif defined(__has_feature)
#if __has_feature(address_sanitizer) || __has_feature(thread_sanitizer)
inline constexpr bool kSanitized = true;
#else
inline constexpr bool kSanitized = false;
#endif
#else
inline constexpr bool kSanitized = false;
#endif

// `cases` without sanitizers, a sixth of them, and at least two, with them.
constexpr int sanitized_cases(int cases) {
  return kSanitized ? std::min(cases, std::max(2, cases / 6)) : cases;
}

}  // namespace rilievo
