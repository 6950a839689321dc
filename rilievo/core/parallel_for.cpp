#include "rilievo/core/parallel_for.h"

#include <tbb/global_control.h>
#include <tbb/parallel_for.h>
#include <tbb/task_arena.h>

#include <algorithm>

#include "rilievo/core/happens.h"
#include "rilievo/core/on_this_thread.h"

namespace rilievo::detail {
namespace {

thread_local bool on_this_thread = false;
// Of frames, while an OnThisThread lives.
thread_local int threads_besides = 1;

// Tells at the end of a scope, exceptions included.
struct BeforeAtEnd {
  char& what;
  ~BeforeAtEnd() { happens_before(what); }
};
struct AfterAtEnd {
  char& what;
  ~AfterAtEnd() { happens_after(what); }
};

}  // namespace

void parallel_for(std::size_t count, void (*piece)(const void*, std::size_t), const void* body) {
  if (on_this_thread) {
    for (std::size_t i = 0; i < count; ++i) piece(body, i);
    return;
  }
  // Each piece starts after it was handed out, and parallel_for ends after all of them.
  char begun = 0, done = 0;
  happens_before(begun);
  const AfterAtEnd all{done};
  tbb::parallel_for(std::size_t(0), count, [&](std::size_t i) {
    happens_after(begun);
    const BeforeAtEnd one{done};
    piece(body, i);
  });
}

}  // namespace rilievo::detail

namespace rilievo {

OnThisThread::OnThisThread() : OnThisThread(threads_of_frames()) {}
OnThisThread::OnThisThread(int frame_threads)
    : before_(detail::on_this_thread), threads_before_(detail::threads_besides) {
  detail::on_this_thread = true, detail::threads_besides = frame_threads;
}
OnThisThread::~OnThisThread() {
  detail::on_this_thread = before_, detail::threads_besides = threads_before_;
}

bool beside_frames() { return detail::on_this_thread; }

int threads_of_calls() { return detail::on_this_thread ? 1 : threads_of_frames(); }

// Beside frames this thread may have an arena of its own, as an IdleThread has.
int threads_of_frames() {
  const std::size_t allowed =
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism);
  const int threads = detail::on_this_thread ? detail::threads_besides
                                             : std::max(1, tbb::this_task_arena::max_concurrency());
  return int(std::min(std::size_t(threads), allowed));
}

}  // namespace rilievo
