// Exact depth with one division a pixel. Let E be the capturing eye and P the point of the polygon
// at this pixel, both relative to the frame's eye, and d the eye_z of the surface that the texel
// shows. It lies at E + (P - E) d / plane_z. Its clip coordinates are linear in that; divided by d
// / plane_z, which cancels in the projection, and with q = plane_z / d:
//
//   clip ~ q clip(E) + (clip(P) - clip(E)),      window_z = (clip_z / clip_w + 1) / 2 (1)
//
// q is affine in Delta, since Delta is a window_z and so affine in 1 / d:
//
//   q = plane_z / z_near + Delta (plane_z / z_far - plane_z / z_near) (2)
//
// clip(E) is constant over the polygon and clip(P) is what the rasteriser interpolates anyway.
//
// Linear depth, eq. (4) of [Schaufler 1997]: window_z of a plane is affine over the screen, so z_N
// and z_F - z_N could interpolate without perspective, were no corner of the polygon behind the
// eye, where there is no window_z. Times clip_w they are linear in P everywhere: with A the
// capturing camera's -z, the line of sight through P meets the plane of eye_z z at
//
//   N = s P,  1 / s = A.P / (z + A.E),   clip_z = s Z(P) + c,  clip_w = s W(P)  (c: at the eye)
//   window_z W(P) = (Z(P) + c A.P / (z + A.E) + W(P)) / 2 (3)
//
// and the division by W(P) is the one that the rasteriser has made: gl_FragCoord.w.
#include "rilievo/nailboard/gl/nailboard_shaders.h"

#include <string>

#include "rilievo/render/opengl/outline_shader.h"
#include "rilievo/render/opengl/scene_shaders.h"

namespace rilievo::shader {
namespace {

const char* const kVersion = "#version 450\n";

const char* const kInstance = R"(
struct Picture {
  vec4 origin_layer;   // polygon's lower left corner; atlas layer
  vec4 u_axis_slot_x;  // edges of the polygon; slot in the atlas, texels
  vec4 v_axis_slot_y;
  vec4 eye_slot_width;       // E
  vec4 forward_slot_height;  // the capturing camera's -z
  vec4 depths;  // z_near, z_far, plane_z; identifier's bits
  vec4 share;   // of the pixels, in x and y
  mat3 texel_from_raster;  // of (x, y, 1) in the frame, homogeneous
};
layout(std430, binding = 0) readonly buffer Pictures { Picture pictures[]; };
layout(location = 0) uniform mat4 clip_from_relative;
)";

const char* const kVertex = R"(
// Of each rectangle of the frame three words: its picture; x0 | y0 << 16; x1 | y1 << 16, pixels; or
// no pixels, for the whole polygon.
layout(std430, binding = 1) readonly buffer Rectangles { uint rectangles[]; };
layout(location = 3) uniform vec2 clip_from_pixels;
out gl_PerVertex {
  vec4 gl_Position;
  float gl_ClipDistance[4];
};
out vec2 v_uv;  // texels
flat out vec4 v_slot;  // centres of its first and last texels: beyond them lie other pictures
flat out int v_layer;
#if MODE == 2
out vec2 v_towards;  // z and w of clip(P) - clip(E), z scaled for (1)
flat out vec4 v_eye;  // z and w of clip(E); q at Delta = 0 and its slope
#elif MODE == 1
out vec2 v_near_extent;  // z_N, z_F - z_N, times clip_w
#endif
#ifdef OBJECT_IDS
flat out uint v_object;
#endif
#ifdef SHARE
flat out vec2 v_share;
#endif

#if MODE == 1
float window_z_times_w(Picture picture, vec3 p, vec4 clip, float eye_z) {  // (3)
  vec3 e = picture.eye_slot_width.xyz, axis = picture.forward_slot_height.xyz;
  float at_eye = clip_from_relative[3].z;
  return 0.5 * (clip.z - at_eye + at_eye * dot(axis, p) / (eye_z + dot(axis, e)) + clip.w);
}
#endif

void main() {
  int first = 3 * (gl_VertexID >> 2);
  Picture picture = pictures[rectangles[first]];
  ivec2 side = ivec2(gl_VertexID & 1, (gl_VertexID >> 1) & 1);
  vec2 pixel = vec2(float(rectangles[first + 1 + side.x] & 0xFFFFu),
                    float(rectangles[first + 1 + side.y] >> 16));
  bool whole = rectangles[first + 2] == 0u;
  vec2 slot = vec2(picture.u_axis_slot_x.w, picture.v_axis_slot_y.w);
  vec2 size = vec2(picture.eye_slot_width.w, picture.forward_slot_height.w);
  vec3 at = picture.texel_from_raster * vec3(pixel, 1.0);
  vec2 texel = whole ? vec2(side) * size : at.xy / at.z;
  vec2 corner = texel / size;
  vec3 p = picture.origin_layer.xyz + corner.x * picture.u_axis_slot_x.xyz +
           corner.y * picture.v_axis_slot_y.xyz;
  gl_Position = clip_from_relative * vec4(p, 1.0);
  // Exactly there, so that rectangles meet.
  if (!whole) gl_Position.xy = (pixel * clip_from_pixels - 1.0) * gl_Position.w;
  // A rectangle may reach over the polygon's edges.
  gl_ClipDistance[0] = texel.x;
  gl_ClipDistance[1] = size.x - texel.x;
  gl_ClipDistance[2] = texel.y;
  gl_ClipDistance[3] = size.y - texel.y;
  v_uv = slot + texel;
  v_slot = vec4(slot, slot + size) + vec4(0.5, 0.5, -0.5, -0.5);
  v_layer = int(picture.origin_layer.w);
  vec4 depths = picture.depths;
#if MODE == 2
  vec4 e = clip_from_relative * vec4(picture.eye_slot_width.xyz, 1.0);
  vec4 towards = gl_Position - e;
  // Window instead of clip depth: (z / w + 1) / 2 = (z + w) / 2 / w.
  v_towards = vec2(0.5 * (towards.z + towards.w), towards.w);
  float q_near = depths.z / depths.x, q_far = depths.z / depths.y;
  v_eye = vec4(0.5 * (e.z + e.w), e.w, q_near, q_far - q_near);
#elif MODE == 1
  float z_n = window_z_times_w(picture, p, gl_Position, depths.x);
  v_near_extent = vec2(z_n, window_z_times_w(picture, p, gl_Position, depths.y) - z_n);
#endif
#ifdef OBJECT_IDS
  v_object = floatBitsToUint(depths.w);
#endif
#ifdef SHARE
  v_share = picture.share.xy;
#endif
}
)";

