#include "apps/rilievo/signals.h"

#include <csignal>

#include "rilievo/core/started_programs.h"
#include "rilievo/core/unfinished_files.h"

namespace rilievo::app {
namespace {

constexpr int kEndingSignals[] = {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGXCPU};

// Calls only what is safe in a signal handler.
void end_by(int signal) {
  kill_started_programs();
  remove_unfinished_files();
  std::signal(signal, SIG_DFL);
  // Blocked while it is handled, it comes when this returns.
  std::raise(signal);
}

}  // namespace

void clean_up_on_signals() {
  struct sigaction action {};
  action.sa_handler = end_by;
  sigemptyset(&action.sa_mask);
  for (const int signal : kEndingSignals) sigaddset(&action.sa_mask, signal);
  for (const int signal : kEndingSignals) {
    struct sigaction before {};
    if (sigaction(signal, nullptr, &before) == 0 && before.sa_handler != SIG_IGN)
      sigaction(signal, &action, nullptr);
  }
  std::signal(SIGXFSZ, SIG_IGN);
}

}  // namespace rilievo::app
