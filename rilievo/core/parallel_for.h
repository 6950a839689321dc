// How is work shared out among the cores?
//
// Pieces run in any order, each once, and all have run when parallel_for returns; what was written
// before it may be read by them, what they wrote by what comes after it. An exception of a piece
// comes out of parallel_for. Nested calls are fine.
//
// The library's only way to use threads, so that ThreadSanitizer can be told of it in one place.
#pragma once

#include <cstddef>

namespace rilievo {
namespace detail {

void parallel_for(std::size_t count, void (*piece)(const void*, std::size_t), const void* body);

}  // namespace detail

// body(i) for each i of [first, last), whatever the thread.
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
