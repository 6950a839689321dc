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

#include "rilievo/render/opengl/outline_shader.h"

namespace rilievo::shader {
namespace {

const char* const kVertex = R"(#version 450
layout(location = 0) in vec4 place;    // direction, disparity
layout(location = 1) in vec4 texture_stretch;
layout(location = 0) uniform mat4 clip_from_node;
out vec3 v_direction;
out float v_stretch, v_disparity;
void main() {
  v_disparity = place.w;
  gl_Position = clip_from_node * place;
  v_direction = texture_stretch.xyz;
  v_stretch = texture_stretch.w;
}
)";

// Beside silhouettes, where weights are 0, surfaces have the colours and identifiers of those
// texels alone that lie about as deep as what is drawn: of four texels, two may show what is in
// front, and would stay on what is behind as an outline.
const char* const kFragment = R"(#version 450
in vec3 v_direction;
in float v_stretch, v_disparity;
layout(location = 1) uniform float widest_skin;  // pixels
layout(binding = 0) uniform samplerCube faces;
#ifdef OBJECT
layout(location = 3) uniform uint object;  // 0: those of the pictures
layout(binding = 2) uniform usamplerCube objects;
#ifdef LAYER
layout(location = 1) out uint out_object;
#else
layout(location = 0) out uint out_object;
#endif
#endif
#if !defined(OBJECT) || defined(LAYER)
layout(location = 0) out vec4 out_color;
#endif
#ifdef UNMIXES
layout(binding = 1) uniform samplerCube disparities;
layout(location = 4) uniform float tolerance;  // negative: all is mixed
// What four texels count, in textureGather's order: lower left, lower right, upper right, upper left,
// with t downwards. 0 of other surfaces; all 0 where there is no silhouette.
vec4 surface_weights() {
  vec3 d = v_direction, a = abs(d);
  vec4 weights = textureGather(faces, d, 3);
  if (tolerance < 0.0 || min(min(weights.x, weights.y), min(weights.z, weights.w)) > 0.0)
    return vec4(0.0);
  float ahead = max(a.x, max(a.y, a.z));
  vec2 at = ahead == a.x ? vec2(d.x > 0.0 ? -d.z : d.z, -d.y)
          : ahead == a.y ? vec2(d.x, d.y > 0.0 ? d.z : -d.z)
          : vec2(d.z > 0.0 ? d.x : -d.x, -d.y);
  vec2 share = fract((0.5 * at / ahead + 0.5) * float(textureSize(faces, 0).x) - 0.5);
  vec4 weight = vec4(1.0 - share.x, share.x, share.x, 1.0 - share.x) *
                vec4(share.y, share.y, 1.0 - share.y, 1.0 - share.y);
  float own = v_disparity / ahead;
  vec4 off = abs(textureGather(disparities, d) - own);
  float least = min(min(off.x, off.y), min(off.z, off.w));
  return max(weight, 1e-3) * vec4(lessThanEqual(off, vec4(least + tolerance * own)));
}
#endif
void main() {
#ifdef SKIN
  // From 0 to 1 over its width.
  if (v_stretch >= 0.0 && fwidth(v_stretch) * widest_skin < 1.0) discard;
#endif
#ifdef OBJECT
  out_object = object != 0u ? object : texture(objects, v_direction).r;
#endif
#if defined(DIRECTION)
  out_color = vec4(v_direction, 1.0);
#elif !defined(OBJECT) || defined(LAYER)
  vec4 color = texture(faces, v_direction);
#endif
#ifdef UNMIXES
  vec4 weight = surface_weights();
  float sum = weight.x + weight.y + weight.z + weight.w;
  if (sum > 0.0) {
#ifdef OBJECT
    if (object == 0u) {
      uvec4 around = textureGather(objects, v_direction);
      float most = 0.0;
      for (int i = 0; i < 4; ++i)
        if (weight[i] > most) {
          most = weight[i];
          out_object = around[i];
        }
    }
#endif
#if !defined(OBJECT) || defined(LAYER)
    weight /= sum;
    color.rgb = vec3(dot(weight, textureGather(faces, v_direction, 0)),
                     dot(weight, textureGather(faces, v_direction, 1)),
                     dot(weight, textureGather(faces, v_direction, 2)));
#endif
  }
#endif
#if defined(LAYER)
  // 0 is nothing, 1 a skin.
#ifdef SKIN
  out_color = vec4(color.rgb, 1.0 / 255.0);
#else
  out_color = vec4(color.rgb, (2.0 + 253.0 * color.a) / 255.0);
#endif
#elif !defined(OBJECT) && !defined(DIRECTION)
  out_color = vec4(color.rgb, 1.0);
#endif
}
)";