const char* const kFragment = R"(
in vec2 v_uv;
flat in vec4 v_slot;
flat in int v_layer;
#if MODE == 2
in vec2 v_towards;
flat in vec4 v_eye;
#elif MODE == 1
in vec2 v_near_extent;
#endif
#ifdef SHARE
flat in vec2 v_share;
#endif
layout(binding = 0) uniform sampler2DArray color_texture;
layout(binding = 1) uniform sampler2DArray delta_texture;
layout(location = 1) uniform float delta_scale;  // texture's value to Delta
layout(location = 2) uniform float largest_delta;  // between 1 and the reserved code
#ifdef OBJECT_IDS
layout(binding = 2) uniform usampler2DArray object_texture;
flat in uint v_object;
layout(location = 0) out uint out_object;
#else
layout(location = 4) uniform bool nearest_coverage;  // SampleRounding::nearest
layout(location = 0) out vec4 out_color;
#endif

void main() {
#ifdef SHARE
  float hash = pixel_hash();
  if (hash < v_share.x || hash >= v_share.y) discard;
#endif
  // Where samples are covered and the pixel's centre is not, v_uv lies off the polygon.
  vec2 uv = clamp(v_uv, v_slot.xy, v_slot.zw);
  ivec3 texel = ivec3(uv, v_layer);
  float delta = texelFetch(delta_texture, texel, 0).r * delta_scale;
  if (delta > largest_delta) discard;
  vec4 color = texture(color_texture, vec3(uv * (1.0 / 1024.0), float(v_layer)));
#if MODE == 2
  float q = v_eye.z + v_eye.w * delta;
  gl_FragDepth = (q * v_eye.x + v_towards.x) / (q * v_eye.y + v_towards.y);
#elif MODE == 1
  gl_FragDepth = (v_near_extent.x + v_near_extent.y * delta) * gl_FragCoord.w;
#endif
#ifdef OBJECT_IDS
  // An empty texel has a depth for the colours that reach into it, but no object.
  if (color.a < 0.5 || texelFetch(color_texture, texel, 0).a == 0.0) discard;
  out_object = v_object != 0u ? v_object : texelFetch(object_texture, texel, 0).r;
  // Colours of 4 samples reach over a centre that shows nothing.
  if (out_object == 0u) discard;
#else
  if (color.a < (gl_NumSamples > 1 ? 0.125 : 0.5)) discard;
  // What is drawn is opaque: alpha says how many samples, and then becomes 1 (ALPHA_TO_ONE).
  out_color = vec4(color.rgb / color.a,
                   gl_NumSamples > 1 && !nearest_coverage ? color.a : 1.0);
  int samples = int(float(gl_NumSamples) * color.a + 0.5);
  gl_SampleMask[0] = nearest_coverage ? (1 << samples) - 1 : -1;
#endif
}
)";

const char* const kOutlineVertex = R"(
void main() {
  // Around the polygon, not across it.
  vec2 corner = vec2(((gl_VertexID + 1) >> 1) & 1, gl_VertexID >> 1);
  Picture picture = pictures[gl_InstanceID];
  vec3 p = picture.origin_layer.xyz + corner.x * picture.u_axis_slot_x.xyz +
           corner.y * picture.v_axis_slot_y.xyz;
  gl_Position = clip_from_relative * vec4(p, 1.0);
}
)";

}  // namespace

Result<gl::Program> make_nailboard_program(DepthMode mode, NailboardOutput output) {
  std::string defines = "#define MODE " + std::to_string(int(mode)) + "\n";
  if (output == NailboardOutput::objects) defines += "#define OBJECT_IDS 1\n";
  // Identifiers fade as colours do, so that a fade that leaves holes is seen.
  if (output != NailboardOutput::color) defines += "#define SHARE 1\n";
  return gl::make_program("nailboard", std::string(kVersion) + kInstance + kVertex,
                          std::string(kVersion) + kPixelHash + kFragment, defines);
}

Result<gl::Program> make_nailboard_outline_program() {
  return make_outline_program(std::string(kVersion) + kInstance + kOutlineVertex);
}

}  // namespace rilievo::shader
