// How does drawing leave the caller's OpenGL state unchanged?
#pragma once

#include <epoxy/gl.h>

namespace rilievo::gl {

// Saves all OpenGL state that Rilievo's drawing changes, and restores it at the end of the scope.
// In between, it switches off state of the caller that would corrupt a picture.
class StateGuard {
 public:
  StateGuard();
  ~StateGuard();
  StateGuard(const StateGuard&) = delete;
  StateGuard& operator=(const StateGuard&) = delete;

  // Binds the caller's framebuffer, viewport and scissor test again: the frame is drawn there after
  // the captures.
  void bind_frame() const;

 private:
  static constexpr int kCaps = 14, kUnits = 8, kTargets = 4, kBlocks = 2, kBindings = 6,
                       kPixelModes = 16;
  // An indexed binding of a buffer, or of a part of it.
  struct Binding {
    GLint buffer;
    GLint64 start, size;  // size 0: all of it
  };
  GLboolean caps_[kCaps], depth_mask_, color_mask_[4];
  GLint depth_func_, program_, vertex_array_, draw_framebuffer_, read_framebuffer_, viewport_[4],
      blend_[6], cull_face_, front_face_, active_texture_, textures_[kUnits][kTargets],
      samplers_[kUnits], scissor_[4], array_buffer_, pack_buffer_, unpack_buffer_,
      pixel_modes_[kPixelModes], block_buffers_[kBlocks], polygon_mode_[2], clip_origin_,
      clip_depth_mode_;
  Binding bindings_[kBlocks][kBindings];
  GLfloat clear_color_[4], clear_depth_, line_width_, polygon_offset_[2], depth_range_[2];
};

}  // namespace rilievo::gl