const char* const kMergeVertex = R"(#version 450
void main() {
  gl_Position = vec4(float((gl_VertexID & 1) * 4) - 1.0, float((gl_VertexID >> 1) * 4) - 1.0, 0.0,
                     1.0);
}
)";

// What pixels show of several nodes. Of each node its surfaces lie in a layer of their own; skins
// lie behind everything: those of all nodes in the last layer, which shows where there is no
// surface.
//
// A surface of another node than the first, which sees the eye, counts by share(), the part of 1
// that the others leave of it: a node that sees through the place knows that nothing is there,
// unless it looks at the back of a wall that has one side only. The first node's surfaces are
// there. The nearest surface of a share of at least a half, and what lies in front of `tolerance`
// behind it: of these the best one (binary), or their mean by texels' weights (weighted) and by
// nearness of the node (positional). With OBJECT the identifier of the one that counts most.
const char* const kMergeFragment = R"(#version 450
layout(binding = 0) uniform sampler2DArray colors;
layout(binding = 1) uniform sampler2DArray depths;
layout(binding = 2) uniform samplerCube disparities[LAYERS];
layout(location = 1) uniform float tolerance;
layout(location = 2) uniform vec2 planes;       // z_near, z_far
layout(location = 3) uniform float nearness[LAYERS];
layout(location = 11) uniform mat4 node_from_eye[LAYERS];
layout(location = 19) uniform vec4 rays;        // of a pixel's (x, y): at z = -1, xy + zw (x, y)
#ifdef OBJECT
layout(binding = 10) uniform usampler2DArray objects;
layout(location = 0) out uint out_object;
vec4 out_color;
#else
layout(location = 0) out vec4 out_color;
#endif
float eye_z(float window_z) {
  return planes.x * planes.y / (planes.y - window_z * (planes.y - planes.x));
}
// 1 where node j sees what lies at p or before it, 0 where it sees through p by `tolerance`.
float share(int j, vec3 p) {
  vec3 seen = (node_from_eye[j] * vec4(p, 1.0)).xyz;
  vec4 around = textureGather(disparities[j], seen);
  float nearest = max(max(around.x, around.y), max(around.z, around.w));
  float ahead = max(max(abs(seen.x), abs(seen.y)), abs(seen.z));
  // -1 says nothing.
  if (nearest < 0.0) return 1.0;
  return clamp(2.0 - 2.0 * (1.0 / max(nearest * ahead, 1e-9) - 1.0) / tolerance, 0.0, 1.0);
}
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec4 color[LAYERS];
  float depth[LAYERS], z[LAYERS], shares[LAYERS];
  float nearest = 1e30, farthest = 0.0;
  for (int i = 0; i < LAYERS; ++i) {
    color[i] = texelFetch(colors, ivec3(pixel, i), 0);
    depth[i] = texelFetch(depths, ivec3(pixel, i), 0).r;
    z[i] = eye_z(depth[i]);
    shares[i] = 1.0;
    if (color[i].a == 0.0) continue;
    nearest = min(nearest, z[i]);
    farthest = max(farthest, z[i]);
  }
  if (farthest == 0.0) {
    out_color = texelFetch(colors, ivec3(pixel, LAYERS), 0);
    if (out_color.a == 0.0) discard;
    out_color.a = 1.0;
    gl_FragDepth = texelFetch(depths, ivec3(pixel, LAYERS), 0).r;
#ifdef OBJECT
    out_object = texelFetch(objects, ivec3(pixel, LAYERS), 0).r;
#endif
    return;
  }
  int best = 0;
