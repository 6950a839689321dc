// Memory that is there before it is needed: no later frame waits for the system to map its pages
// (core/large_buffer.h says what that takes).
#pragma once

#include <cstddef>
#include <vector>

namespace rilievo {

// Empties the vector, and gives it room for so many elements, in pages that were touched.
template <class T>
void touch_memory(std::vector<T>& vector, std::size_t count) {
  vector.clear();
  vector.resize(count);
  vector.clear();
}

}  // namespace rilievo
