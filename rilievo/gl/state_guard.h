// Leaves the caller's OpenGL state as it was found.
#pragma once

#include <epoxy/gl.h>

namespace rilievo::gl {

// Restores, at the end of the scope, every piece of OpenGL state that Rilievo's drawing changes.
// Until then, whatever the caller has set that would spoil a picture is switched off.
class StateGuard {
 public:
  StateGuard();
  ~StateGuard();
  StateGuard(const StateGuard&) = delete;
  StateGuard& operator=(const StateGuard&) = delete;

  // Framebuffer, viewport and scissor test as the caller had set them: where a frame is drawn,
  // after its captures.
  void bind_frame() const;

 private:
  static constexpr int kCaps = 12, kUnits = 8, kBindings = 6, kPixelModes = 16;
  GLboolean caps_[kCaps], depth_mask_, color_mask_[4];
  GLint depth_func_, program_, vertex_array_, draw_framebuffer_, read_framebuffer_, viewport_[4],
      blend_[6], cull_face_, front_face_, active_texture_, textures_[kUnits][2], samplers_[kUnits],
      storage_[kBindings], uniform_[kBindings], scissor_[4], array_buffer_, pack_buffer_,
      unpack_buffer_, pixel_modes_[kPixelModes], storage_buffer_, uniform_buffer_, polygon_mode_[2];
  GLfloat clear_color_[4], clear_depth_, line_width_, polygon_offset_[2];
};

}  // namespace rilievo::gl
