// OpenGL for a program without a window: a 4.5 core context by EGL, without X or a GPU.
//
// One context per thread. Destroy all objects of rilievo/gl before their context. Programs that
// have their own context do not need this one: all drawing uses the context that is current.
#pragma once

#include <memory>
#include <string>

#include "rilievo/core/result.h"

namespace rilievo::gl {

// Owns an EGL context.
class Context {
 public:
  // Creates a context and makes it current on this thread. Fails where EGL or OpenGL 4.5 is
  // missing.
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

// Does the current context's driver render on the CPU?
[[nodiscard]] bool is_software();

// Waits until all drawing is complete. Frame times end with it, because timer queries do not work
// on software rasterisers.
void finish();

// The first OpenGL error since the last call, if there is one. For tests and debug builds.
[[nodiscard]] Result<> check_errors(const char* where);

}  // namespace rilievo::gl
