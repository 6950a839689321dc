#include "rilievo/core/started_programs.h"

#include <atomic>
#include <cerrno>
#include <csignal>

namespace rilievo {
namespace {

// 0: unused. A handler may read them at any time: they are never moved.
constexpr int kGroups = 64;
std::atomic<int> groups[kGroups];
static_assert(std::atomic<int>::is_always_lock_free);

}  // namespace

StartedProgram::StartedProgram(int group) noexcept {
  for (int i = 0; i < kGroups; ++i) {
    int expected = 0;
    if (!groups[i].compare_exchange_strong(expected, group)) continue;
    slot_ = i;
    return;
  }
}

StartedProgram::~StartedProgram() {
  if (slot_ >= 0) groups[slot_] = 0;
}

void kill_started_programs() noexcept {
  const int before = errno;
  for (const std::atomic<int>& group : groups)
    if (const int id = group; id > 0) ::kill(-id, SIGKILL);
  errno = before;
}

}  // namespace rilievo
