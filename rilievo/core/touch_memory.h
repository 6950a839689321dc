// Reserves memory and touches its pages, so that no later frame waits for the system to map them
// (core/large_buffer.h says what that takes).
#pragma once

#include <cstddef>
#include <vector>

namespace rilievo {

// Empties the vector and reserves `count` elements, in pages that are mapped.
template <class T>
void touch_memory(std::vector<T>& vector, std::size_t count) {
  vector.clear();
  vector.resize(count);
  vector.clear();
}

}  // namespace rilievo
