#include "rilievo/keyframes/gl/keyframe_warper.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <optional>
#include <string>
#include <utility>

#include "rilievo/core/parallel_for.h"
#include "rilievo/keyframes/gl/unfiltered_texture.h"
#include "rilievo/keyframes/gl/warp_shaders.h"

namespace rilievo {
namespace {

// As the shaders have it.
struct SourceWords {
  RasterMap to, from;
  float weight, pixels_per_texel, largest_square;
  std::int32_t width, height, finer, spare, unused;
};
static_assert(sizeof(SourceWords) == (6 * 4 + 8) * sizeof(std::uint32_t));
static_assert(sizeof(FilledHole) == 4 * sizeof(std::uint32_t));

}  // namespace

Result<KeyframeWarper> KeyframeWarper::create() {
  KeyframeWarper warper;
  const auto keep = [](Result<gl::Program> made, gl::Program& program) -> Result<> {
    if (!made) return made.error();
    program = std::move(*made);
    return Done{};
  };
  for (Result<> made : {keep(shader::make_splat_program(), warper.splat_),
                        keep(shader::make_lookup_program(), warper.lookup_),
                        keep(shader::make_fill_program(), warper.fill_),
                        keep(shader::make_show_program(false), warper.show_),
                        keep(shader::make_show_program(true), warper.show_objects_)})
    if (!made) return made.error();
  warper.no_vertices_ = gl::make_vertex_array();
  return warper;
}

Result<> KeyframeWarper::resize(int width, int height) {
  if (width == width_ && height == height_) return Done{};
  width_ = height_ = 0;
  color_ = make_unfiltered(GL_R32UI, width, height);
  inverse_z_ = make_unfiltered(GL_R32F, width, height);
  objects_ = gl::Texture(), object_depths_ = gl::Texture();
  depths_ = gl::make_buffer(std::size_t(width) * std::size_t(height + 2) * sizeof(float), nullptr);
  framebuffer_ = gl::make_framebuffer();
  glNamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT0, color_, 0);
  glNamedFramebufferTexture(framebuffer_, GL_COLOR_ATTACHMENT1, inverse_z_, 0);
  const GLenum both[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
  glNamedFramebufferDrawBuffers(framebuffer_, 2, both);
  if (glCheckNamedFramebufferStatus(framebuffer_, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
    return Error{"warped frame", "OpenGL makes none of " + std::to_string(width) + " x " +
                                     std::to_string(height) + " pixels"};
  width_ = width, height_ = height;
  return Done{};
}

// The sources, and where the sky is plain.
void KeyframeWarper::upload_sources(const Camera& frame, bool leaves_sky) {
  std::array<SourceWords, shader::kMostWarped> words{};
  for (std::size_t i = 0; i < sources_.size(); ++i) {
    const WarpSource& source = sources_[i];
    words[i] = {source.to_frame,
                source.from_frame,
                source.weight,
                source.pixels_per_texel,
                largest_square(source),
                source.keyframe->camera.width,
                source.keyframe->camera.height,
                source.keyframe->quarters() ? 1 : 0,
                source.spare ? 1 : 0,
                0};
  }
  const std::size_t across = std::size_t(plain_sky_cells(frame.width)),
                    strips = std::size_t(WarpedFrame::strips(frame.height));
  plain_sky_.assign(across * strips, 0);
  if (leaves_sky)
    for (std::size_t i = 0; i < strips; ++i) {
      const int first = int(i) * WarpedFrame::kStrip;
      find_plain_sky(sources_, first, std::min(WarpedFrame::kStrip, frame.height - first),
                     frame.width, &plain_sky_[i * across]);
    }
  words_.assign(plain_sky_.begin(), plain_sky_.end());
  uniforms_.upload_and_bind(GL_UNIFORM_BUFFER, shader::kSourceBlock,
                            std::as_bytes(std::span(words)));
  stream_.upload_and_bind(GL_SHADER_STORAGE_BUFFER, shader::kPixelBlock,
                          std::as_bytes(std::span(words_)));
}

Result<> KeyframeWarper::warp(std::span<const WarpedKeyframe> keyframes, const Camera& frame,
                              const WarpCoverTexture* cover, bool leaves_sky, WarpedFrame& out) {
  if (Result<> done = resize(frame.width, frame.height); !done) return done;
  find_warp_sources(keyframes, frame, sources_);
  if (sources_.size() > std::size_t(shader::kMostWarped)) sources_.resize(shader::kMostWarped);
  if (Result<> done = stored_.store(sources_); !done) return done;
  upload_sources(frame, leaves_sky);
  glClearNamedBufferData(depths_, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, nullptr);
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, shader::kDepthBlock, depths_);
  // Units of no keyframe have one, too: what is declared must be there.
  for (std::size_t k = 0; k < std::size_t(shader::kMostWarped); ++k) {
    const KeyframeTextures& of = stored_.textures()[std::min(k, sources_.size() - 1)];
    glBindTextureUnit(GLuint(shader::kColorUnit + k), of.color);
    glBindTextureUnit(GLuint(shader::kDepthUnit + k), of.inverse_z);
  }
  glBindTextureUnit(shader::kCoverUnit, cover ? cover->window_z : 0);

  const auto same = cover ? std::nullopt : find_same_pixels(sources_, frame);
  if (!same) {
    glUseProgram(splat_);
    glUniform2i(1, width_, height_);
    glUniform1f(2, float(1 / frame.z_near));
    for (std::size_t k = 0; k < sources_.size(); ++k) {
      const Camera& camera = sources_[k].keyframe->camera;
      glUniform1i(0, GLint(k));
      glDispatchCompute(GLuint((camera.width + shader::kSplatGroup - 1) / shader::kSplatGroup),
                        GLuint(camera.height), 1);
    }
    // The next frame clears it.
    glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT | GL_BUFFER_UPDATE_BARRIER_BIT);
  }

  begin_pass(lookup_);
  glUniform1i(0, GLint(sources_.size()));
  glUniform2i(1, width_, height_);
  glUniform3i(2, same ? GLint(same->source) : -1, same ? same->left : 0, same ? same->top : 0);
  glUniform1i(3, leaves_sky);
  glUniform1i(4, cover != nullptr);
  glUniform2f(5, float(frame.z_near), float(frame.z_far));
  glUniform1f(6, cover ? cover->nearest : 0);
  glUniform1i(7, cover ? cover->samples : 0);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  read_back(out);
  return Done{};
}

// Into the warped frame, whose pixels all of a pass's fragments replace.
void KeyframeWarper::begin_pass(const gl::Program& program) const {
  glBindFramebuffer(GL_DRAW_FRAMEBUFFER, framebuffer_);
  glViewport(0, 0, width_, height_);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  glUseProgram(program);
  glBindVertexArray(no_vertices_);
}

void KeyframeWarper::read_back(WarpedFrame& out) const {
  out.resize(width_, height_);
  glPixelStorei(GL_PACK_ALIGNMENT, 4);
  glGetTextureImage(color_, 0, GL_RED_INTEGER, GL_UNSIGNED_INT,
                    GLsizei(out.color.texels().size_bytes()), out.color.texels().data());
  glGetTextureImage(inverse_z_, 0, GL_RED, GL_FLOAT, GLsizei(out.inverse_z.texels().size_bytes()),
                    out.inverse_z.texels().data());
  parallel_for(0, WarpedFrame::strips(height_), [&](int i) {
    std::uint32_t holes = 0;
    const int first = i * WarpedFrame::kStrip;
    for (int y = first; y < std::min(first + WarpedFrame::kStrip, height_); ++y)
      for (const std::uint32_t color : out.color.row(y)) holes += color == 0;
    out.holes_in_strip(i, 0) = holes;
  });
}

void KeyframeWarper::fill(std::span<const FilledHole> holes) {
  if (holes.empty()) return;
  stream_.upload_and_bind(GL_SHADER_STORAGE_BUFFER, shader::kPixelBlock, std::as_bytes(holes));
  begin_pass(fill_);
  glUniform2i(0, width_, height_);
  glDrawArrays(GL_TRIANGLES, 0, GLsizei(3 * holes.size()));
}

void KeyframeWarper::draw_over(const Camera& frame, const gl::Program& program, GLuint contents,
                               GLuint depths, bool sky) {
  glUseProgram(program);
  glUniform2f(0, float(frame.z_near), float(frame.z_far));
  glUniform1i(1, sky);
  glBindTextureUnit(0, contents);
  glBindTextureUnit(1, depths);
  glBindVertexArray(no_vertices_);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  glDepthFunc(GL_LEQUAL);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void KeyframeWarper::show(const Camera& frame) {
  draw_over(frame, show_, color_, inverse_z_, false);
}

void KeyframeWarper::show_sky(const Camera& frame) {
  draw_over(frame, show_, color_, inverse_z_, true);
}

void KeyframeWarper::show_objects(const Camera& frame, const Image<std::uint32_t>& objects,
                                  const Image<float>& inverse_z) {
  if (!objects_) {
    objects_ = make_unfiltered(GL_R32UI, width_, height_);
    object_depths_ = make_unfiltered(GL_R32F, width_, height_);
  }
  glPixelStorei(GL_UNPACK_ALIGNMENT, 4);
  glTextureSubImage2D(objects_, 0, 0, 0, width_, height_, GL_RED_INTEGER, GL_UNSIGNED_INT,
                      objects.texels().data());
  glTextureSubImage2D(object_depths_, 0, 0, 0, width_, height_, GL_RED, GL_FLOAT,
                      inverse_z.texels().data());
  draw_over(frame, show_objects_, objects_, object_depths_, false);
}

}  // namespace rilievo
