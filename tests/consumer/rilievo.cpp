// Uses rilievo::rilievo, and through it OpenGL, without a window.
#include <cstdio>

#include "rilievo/gl/context.h"

int main() {
  const auto context = rilievo::gl::Context::create();
  if (!context) {
    std::fprintf(stderr, "%s\n", context.error().message().c_str());
    return 1;
  }
  std::printf("Draws with %s\n", rilievo::gl::renderer_name().c_str());
  return 0;
}
