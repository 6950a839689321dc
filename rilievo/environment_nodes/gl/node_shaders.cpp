// Texture coordinates that undo perspective correction (S3.3). A vertex lies at direction c_i times
// its depth w_i = 1 / d_i from the node. The texel that a point P of the triangle shows is the one
// in the direction of P - E = sum b_i w_i c_i, with b_i the point's place in the triangle in space:
// so w_i c_i is what has to be interpolated with perspective correction, the appendix's
// (w s, w t, 0, w). With vertices scaled by d_i, homogeneous (c_i, d_i) in place of (w_i c_i, 1),
// the rasteriser's own division does that to plain c_i:
//
//   sum a_i c_i / (d_i W_i)  by  sum a_i / (d_i W_i),   a_i: place in the frame, W_i: clip w
//
// and the divisor does not change a direction. Nothing is infinite where d_i = 0.
#include "rilievo/environment_nodes/gl/node_shaders.h"

#include <string>

namespace rilievo::shader {
namespace {

const char* const kVertex = R"(#version 450
layout(location = 0) in vec4 place;    // direction, disparity
layout(location = 1) in vec4 texture_stretch;
layout(location = 0) uniform mat4 clip_from_node;
out vec3 v_direction;
out float v_stretch;
void main() {
#ifdef TWICE
  gl_Position = clip_from_node * vec4(place.xyz / place.w, 1.0);
#else
  gl_Position = clip_from_node * place;
#endif
  v_direction = texture_stretch.xyz;
  v_stretch = texture_stretch.w;
}
)";

const char* const kFragment = R"(#version 450
in vec3 v_direction;
in float v_stretch;
layout(location = 1) uniform float widest_skin;  // pixels
#ifdef LAYER
layout(location = 2) uniform int first_triangle;
layout(std430, binding = 0) readonly buffer Quality { float quality[]; };
#endif
#ifdef OBJECT
layout(location = 3) uniform uint object;  // 0: those of the pictures
layout(binding = 1) uniform usamplerCube objects;
layout(location = 0) out uint out_object;
#else
layout(binding = 0) uniform samplerCube faces;
layout(location = 0) out vec4 out_color;
#endif
void main() {
#ifdef SKIN
  // From 0 to 1 over its width.
  if (v_stretch >= 0.0 && fwidth(v_stretch) * widest_skin < 1.0) discard;
#endif
#if defined(OBJECT)
  out_object = object != 0u ? object : texture(objects, v_direction).r;
#elif defined(DIRECTION)
  out_color = vec4(v_direction, 1.0);
#else
  vec4 color = texture(faces, v_direction);
#ifdef LAYER
  // 0 is nothing, 1 a skin.
#ifdef SKIN
  out_color = vec4(color.rgb, 1.0 / 255.0);
#else
  out_color = vec4(color.rgb, (2.0 + 253.0 * quality[first_triangle + gl_PrimitiveID]) / 255.0);
#endif
#else
  out_color = vec4(color.rgb, 1.0);
#endif
#endif
}
)";

const char* const kMergeVertex = R"(#version 450
void main() {
  gl_Position = vec4(float((gl_VertexID & 1) * 4) - 1.0, float((gl_VertexID >> 1) * 4) - 1.0, 0.0,
                     1.0);
}
)";

