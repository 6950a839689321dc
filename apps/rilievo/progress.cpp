#include "apps/rilievo/progress.h"

#include <fmt/format.h>
#include <unistd.h>

#include <cstdio>
#include <utility>

namespace rilievo::app {

Progress::Progress(std::string what)
    : what_(std::move(what)), on_terminal_(isatty(STDERR_FILENO) == 1) {}

void Progress::show(int done, int total) {
  if (!on_terminal_) return;
  shown_ = true;
  fmt::print(stderr, "\r{} {}/{}\033[K", what_, done, total);
  std::fflush(stderr);
}

void Progress::clear() {
  if (shown_) fmt::print(stderr, "\r\033[K");
  shown_ = false;
}

Progress::~Progress() { clear(); }

}  // namespace rilievo::app
