// How long does work take?
#pragma once

#include <functional>

namespace rilievo::bench {

// Milliseconds of one run.
[[nodiscard]] double ms_of(const std::function<void()>& work);
// The median of `runs` runs, in milliseconds, after `warm_ups` that compile shaders and touch
// memory. `prepare` comes before each one and is not timed; it may be empty.
[[nodiscard]] double median_ms(int runs, int warm_ups, const std::function<void()>& work,
                               const std::function<void()>& prepare = {});

}  // namespace rilievo::bench
