// What does a signal leave behind that ends the program? No half-written files, and no programs
// that were started.
#pragma once

namespace rilievo::app {

// From now on the signals that end the program (SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGPIPE, SIGXCPU)
// first kill what was started and remove the files that are being written; then each ends it as it
// always does, so that a shell sees which it was. Those that the caller ignores (nohup) stay
// ignored. A file that grows past its limit (SIGXFSZ) is an error of writing instead.
void clean_up_on_signals();

}  // namespace rilievo::app
