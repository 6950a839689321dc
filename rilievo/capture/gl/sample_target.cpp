#include "rilievo/capture/gl/sample_target.h"

#include "rilievo/core/depth_image.h"

namespace rilievo {
namespace {

const char* const kVertex = R"(#version 450
void main() { gl_Position = vec4(gl_VertexID == 1 ? 3.0 : -1.0, gl_VertexID == 2 ? 3.0 : -1.0, 0.0, 1.0); }
)";

const char* const kFragment = R"(#version 450
layout(binding = 0) uniform sampler2DMS colors;
layout(binding = 1) uniform usampler2DMS objects;
layout(binding = 2) uniform sampler2DMS depths;
layout(location = 0) uniform int k;
layout(location = 0) out vec4 out_color;
layout(location = 1) out uint out_object;
layout(location = 2) out float out_depth;
void main() {
  ivec2 texel = ivec2(gl_FragCoord.xy);
  out_color = texelFetch(colors, texel, k);
  out_object = texelFetch(objects, texel, k).r;
  out_depth = texelFetch(depths, texel, k).r;
}
)";

}  // namespace

Result<gl::Program> SampleTarget::make_extract_program(std::string_view name) {
  return gl::make_program(name, kVertex, kFragment);
}

Result<SampleTarget> SampleTarget::create(int width, int height, int samples, GLuint extract) {
  SampleTarget t;
  t.extract_ = extract;
  t.width_ = width, t.height_ = height;
  t.color_ = gl::make_texture_2d_multisample(GL_RGBA16F, width, height, samples);
  t.object_ = gl::make_texture_2d_multisample(GL_R32UI, width, height, samples);
  t.depth_ = gl::make_texture_2d_multisample(GL_DEPTH_COMPONENT32F, width, height, samples);
  t.one_color_ = gl::make_texture_2d(GL_RGBA16F, width, height);
  t.one_object_ = gl::make_texture_2d(GL_R32UI, width, height);
  t.one_depth_ = gl::make_texture_2d(GL_R32F, width, height);
  t.color_target_ = gl::make_framebuffer();
  glNamedFramebufferTexture(t.color_target_, GL_COLOR_ATTACHMENT0, t.color_, 0);
  glNamedFramebufferTexture(t.color_target_, GL_DEPTH_ATTACHMENT, t.depth_, 0);
  t.object_target_ = gl::make_framebuffer();
  glNamedFramebufferTexture(t.object_target_, GL_COLOR_ATTACHMENT0, t.object_, 0);
  glNamedFramebufferTexture(t.object_target_, GL_DEPTH_ATTACHMENT, t.depth_, 0);
  t.one_ = gl::make_framebuffer();
  const GLenum buffers[] = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1, GL_COLOR_ATTACHMENT2};
  glNamedFramebufferTexture(t.one_, buffers[0], t.one_color_, 0);
  glNamedFramebufferTexture(t.one_, buffers[1], t.one_object_, 0);
  glNamedFramebufferTexture(t.one_, buffers[2], t.one_depth_, 0);
  glNamedFramebufferDrawBuffers(t.one_, 3, buffers);
  for (const GLuint framebuffer :
       {GLuint(t.color_target_), GLuint(t.object_target_), GLuint(t.one_)})
    if (glCheckNamedFramebufferStatus(framebuffer, GL_DRAW_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE)
      return Error{"capture", "the driver refuses a float framebuffer of this size"};
  t.no_vertices_ = gl::make_vertex_array();
  return t;
}

void SampleTarget::begin(const gl::Framebuffer& framebuffer, bool keeps_farthest) {
  glBindFramebuffer(GL_FRAMEBUFFER, framebuffer);
  glViewport(0, 0, width_, height_);
  glDisable(GL_SCISSOR_TEST);
  glDepthMask(GL_TRUE);
  glColorMask(GL_TRUE, GL_TRUE, GL_TRUE, GL_TRUE);
  const GLfloat beaten = keeps_farthest ? 0 : 1;
  glClearNamedFramebufferfv(framebuffer, GL_DEPTH, 0, &beaten);
}

void SampleTarget::begin_color(bool keeps_farthest) {
  begin(color_target_, keeps_farthest);
  const GLfloat transparent[] = {0, 0, 0, 0};
  glClearNamedFramebufferfv(color_target_, GL_COLOR, 0, transparent);
}

void SampleTarget::begin_objects(bool keeps_farthest) {
  begin(object_target_, keeps_farthest);
  const GLuint nothing[] = {kNoObject, 0, 0, 0};
  glClearNamedFramebufferuiv(object_target_, GL_COLOR, 0, nothing);
}

std::vector<glm::vec2> SampleTarget::places() const {
  glBindFramebuffer(GL_FRAMEBUFFER, color_target_);
  GLint samples = 0;
  glGetIntegerv(GL_SAMPLES, &samples);
  std::vector<glm::vec2> places;
  for (GLint s = 0; s < samples; ++s) {
    GLfloat at[2] = {0.5f, 0.5f};
    glGetMultisamplefv(GL_SAMPLE_POSITION, GLuint(s), at);
    places.emplace_back(at[0] - 0.5f, at[1] - 0.5f);
  }
  return places;
}

void SampleTarget::read(int sample, Samples& samples) {
  glBindFramebuffer(GL_FRAMEBUFFER, one_);
  glViewport(0, 0, width_, height_);
  glDisable(GL_SCISSOR_TEST);
  glDisable(GL_DEPTH_TEST);
  glDisable(GL_CULL_FACE);
  glDisable(GL_BLEND);
  glUseProgram(extract_);
  glBindTextureUnit(0, color_);
  glBindTextureUnit(1, object_);
  glBindTextureUnit(2, depth_);
  glUniform1i(0, sample);
  glBindVertexArray(no_vertices_);
  glDrawArrays(GL_TRIANGLES, 0, 3);
  samples.color = Image<glm::vec4>(width_, height_);
  samples.window_z = Image<float>(width_, height_);
  samples.object = Image<std::uint32_t>(width_, height_);
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  const auto read_plane = [&](GLenum attachment, GLenum format, GLenum type, void* texels) {
    glNamedFramebufferReadBuffer(one_, attachment);
    glReadPixels(0, 0, width_, height_, format, type, texels);
  };
  read_plane(GL_COLOR_ATTACHMENT0, GL_RGBA, GL_FLOAT, samples.color.texels().data());
  read_plane(GL_COLOR_ATTACHMENT1, GL_RED_INTEGER, GL_UNSIGNED_INT, samples.object.texels().data());
  read_plane(GL_COLOR_ATTACHMENT2, GL_RED, GL_FLOAT, samples.window_z.texels().data());
}

}  // namespace rilievo
