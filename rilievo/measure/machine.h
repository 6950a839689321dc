// The machine on which something was measured.
#pragma once

#include <string>

namespace rilievo {

// The processor and the OpenGL driver of a measurement.
struct Machine {
  std::string cpu;          // the processor's name, "unknown" if the system does not tell
  int threads = 1;          // that this process can run at the same time
  std::string gl_renderer;  // empty if OpenGL was not used
};

// This machine, without `gl_renderer`.
[[nodiscard]] Machine this_machine();

}  // namespace rilievo
