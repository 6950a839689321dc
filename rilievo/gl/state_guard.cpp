#include "rilievo/gl/state_guard.h"

#include <iterator>

namespace rilievo::gl {
namespace {

constexpr int kScissorTest = 0;
constexpr GLenum kCapabilities[] = {GL_SCISSOR_TEST,
                                    GL_DEPTH_TEST,
                                    GL_BLEND,
                                    GL_CULL_FACE,
                                    GL_SAMPLE_ALPHA_TO_COVERAGE,
                                    GL_SAMPLE_ALPHA_TO_ONE,
                                    GL_FRAMEBUFFER_SRGB,
                                    GL_POLYGON_OFFSET_FILL,
                                    GL_DEPTH_CLAMP,
                                    GL_TEXTURE_CUBE_MAP_SEAMLESS,
                                    GL_CLIP_DISTANCE0,
                                    GL_CLIP_DISTANCE1,
                                    GL_CLIP_DISTANCE2,
                                    GL_CLIP_DISTANCE3};
constexpr GLenum kTextureTargets[][2] = {
    {GL_TEXTURE_2D, GL_TEXTURE_BINDING_2D},
    {GL_TEXTURE_2D_ARRAY, GL_TEXTURE_BINDING_2D_ARRAY},
    {GL_TEXTURE_CUBE_MAP, GL_TEXTURE_BINDING_CUBE_MAP},
    {GL_TEXTURE_2D_MULTISAMPLE, GL_TEXTURE_BINDING_2D_MULTISAMPLE}};
// Buffers of blocks, bound in whole or in part at indices: target, binding, start, size.
constexpr GLenum kBlockTargets[][4] = {
    {GL_SHADER_STORAGE_BUFFER, GL_SHADER_STORAGE_BUFFER_BINDING, GL_SHADER_STORAGE_BUFFER_START,
     GL_SHADER_STORAGE_BUFFER_SIZE},
    {GL_UNIFORM_BUFFER, GL_UNIFORM_BUFFER_BINDING, GL_UNIFORM_BUFFER_START,
     GL_UNIFORM_BUFFER_SIZE}};
// How pictures lie in memory when they are sent and read.
constexpr GLenum kPixelStore[] = {
    GL_UNPACK_ALIGNMENT, GL_UNPACK_SWAP_BYTES,  GL_UNPACK_LSB_FIRST,    GL_UNPACK_ROW_LENGTH,
    GL_UNPACK_SKIP_ROWS, GL_UNPACK_SKIP_PIXELS, GL_UNPACK_IMAGE_HEIGHT, GL_UNPACK_SKIP_IMAGES,
    GL_PACK_ALIGNMENT,   GL_PACK_SWAP_BYTES,    GL_PACK_LSB_FIRST,      GL_PACK_ROW_LENGTH,
    GL_PACK_SKIP_ROWS,   GL_PACK_SKIP_PIXELS,   GL_PACK_IMAGE_HEIGHT,   GL_PACK_SKIP_IMAGES};
// The alignments are set where they are needed; 4 is OpenGL's.
constexpr GLint as_usual(GLenum mode) {
  return mode == GL_UNPACK_ALIGNMENT || mode == GL_PACK_ALIGNMENT ? 4 : 0;
}

}  // namespace

StateGuard::StateGuard() {
  static_assert(std::size(kCapabilities) == kCaps);
  for (int i = 0; i < kCaps; ++i) caps_[i] = glIsEnabled(kCapabilities[i]);
  glGetBooleanv(GL_DEPTH_WRITEMASK, &depth_mask_);
  glGetBooleanv(GL_COLOR_WRITEMASK, color_mask_);
  glGetIntegerv(GL_DEPTH_FUNC, &depth_func_);
  glGetIntegerv(GL_CURRENT_PROGRAM, &program_);
  glGetIntegerv(GL_VERTEX_ARRAY_BINDING, &vertex_array_);
  glGetIntegerv(GL_DRAW_FRAMEBUFFER_BINDING, &draw_framebuffer_);
  glGetIntegerv(GL_READ_FRAMEBUFFER_BINDING, &read_framebuffer_);
  glGetIntegerv(GL_VIEWPORT, viewport_);
  glGetIntegerv(GL_SCISSOR_BOX, scissor_);
  constexpr GLenum blend[] = {GL_BLEND_SRC_RGB,   GL_BLEND_DST_RGB,      GL_BLEND_SRC_ALPHA,
                              GL_BLEND_DST_ALPHA, GL_BLEND_EQUATION_RGB, GL_BLEND_EQUATION_ALPHA};
  for (int i = 0; i < 6; ++i) glGetIntegerv(blend[i], &blend_[i]);
  glGetIntegerv(GL_CULL_FACE_MODE, &cull_face_);
  glGetIntegerv(GL_FRONT_FACE, &front_face_);
  glGetIntegerv(GL_ARRAY_BUFFER_BINDING, &array_buffer_);
  glGetIntegerv(GL_PIXEL_PACK_BUFFER_BINDING, &pack_buffer_);
  glGetIntegerv(GL_PIXEL_UNPACK_BUFFER_BINDING, &unpack_buffer_);
  static_assert(std::size(kPixelStore) == kPixelModes);
  for (int i = 0; i < kPixelModes; ++i) glGetIntegerv(kPixelStore[i], &pixel_modes_[i]);
  glGetIntegerv(GL_POLYGON_MODE, polygon_mode_);
  glGetIntegerv(GL_CLIP_ORIGIN, &clip_origin_);
  glGetIntegerv(GL_CLIP_DEPTH_MODE, &clip_depth_mode_);
  glGetFloatv(GL_COLOR_CLEAR_VALUE, clear_color_);
  glGetFloatv(GL_DEPTH_CLEAR_VALUE, &clear_depth_);
  glGetFloatv(GL_DEPTH_RANGE, depth_range_);
  glGetFloatv(GL_LINE_WIDTH, &line_width_);
  glGetFloatv(GL_POLYGON_OFFSET_FACTOR, &polygon_offset_[0]);
  glGetFloatv(GL_POLYGON_OFFSET_UNITS, &polygon_offset_[1]);
  glGetIntegerv(GL_ACTIVE_TEXTURE, &active_texture_);
  for (int i = 0; i < kUnits; ++i) {
    glActiveTexture(GL_TEXTURE0 + GLenum(i));
    static_assert(std::size(kTextureTargets) == kTargets);
    for (int k = 0; k < kTargets; ++k) glGetIntegerv(kTextureTargets[k][1], &textures_[i][k]);
    glGetIntegerv(GL_SAMPLER_BINDING, &samplers_[i]);
  }
  glActiveTexture(GLenum(active_texture_));
  static_assert(std::size(kBlockTargets) == kBlocks);
  for (int k = 0; k < kBlocks; ++k) {
    const auto& [target, bound, start, size] = kBlockTargets[k];
    glGetIntegerv(bound, &block_buffers_[k]);
    for (GLuint i = 0; i < kBindings; ++i) {
      Binding& binding = bindings_[k][i];
      glGetIntegeri_v(bound, i, &binding.buffer);
      glGetInteger64i_v(start, i, &binding.start);
      glGetInteger64i_v(size, i, &binding.size);
    }
  }

  for (const GLenum capability : kCapabilities) glDisable(capability);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glPolygonMode(GL_FRONT_AND_BACK, GL_FILL);
  glDepthRangef(0, 1);
  glClipControl(GL_LOWER_LEFT, GL_NEGATIVE_ONE_TO_ONE);
  for (GLuint i = 0; i < kUnits; ++i) glBindSampler(i, 0);
  for (const GLenum mode : kPixelStore) glPixelStorei(mode, as_usual(mode));
  glBindBuffer(GL_PIXEL_PACK_BUFFER, 0);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
}

void StateGuard::bind_frame() const {
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, GLuint(draw_framebuffer_));
  glViewport(viewport_[0], viewport_[1], viewport_[2], viewport_[3]);
  glScissor(scissor_[0], scissor_[1], scissor_[2], scissor_[3]);
  if (caps_[kScissorTest]) glEnable(GL_SCISSOR_TEST);
}

