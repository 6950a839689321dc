// How is a window opened? With an OpenGL 4.5 core context and a Dear ImGui panel.
#pragma once

#include <memory>
#include <string>

#include "rilievo/core/result.h"

struct GLFWwindow;

namespace rilievo::app {

class Window {
 public:
  // `visible` false: for scripts; it still needs a display.
  [[nodiscard]] static Result<std::unique_ptr<Window>> create(const std::string& title, int width,
                                                              int height, bool visible);
  ~Window();
  Window(const Window&) = delete;
  Window& operator=(const Window&) = delete;

  [[nodiscard]] GLFWwindow* handle() const { return window_; }
  // Handles events and begins a frame of the panel; false once the user has closed the window.
  [[nodiscard]] bool begin_frame();
  // Draws the panel over what is in the window's framebuffer.
  void draw_panel();
  void show();

 private:
  Window() = default;
  GLFWwindow* window_ = nullptr;
  bool panel_ = false;
};

}  // namespace rilievo::app
