// An OpenGL 4.5 core context without a window, by EGL: works without X and without a GPU.
//
// One context a thread. Objects of rilievo/gl die before their context does. Users who bring their
// own context need none of this: everything else runs in whichever context is current.
#pragma once

#include <memory>
#include <string>

#include "rilievo/core/result.h"

namespace rilievo::gl {

class Context {
 public:
  // Makes a context and makes it current on this thread.
  [[nodiscard]] static Result<std::unique_ptr<Context>> create();
  ~Context();
  Context(const Context&) = delete;
  Context& operator=(const Context&) = delete;

 private:
  Context() = default;
  void* display_ = nullptr;
  void* context_ = nullptr;
};

// GL_RENDERER of the current context.
[[nodiscard]] std::string renderer_name();

// Is the current context's OpenGL the work of the processor?
[[nodiscard]] bool is_software();

// Waits until all drawing is done: what a frame's time ends with (timer queries do not work on
// software rasterisers).
void finish();

// The first OpenGL error since the last call, or nothing wrong. For tests and debug builds.
[[nodiscard]] Result<> check_errors(const char* where);

}  // namespace rilievo::gl