StateGuard::~StateGuard() {
  for (int i = 0; i < kCaps; ++i)
    caps_[i] ? glEnable(kCapabilities[i]) : glDisable(kCapabilities[i]);
  glDepthMask(depth_mask_);
  glColorMask(color_mask_[0], color_mask_[1], color_mask_[2], color_mask_[3]);
  glDepthFunc(GLenum(depth_func_));
  glUseProgram(GLuint(program_));
  glBindVertexArray(GLuint(vertex_array_));
  bind_frame();
  glBindFramebuffer(GL_READ_FRAMEBUFFER, GLuint(read_framebuffer_));
  glBlendFuncSeparate(GLenum(blend_[0]), GLenum(blend_[1]), GLenum(blend_[2]), GLenum(blend_[3]));
  glBlendEquationSeparate(GLenum(blend_[4]), GLenum(blend_[5]));
  glCullFace(GLenum(cull_face_));
  glFrontFace(GLenum(front_face_));
  for (int i = 0; i < kPixelModes; ++i) glPixelStorei(kPixelStore[i], pixel_modes_[i]);
  glBindBuffer(GL_PIXEL_PACK_BUFFER, GLuint(pack_buffer_));
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, GLuint(unpack_buffer_));
  glPolygonMode(GL_FRONT_AND_BACK, GLenum(polygon_mode_[0]));
  glClearColor(clear_color_[0], clear_color_[1], clear_color_[2], clear_color_[3]);
  glClearDepthf(clear_depth_);
  glDepthRangef(depth_range_[0], depth_range_[1]);
  glClipControl(GLenum(clip_origin_), GLenum(clip_depth_mode_));
  glLineWidth(line_width_);
  glPolygonOffset(polygon_offset_[0], polygon_offset_[1]);
  for (int i = 0; i < kUnits; ++i) {
    glActiveTexture(GL_TEXTURE0 + GLenum(i));
    for (int k = 0; k < kTargets; ++k)
      glBindTexture(kTextureTargets[k][0], GLuint(textures_[i][k]));
    glBindSampler(GLuint(i), GLuint(samplers_[i]));
  }
  glActiveTexture(GLenum(active_texture_));
  for (int k = 0; k < kBlocks; ++k) {
    const GLenum target = kBlockTargets[k][0];
    for (GLuint i = 0; i < kBindings; ++i) {
      const auto& [buffer, start, size] = bindings_[k][i];
      if (size > 0)
        glBindBufferRange(target, i, GLuint(buffer), GLintptr(start), GLsizeiptr(size));
      else
        glBindBufferBase(target, i, GLuint(buffer));
    }
    // Indexed bindings also change the generic one, which is therefore restored after them.
    glBindBuffer(target, GLuint(block_buffers_[k]));
  }
  glBindBuffer(GL_ARRAY_BUFFER, GLuint(array_buffer_));
}

}  // namespace rilievo::gl