#if MERGE == 4
  // Others only in the gaps of the first.
  nearest = 1e30;
  for (int i = 0; i < LAYERS; ++i) {
    if (color[i].a == 0.0 || z[i] >= nearest) continue;
    nearest = z[i];
    best = i;
    out_color = vec4(color[i].rgb, 1.0);
    gl_FragDepth = depth[i];
    if (i == 0) break;
  }
#else
  if (farthest > nearest * (1.0 + 0.5 * tolerance)) {
    // Surfaces do not agree.
    vec3 ray = vec3(rays.xy + rays.zw * gl_FragCoord.xy, -1.0);
    float accepted = 1e30;
    for (int i = 0; i < LAYERS; ++i) {
      if (color[i].a == 0.0) continue;
      // Nobody sees through the sky.
      for (int j = 0; j < LAYERS; ++j)
        if (i > 0 && j != i && z[i] < 0.999 * planes.y) shares[i] = min(shares[i], share(j, z[i] * ray));
      if (shares[i] >= 0.5) accepted = min(accepted, z[i]);
    }
    if (accepted < 1e30) {
      nearest = accepted;
    } else {
      // Each is refuted by another one.
      for (int i = 0; i < LAYERS; ++i) shares[i] = 1.0;
    }
  }
  float limit = nearest * (1.0 + tolerance);
  vec3 sum = vec3(0.0);
  float weights = 0.0, most = -1.0, out_depth = 1.0;
  for (int i = 0; i < LAYERS; ++i) {
    if (color[i].a == 0.0 || z[i] > limit) continue;
    float weight = shares[i] * (max(color[i].a * 255.0 - 2.0, 0.0) + 0.25);
#if MERGE == 3
    weight *= nearness[i];
#endif
    if (weight > most) {
      most = weight;
      best = i;
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
#endif
#ifdef OBJECT
  out_object = texelFetch(objects, ivec3(pixel, best), 0).r;
#endif
}
)";

// Edges of a mesh that are silhouettes for the eye, as lines (mesh_edges.h); the others are drawn
// beyond the frame. In (x, y, w) of clip space the line through two points is their cross product.
const char* const kEdgeVertex = R"(#version 450
layout(std430, binding = 0) restrict readonly buffer Vertices { vec4 vertices[]; };  // two each
layout(std430, binding = 1) restrict readonly buffer Edges { uvec4 edges[]; };
layout(location = 20) uniform mat4 clip_from_node;
layout(location = 21) uniform bool front_only;
flat out vec3 v_line;  // times (x, y, 1): positive on the surface's side
vec4 corner(uint i) { return clip_from_node * vertices[2u * i]; }
void main() {
  uvec4 edge = edges[gl_VertexID >> 1];
  vec4 from = corner(edge.x), to = corner(edge.y);
  vec3 line = cross(from.xyw, to.xyw);
  bool from_front = dot(line, corner(edge.z).xyw) > 0.0;
  bool hidden = edge.w != 0xffffffffu ? from_front == (dot(line, corner(edge.w).xyw) < 0.0)
                                      : front_only && !from_front;
  v_line = from_front ? line : -line;
  gl_Position = hidden ? vec4(2.0, 2.0, 2.0, 1.0) : (gl_VertexID & 1) == 0 ? from : to;
}
)";

// Of what was merged in a picture of its own.
const char* const kMergedFragment = R"(#version 450
layout(binding = 0) uniform sampler2D colors;
layout(binding = 1) uniform sampler2D depths;
layout(location = 0) out vec4 out_color;
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  out_color = texelFetch(colors, pixel, 0);
  if (out_color.a == 0.0) discard;
  gl_FragDepth = texelFetch(depths, pixel, 0).r;
}
)";

