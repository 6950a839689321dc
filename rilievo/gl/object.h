// Thin owners of OpenGL names: they delete what they own and convert to it.
#pragma once

#include <epoxy/gl.h>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "rilievo/core/result.h"

namespace rilievo::gl {

template <void (*destroy)(GLuint)>
class Object {
 public:
  Object() = default;
  explicit Object(GLuint name) : name_(name) {}
  Object(Object&& other) noexcept : name_(std::exchange(other.name_, 0)) {}
  Object& operator=(Object&& other) noexcept {
    std::swap(name_, other.name_);
    return *this;
  }
  ~Object() {
    if (name_) destroy(name_);
  }
  operator GLuint() const noexcept { return name_; }

 private:
  GLuint name_ = 0;
};

namespace detail {
inline void destroy_buffer(GLuint n) { glDeleteBuffers(1, &n); }
inline void destroy_texture(GLuint n) { glDeleteTextures(1, &n); }
inline void destroy_framebuffer(GLuint n) { glDeleteFramebuffers(1, &n); }
inline void destroy_renderbuffer(GLuint n) { glDeleteRenderbuffers(1, &n); }
inline void destroy_vertex_array(GLuint n) { glDeleteVertexArrays(1, &n); }
inline void destroy_program(GLuint n) { glDeleteProgram(n); }
}  // namespace detail

using Buffer = Object<detail::destroy_buffer>;
using Texture = Object<detail::destroy_texture>;
using Framebuffer = Object<detail::destroy_framebuffer>;
using Renderbuffer = Object<detail::destroy_renderbuffer>;
using VertexArray = Object<detail::destroy_vertex_array>;
using Program = Object<detail::destroy_program>;

[[nodiscard]] Buffer make_buffer(std::size_t bytes, const void* data, GLbitfield flags = 0);
[[nodiscard]] Texture make_texture_2d(GLenum format, int width, int height, int levels = 1);
// The same texels under a name with parameters of its own; they live as long as either.
[[nodiscard]] Texture make_texture_view(const Texture& of, GLenum format, int levels);
[[nodiscard]] Texture make_texture_2d_array(GLenum format, int width, int height, int layers);
[[nodiscard]] Texture make_texture_2d_multisample(GLenum format, int width, int height,
                                                  int samples);
[[nodiscard]] Framebuffer make_framebuffer();
[[nodiscard]] VertexArray make_vertex_array();

// Both sources start with "#version 450"; `defines` ("#define A 1\n...") go after that line.
[[nodiscard]] Result<Program> make_program(std::string_view name, std::string_view vertex,
                                           std::string_view fragment,
                                           std::string_view defines = "");

// A buffer that is rewritten before every drawing and grows when it must.
//
// Each upload goes behind the one before; the GPU is waited for before a place is used again, every
// megabyte or so. OpenGL promises the same without, but Mesa's software drivers, which shade
// fragments late, read what has been written since.
class StreamBuffer {
 public:
  // Copies `bytes` into the buffer and binds it at `index` of `target` (GL_SHADER_STORAGE_BUFFER or
  // GL_UNIFORM_BUFFER). Allocates only when it has to grow.
  void upload_and_bind(GLenum target, GLuint index, std::span<const std::byte> bytes);

 private:
  Buffer buffer_;
  std::size_t capacity_ = 0, used_ = 0;
};

}  // namespace rilievo::gl
