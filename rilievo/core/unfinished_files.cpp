#include "rilievo/core/unfinished_files.h"

#include <unistd.h>

#include <atomic>
#include <cerrno>
#include <climits>
#include <cstring>

namespace rilievo {
namespace {

enum State { unused, filling, listed };

struct Slot {
  std::atomic<int> state{unused};
  char path[PATH_MAX];
};

// A handler may read it at any time: it is never moved, and states change without a lock.
constexpr int kSlots = 64;
Slot slots[kSlots];
static_assert(std::atomic<int>::is_always_lock_free);

}  // namespace

UnfinishedFile::UnfinishedFile(const std::string& path) noexcept {
  if (path.size() >= PATH_MAX) return;
  for (int i = 0; i < kSlots; ++i) {
    int expected = unused;
    if (!slots[i].state.compare_exchange_strong(expected, filling)) continue;
    std::memcpy(slots[i].path, path.c_str(), path.size() + 1);
    slots[i].state = listed;
    slot_ = i;
    return;
  }
}

UnfinishedFile::~UnfinishedFile() {
  if (slot_ >= 0) slots[slot_].state = unused;
}

void remove_unfinished_files() noexcept {
  const int before = errno;
  for (const Slot& slot : slots)
    if (slot.state == listed) ::unlink(slot.path);
  errno = before;
}

}  // namespace rilievo
