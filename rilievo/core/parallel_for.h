// How is work distributed over the cores?
//
// Calls run in any order, each once, and are complete when parallel_for returns. They can read what
// was written before, and later code can read what they wrote. An exception of a call leaves
// parallel_for. Nested calls are allowed.
//
// The library uses TBB's threads only through this function and background.h, so that
// ThreadSanitizer needs to be told only here.
#pragma once

#include <cstddef>

namespace rilievo {
namespace detail {

void parallel_for(std::size_t count, void (*piece)(const void*, std::size_t), const void* body);

}  // namespace detail

// Calls body(i) for each i in [first, last), on any thread.
template <typename Index, typename Body>
void parallel_for(Index first, Index last, const Body& body) {
  if (!(first < last)) return;
  struct Pieces {
    Index first;
    const Body& body;
  } const pieces{first, body};
  detail::parallel_for(
      std::size_t(last - first),
      [](const void* of, std::size_t i) {
        const Pieces& p = *static_cast<const Pieces*>(of);
        p.body(Index(p.first + Index(i)));
      },
      &pieces);
}

}  // namespace rilievo
