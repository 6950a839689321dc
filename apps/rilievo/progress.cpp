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
  std::fputs(fmt::format("\r{} {}/{}\033[K", what_, done, total).c_str(), stderr);
  std::fflush(stderr);
}

void Progress::clear() {
  if (shown_) std::fputs("\r\033[K", stderr);
  shown_ = false;
}

Progress::~Progress() { clear(); }

}  // namespace rilievo::app
