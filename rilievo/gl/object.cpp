#include "rilievo/gl/object.h"

#include <algorithm>
#include <atomic>
#include <initializer_list>

namespace rilievo::gl {
namespace {

std::atomic<std::size_t> made_programs{0};

void sample_linearly_without_wrapping(GLuint texture, bool mipmapped) {
  glTextureParameteri(texture, GL_TEXTURE_MIN_FILTER,
                      mipmapped ? GL_LINEAR_MIPMAP_LINEAR : GL_LINEAR);
  glTextureParameteri(texture, GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTextureParameteri(texture, GL_TEXTURE_WRAP_S, GL_CLAMP_TO_EDGE);
  glTextureParameteri(texture, GL_TEXTURE_WRAP_T, GL_CLAMP_TO_EDGE);
}

Result<GLuint> compile(std::string_view name, GLenum kind, std::string_view source,
                       std::string_view defines) {
  const std::size_t first_line = source.find('\n') + 1;
  const std::string_view version = source.substr(0, first_line), rest = source.substr(first_line);
  const char* pieces[] = {version.data(), defines.data(), rest.data()};
  const GLint lengths[] = {GLint(version.size()), GLint(defines.size()), GLint(rest.size())};
  const GLuint shader = glCreateShader(kind);
  glShaderSource(shader, 3, pieces, lengths);
  glCompileShader(shader);
  GLint ok = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &ok);
  if (ok) return shader;
  std::string log(4096, '\0');
  GLsizei length = 0;
  glGetShaderInfoLog(shader, GLsizei(log.size()), &length, log.data());
  log.resize(std::size_t(length));
  glDeleteShader(shader);
  return Error{std::string(name), "shader does not compile: " + log};
}

// Deletes the shaders.
Result<Program> link(std::string_view name, std::initializer_list<GLuint> shaders) {
  ++made_programs;
  Program program(glCreateProgram());
  for (const GLuint shader : shaders) glAttachShader(program, shader);
  glLinkProgram(program);
  for (const GLuint shader : shaders) glDeleteShader(shader);
  GLint ok = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &ok);
  if (ok) return program;
  std::string log(4096, '\0');
  GLsizei length = 0;
  glGetProgramInfoLog(program, GLsizei(log.size()), &length, log.data());
  log.resize(std::size_t(length));
  return Error{std::string(name), "program does not link: " + log};
}

}  // namespace

Buffer make_buffer(std::size_t bytes, const void* data, GLbitfield flags) {
  GLuint name = 0;
  glCreateBuffers(1, &name);
  // OpenGL refuses empty storage.
  glNamedBufferStorage(name, GLsizeiptr(bytes ? bytes : 1), bytes ? data : nullptr, flags);
  return Buffer(name);
}

Texture make_texture_2d(GLenum format, int width, int height, int levels) {
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_2D, 1, &name);
  glTextureStorage2D(name, levels, format, width, height);
  sample_linearly_without_wrapping(name, levels > 1);
  return Texture(name);
}

Texture make_texture_view(const Texture& of, GLenum format, int levels) {
  GLuint name = 0;
  glGenTextures(1, &name);  // a view must not have a target yet
  glTextureView(name, GL_TEXTURE_2D, of, format, 0, GLuint(levels), 0, 1);
  sample_linearly_without_wrapping(name, levels > 1);
  return Texture(name);
}

Texture make_texture_2d_array(GLenum format, int width, int height, int layers) {
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_2D_ARRAY, 1, &name);
  glTextureStorage3D(name, 1, format, width, height, layers);
  sample_linearly_without_wrapping(name, false);
  return Texture(name);
}

Texture make_texture_2d_multisample(GLenum format, int width, int height, int samples) {
  GLuint name = 0;
  glCreateTextures(GL_TEXTURE_2D_MULTISAMPLE, 1, &name);
  glTextureStorage2DMultisample(name, samples, format, width, height, GL_TRUE);
  return Texture(name);
}

Framebuffer make_framebuffer() {
  GLuint name = 0;
  glCreateFramebuffers(1, &name);
  return Framebuffer(name);
}

VertexArray make_vertex_array() {
  GLuint name = 0;
  glCreateVertexArrays(1, &name);
  return VertexArray(name);
}

Result<Program> make_program(std::string_view name, std::string_view vertex,
                             std::string_view fragment, std::string_view defines) {
  const Result<GLuint> v = compile(name, GL_VERTEX_SHADER, vertex, defines);
  if (!v) return v.error();
  const Result<GLuint> f = compile(name, GL_FRAGMENT_SHADER, fragment, defines);
  if (!f) {
    glDeleteShader(*v);
    return f.error();
  }
  return link(name, {*v, *f});
}

Result<Program> make_compute_program(std::string_view name, std::string_view source,
                                     std::string_view defines) {
  const Result<GLuint> shader = compile(name, GL_COMPUTE_SHADER, source, defines);
  if (!shader) return shader.error();
  return link(name, {*shader});
}

std::size_t programs_made() { return made_programs; }

void StreamBuffer::upload_and_bind(GLenum target, GLuint index, std::span<const std::byte> bytes) {
  // Enough for any driver's alignment of offsets.
  constexpr std::size_t kAlignment = 256, kMinCapacity = std::size_t(1) << 20;
  const std::size_t size = (bytes.size() / kAlignment + 1) * kAlignment;
  if (size > capacity_) {
    capacity_ = std::max(kMinCapacity, 4 * size);
    glFinish();
    buffer_ = make_buffer(capacity_, nullptr, GL_DYNAMIC_STORAGE_BIT);
    used_ = 0;
  } else if (used_ + size > capacity_) {
    glFinish();
    used_ = 0;
  }
  if (!bytes.empty())
    glNamedBufferSubData(buffer_, GLintptr(used_), GLsizeiptr(bytes.size()), bytes.data());
  glBindBufferRange(target, index, buffer_, GLintptr(used_), GLsizeiptr(size));
  used_ += size;
}

}  // namespace rilievo::gl
