#include "rilievo/frame/gl/present_pass.h"

#include <string>
#include <utility>

#include "rilievo/core/depth_image.h"

namespace rilievo {
namespace {

// One triangle that covers the viewport.
const char* const kPresentVertex = R"(#version 450
layout(location = 0) out vec2 at;
void main() {
  vec2 corner = vec2(gl_VertexID == 1 ? 2.0 : 0.0, gl_VertexID == 2 ? 2.0 : 0.0);
  at = corner;
  gl_Position = vec4(2.0 * corner - 1.0, 0.0, 1.0);
}
)";

const char* const kPresentFragment = R"(#version 450
layout(location = 0) in vec2 at;
layout(location = 0) uniform int samples;
layout(location = 1) uniform bool top_first;
layout(location = 2) uniform vec2 depth_map;  // offset, scale
layout(location = 3) uniform bool linear;
layout(location = 4) uniform int depth_samples;
#if MULTISAMPLED
layout(binding = 1) uniform sampler2DMS depth_texture;
#else
layout(binding = 1) uniform sampler2D depth_texture;
#endif
#if IDENTIFIERS
layout(binding = 0) uniform usampler2D object_texture;
layout(location = 0) out uint out_object;
#else
layout(binding = 0) uniform sampler2D color_texture;
layout(location = 0) out vec4 out_color;
#endif

vec3 linear_from_srgb(vec3 c) {
  return mix(c / 12.92, pow((c + 0.055) / 1.055, vec3(2.4)), greaterThan(c, vec3(0.04045)));
}

void main() {
#if IDENTIFIERS
  ivec2 size = textureSize(object_texture, 0);
#else
  ivec2 size = textureSize(color_texture, 0);
#endif
  ivec2 texel = min(ivec2(at * vec2(size)), size - 1);
  if (top_first) texel.y = size.y - 1 - texel.y;
#if IDENTIFIERS
  out_object = texelFetch(object_texture, texel, 0).r;
  if (out_object == 0u) discard;
#else
  vec4 color = texelFetch(color_texture, texel, 0);
  if (color.a == 0.0) discard;
  gl_SampleMask[0] = samples > 1 ? (1 << int(float(samples) * color.a + 0.5)) - 1 : -1;
  out_color = vec4(color.rgb / color.a, 1.0);
  if (linear) out_color.rgb = linear_from_srgb(out_color.rgb);
#endif
#if MULTISAMPLED
  float depth = 1.0;
  for (int i = 0; i < depth_samples; ++i)
    depth = min(depth, texelFetch(depth_texture, texel, i).r);
#else
  float depth = texelFetch(depth_texture, texel, 0).r;
#endif
  gl_FragDepth = clamp(depth_map.x + depth_map.y * depth, 0.0, 1.0);
}
)";
static_assert(kNoObject == 0);

Result<gl::Program> make_present_program(bool identifiers, bool multisampled) {
  return gl::make_program("presented frame", kPresentVertex, kPresentFragment,
                          std::string("#define IDENTIFIERS ") + (identifiers ? "1" : "0") +
                              "\n#define MULTISAMPLED " + (multisampled ? "1" : "0") + "\n");
}

}  // namespace

Result<PresentPass> PresentPass::create() {
  Result<gl::Program> colors = make_present_program(false, false),
                      multisampled = make_present_program(false, true),
                      objects = make_present_program(true, false);
  if (!colors) return colors.error();
  if (!multisampled) return multisampled.error();
  if (!objects) return objects.error();
  PresentPass pass;
  pass.colors_ = std::move(*colors);
  pass.multisampled_colors_ = std::move(*multisampled);
  pass.objects_ = std::move(*objects);
  pass.no_vertices_ = gl::make_vertex_array();
  return pass;
}

void PresentPass::draw(const PresentedTextures& frame, const DepthMap& depth) {
  glBindTextureUnit(1, frame.depth);
  glUniform1i(1, frame.top_first);
  glUniform2f(2, depth.offset, depth.scale);
  glBindVertexArray(no_vertices_);
  glDisable(GL_BLEND);
  glDisable(GL_CULL_FACE);
  glDisable(GL_SAMPLE_ALPHA_TO_COVERAGE);
  glEnable(GL_DEPTH_TEST);
  glDepthMask(GL_TRUE);
  // The sky lies on the far plane, as the cleared buffer does.
  glDepthFunc(depth.reversed ? GL_GEQUAL : GL_LEQUAL);
  glDrawArrays(GL_TRIANGLES, 0, 3);
}

void PresentPass::draw_color(const PresentedTextures& frame, const DepthMap& depth, int samples,
                             bool linear) {
  const bool multisampled = frame.depth_samples > 1;
  glUseProgram(multisampled ? multisampled_colors_ : colors_);
  glUniform1i(0, samples);
  glUniform1i(3, linear);
  if (multisampled) glUniform1i(4, frame.depth_samples);
  glBindTextureUnit(0, frame.color);
  draw(frame, depth);
}

void PresentPass::draw_objects(const PresentedTextures& frame, const DepthMap& depth) {
  glUseProgram(objects_);
  glBindTextureUnit(0, frame.objects);
  draw(frame, depth);
}

}  // namespace rilievo