// The nearest surface, and what lies within `tolerance` of it, relative: of these the best one
// (binary), or their mean by quality (weighted) and by nearness of the node (positional). A skin
// counts only where no node has more.
const char* const kMergeFragment = R"(#version 450
layout(binding = 0) uniform sampler2DArray colors;
layout(binding = 1) uniform sampler2DArray depths;
layout(location = 1) uniform float tolerance;
layout(location = 2) uniform vec2 planes;       // z_near, z_far
layout(location = 3) uniform float nearness[LAYERS];
layout(location = 0) out vec4 out_color;
float eye_z(float window_z) {
  return planes.x * planes.y / (planes.y - window_z * (planes.y - planes.x));
}
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 color[LAYERS];
  float depth[LAYERS];
  float nearest = 1e30, nearest_skin = 1e30;
  for (int i = 0; i < LAYERS; ++i) {
    color[i] = texelFetch(colors, ivec3(pixel, i), 0);
    depth[i] = texelFetch(depths, ivec3(pixel, i), 0).r;
    if (color[i].a > 1.5 / 255.0) nearest = min(nearest, depth[i]);
    else if (color[i].a > 0.0) nearest_skin = min(nearest_skin, depth[i]);
  }
  bool skin = nearest > 1.0;
  if (skin) nearest = nearest_skin;
  if (nearest > 1.0) discard;
  float limit = eye_z(nearest) * (1.0 + tolerance);
  vec3 sum = vec3(0.0);
  float weights = 0.0, most = -1.0, out_depth = nearest;
  for (int i = 0; i < LAYERS; ++i) {
    if (color[i].a == 0.0 || (color[i].a > 1.5 / 255.0) == skin || eye_z(depth[i]) > limit) continue;
    float weight = skin ? 1.0 : max(color[i].a * 255.0 - 2.0, 0.0) + 0.25;
#if MERGE == 3
    weight *= nearness[i];
#endif
    if (weight > most) {
      most = weight;
      out_depth = depth[i];
#if MERGE == 1
      sum = color[i].rgb;
#endif
    }
#if MERGE != 1
    sum += weight * color[i].rgb;
    weights += weight;
#endif
  }
#if MERGE != 1
  sum /= max(weights, 1e-20);
#endif
  out_color = vec4(sum, 1.0);
  gl_FragDepth = out_depth;
}
)";

const char* const kCoverFragment = R"(#version 450
layout(binding = 0) uniform sampler2DArray colors;
void main() {
  if (texelFetch(colors, ivec3(ivec2(gl_FragCoord.xy), 0), 0).a < 1.5 / 255.0) discard;
  gl_FragDepth = 0.0;
}
)";

const char* const kCubeMapVertex = R"(#version 450
layout(location = 0) uniform vec3 rays[3];
out vec3 v_direction;
void main() {
  gl_Position = vec4(float((gl_VertexID & 1) * 4) - 1.0, float((gl_VertexID >> 1) * 4) - 1.0, 0.0,
                     1.0);
  v_direction = rays[gl_VertexID];
}
)";

const char* const kCubeMapFragment = R"(#version 450
in vec3 v_direction;
layout(binding = 0) uniform samplerCube faces;
layout(location = 0) out vec4 out_color;
void main() { out_color = vec4(texture(faces, v_direction).rgb, 1.0); }
)";

}  // namespace

Result<gl::Program> make_cube_map_program() {
  return gl::make_program("cube map", kCubeMapVertex, kCubeMapFragment);
}

Result<gl::Program> make_node_program(NodeOutput output) {
  std::string defines;
  if (output == NodeOutput::layer) defines = "#define LAYER 1\n";
  if (output == NodeOutput::object) defines = "#define OBJECT 1\n";
  if (output == NodeOutput::direction) defines = "#define DIRECTION 1\n";
  if (output == NodeOutput::color_twice_corrected) defines = "#define TWICE 1\n";
  return gl::make_program("environment node", kVertex, kFragment, defines);
}

Result<gl::Program> make_node_skin_program(NodeOutput output) {
  std::string defines = "#define SKIN 1\n";
  if (output == NodeOutput::layer) defines += "#define LAYER 1\n";
  if (output == NodeOutput::object) defines += "#define OBJECT 1\n";
  if (output == NodeOutput::direction) defines += "#define DIRECTION 1\n";
  return gl::make_program("node skin", kVertex, kFragment, defines);
}

Result<gl::Program> make_node_cover_program() {
  return gl::make_program("node cover", kMergeVertex, kCoverFragment);
}

Result<gl::Program> make_node_merge_program(int merge, int layers) {
  return gl::make_program("node merge", kMergeVertex, kMergeFragment,
                          "#define MERGE " + std::to_string(merge) + "\n#define LAYERS " +
                              std::to_string(layers) + "\n");
}

}  // namespace rilievo::shader