// Of each pixel that a line crosses, the samples beyond it, as seen from the pixel's centre, show
// what the neighbour there does, above or below, or beside where the line is steep; cf. [Persson
// 2011, Geometric Post-process Anti-Aliasing]. Only where one of both shows the edge's surface, at
// up to NEARER times the edge's depth, and the other what is behind: another node, or what is in
// front, may cover the edge. Of samples only those change that show what was merged in the pixel:
// something else may be before it. Depths remain as they are.
const char* const kEdgeFragment = R"(#version 450
layout(binding = 0) uniform sampler2D colors;
layout(binding = 1) uniform sampler2D depths;
layout(location = 2) uniform vec2 planes;  // z_near, z_far
layout(location = 22) uniform int count;   // of samples
layout(location = 23) uniform vec2 from_centre[MAX_SAMPLES];
flat in vec3 v_line;
layout(location = 0) out vec4 out_color;
const float kBehind = 1.015;  // as by software
float eye_z(float window_z) {
  return planes.x * planes.y / (planes.y - window_z * (planes.y - planes.x));
}
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec2 clip_per_pixel = 2.0 / vec2(textureSize(depths, 0));
  float value = dot(v_line, vec3((vec2(pixel) + 0.5) * clip_per_pixel - 1.0, 1.0));
  vec2 change = v_line.xy * clip_per_pixel;
  int mask = 0;
  for (int i = 0; i < count; ++i)
    if (value * (value + dot(change, from_centre[i])) < 0.0) mask |= 1 << i;
  bool steep = abs(change.x) > abs(change.y);
  int toward = value * (steep ? change.x : change.y) > 0.0 ? -1 : 1;
  ivec2 beyond = pixel + (steep ? ivec2(toward, 0) : ivec2(0, toward));
  vec4 own = texelFetch(colors, pixel, 0), other = texelFetch(colors, beyond, 0);
  float own_depth = texelFetch(depths, pixel, 0).r, depth = texelFetch(depths, beyond, 0).r;
  float edge = eye_z(gl_FragCoord.z);
  float surface = eye_z(value > 0.0 ? own_depth : depth);
  float behind = eye_z(value > 0.0 ? depth : own_depth);
  bool outside = beyond != clamp(beyond, ivec2(0), textureSize(depths, 0) - 1);
  if (mask == 0 || outside || own.a * other.a == 0.0 || behind < kBehind * surface ||
      surface > NEARER * edge || edge > NEARER * surface)
    discard;
  gl_SampleMask[0] = mask;
  gl_FragDepth = own_depth;
  out_color = other;
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

const char* const kLineVertex = R"(#version 450
layout(std430, binding = 0) restrict readonly buffer Ends { vec4 ends[]; };
layout(location = 0) uniform mat4 clip_from_relative;
void main() { gl_Position = clip_from_relative * ends[gl_VertexID]; }
)";

// Skins have no silhouettes of their own.
std::string defines_of(NodeOutput output, bool skin) {
  std::string defines = skin ? "#define SKIN 1\n" : "";
  const bool layer = output == NodeOutput::layer || output == NodeOutput::object_layer;
  const bool object = output == NodeOutput::object || output == NodeOutput::object_layer;
  if (layer) defines += "#define LAYER 1\n";
  if (object) defines += "#define OBJECT 1\n";
  if (!skin && (layer || object || output == NodeOutput::color)) defines += "#define UNMIXES 1\n";
  if (output == NodeOutput::direction) defines += "#define DIRECTION 1\n";
  return defines;
}

}  // namespace

Result<gl::Program> make_cube_map_program() {
  return gl::make_program("cube map", kCubeMapVertex, kCubeMapFragment);
}

Result<gl::Program> make_node_line_program() { return make_outline_program(kLineVertex); }

Result<gl::Program> make_node_program(NodeOutput output) {
  return gl::make_program("environment node", kVertex, kFragment, defines_of(output, false));
}

Result<gl::Program> make_node_skin_program(NodeOutput output) {
  return gl::make_program("node skin", kVertex, kFragment, defines_of(output, true));
}

Result<gl::Program> make_node_merge_program(int merge, int layers, bool objects) {
  return gl::make_program("node merge", kMergeVertex, kMergeFragment,
                          "#define MERGE " + std::to_string(merge) + "\n#define LAYERS " +
                              std::to_string(layers) + "\n" +
                              (objects ? "#define OBJECT 1\n" : ""));
}

Result<gl::Program> make_node_merged_program() {
  return gl::make_program("merged nodes", kMergeVertex, kMergedFragment);
}

Result<gl::Program> make_node_edge_program() {
  return gl::make_program(
      "node edges", kEdgeVertex, kEdgeFragment,
      "#define NEARER 1.1\n#define MAX_SAMPLES " + std::to_string(kMaxEdgeSamples) + "\n");
}

}  // namespace rilievo::shader
