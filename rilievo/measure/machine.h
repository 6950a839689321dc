// On what was this measured?
#pragma once

#include <string>

namespace rilievo {

struct Machine {
  std::string cpu;          // the processor's own name for itself, "unknown" if it says none
  int threads = 1;          // that this process may run at once
  std::string gl_renderer;  // empty if nothing was drawn with OpenGL
};

// This machine, without `gl_renderer`.
[[nodiscard]] Machine this_machine();

}  // namespace rilievo
