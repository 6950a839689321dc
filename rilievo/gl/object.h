// Owners of OpenGL objects: thin, converted to the object's name.
#pragma once

#include <epoxy/gl.h>

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "rilievo/core/result.h"

namespace rilievo::gl {

// Owns one OpenGL object; `destroy` deletes it.
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

// The kinds of OpenGL objects:
using Buffer = Object<detail::destroy_buffer>;
using Texture = Object<detail::destroy_texture>;
using Framebuffer = Object<detail::destroy_framebuffer>;
using Renderbuffer = Object<detail::destroy_renderbuffer>;
using VertexArray = Object<detail::destroy_vertex_array>;
using Program = Object<detail::destroy_program>;

// Objects with immutable storage. `format` is a sized internal format; `data` may be null.
[[nodiscard]] Buffer make_buffer(std::size_t bytes, const void* data, GLbitfield flags = 0);
[[nodiscard]] Texture make_texture_2d(GLenum format, int width, int height, int levels = 1);
// A texture view: the texels of `of` with sampling parameters of its own. Either may be deleted
// first.
[[nodiscard]] Texture make_texture_view(const Texture& of, GLenum format, int levels);
[[nodiscard]] Texture make_texture_2d_array(GLenum format, int width, int height, int layers);
[[nodiscard]] Texture make_texture_2d_multisample(GLenum format, int width, int height,
                                                  int samples);
[[nodiscard]] Framebuffer make_framebuffer();
[[nodiscard]] VertexArray make_vertex_array();

// Compiles and links a program. Both sources start with "#version 450"; `defines` ("#define A
// 1\n...") follow that line. The error holds the compiler's log; `name` names the program in it.
[[nodiscard]] Result<Program> make_program(std::string_view name, std::string_view vertex,
                                           std::string_view fragment,
                                           std::string_view defines = "");
// The same of a compute shader.
[[nodiscard]] Result<Program> make_compute_program(std::string_view name, std::string_view source,
                                                   std::string_view defines = "");
// How many programs this process has made: a frame that makes one stutters.
[[nodiscard]] std::size_t programs_made();

// A buffer that is rewritten before each draw and grows when needed.
//
// Each upload goes behind the one before. Before a place is used again, every megabyte or so, it
// waits for the GPU. OpenGL promises correct results without this wait; Mesa's software drivers,
// which shade fragments late, read data that was written since.
class StreamBuffer {
 public:
  // Copies `bytes` into the buffer and binds the copy at `index` of `target`
  // (GL_SHADER_STORAGE_BUFFER or GL_UNIFORM_BUFFER). Allocates only to grow.
  void upload_and_bind(GLenum target, GLuint index, std::span<const std::byte> bytes);

 private:
  Buffer buffer_;
  std::size_t capacity_ = 0, used_ = 0;
};

}  // namespace rilievo::gl
