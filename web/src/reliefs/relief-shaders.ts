// The pre-warp of layered reliefs as WebGL draws it: rilievo/layered_relief/prewarp.h has the rules.
// The CPU draws samples in an order in which those that hide others come later; here each sample's
// place in this order is its depth, so that they may be drawn in any order.

export const kSplatVertex = `#version 300 es
precision highp float;
precision highp int;
layout(location = 0) in uvec4 place;   // u, v, code, number on its line of sight
layout(location = 1) in uvec2 texel;   // of the sheet
uniform highp sampler2D sheet;         // sRGB, premultiplied
uniform vec4 warp[3];                  // ReliefWarp.coefficients()
uniform vec4 frame;                    // corner and size, texels of the result
uniform ivec4 order;                   // the texel that hides all; texels across; 1: hidden by all
uniform ivec2 limits;                  // the least code; numbers on a line of sight
flat out vec4 v_color;
flat out vec3 v_splat;                 // centre, half a side
flat out uvec2 v_code_key;
void main() {
  float code = float(place.z), w = warp[1].x + warp[1].y * code, s = warp[1].z;
  vec2 at = (s * vec2(place.xy) + warp[0].xz + warp[0].yw * code) / w - frame.xy;
  float side = warp[1].w / w;
  gl_Position = int(place.z) < limits.x ? vec4(2.0, 2.0, 2.0, 1.0)
                                        : vec4(2.0 * at / frame.zw - 1.0, 0.0, 1.0);
  // A little more: rasterisers round.
  gl_PointSize = side + 0.25;
  v_splat = vec3(at, 0.5 * side);
  v_color = texelFetch(sheet, ivec2(texel), 0);
  ivec2 off = abs(ivec2(place.xy) - order.xy);
  if (order.w != 0) off = order.z - off;
  v_code_key = uvec2(
      clamp(round((warp[2].x + warp[2].y * code) / (warp[2].z + warp[2].w * code)), 0.0, 65534.0),
      (off.y * order.z + off.x) * limits.y + min(int(place.w), limits.y - 1));
}
`;

export const kSplatFragment = `#version 300 es
precision highp float;
precision highp int;
flat in vec4 v_color;
flat in vec3 v_splat;
flat in uvec2 v_code_key;
layout(location = 0) out vec4 out_color;
layout(location = 1) out uvec4 out_code;
void main() {
  vec2 off = gl_FragCoord.xy - v_splat.xy;
  if (any(lessThan(off, vec2(-v_splat.z))) || any(greaterThanEqual(off, vec2(v_splat.z)))) discard;
  // Floats are ordered as their bits are; no denormal one.
  gl_FragDepth = uintBitsToFloat(v_code_key.y + 0x00800000u);
  out_color = v_color;
  out_code = uvec4(v_code_key.x, 0u, 0u, 0u);
}
`;

const kTarget = `#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2D colors;
uniform highp usampler2D codes;   // Deltas of 16 bits; 65535: nothing
`;

const kPass = `${kTarget}
layout(location = 0) out vec4 out_color;
layout(location = 1) out uvec4 out_code;
`;

/** What is seen through gaps between splats takes after what is around it: fill_pinholes.h. */
export const kPinholeFragment = `${kPass}
uniform ivec4 place;  // of the result's corner; a neighbour is nearer by so many codes
void main() {
  ivec2 at = ivec2(gl_FragCoord.xy) + place.xy, from = at;
  int own = int(texelFetch(codes, at, 0).r), nearer = 0, farthest = -1;
  for (int k = 0; k < 9; ++k) {
    ivec2 beside = at + ivec2(k % 3, k / 3) - 1;
    int code = int(texelFetch(codes, beside, 0).r);
    if (own <= code + place.z) continue;
    ++nearer;
    if (code <= farthest) continue;
    farthest = code;
    from = beside;
  }
  if (nearer < 7) from = at;
  out_color = texelFetch(colors, from, 0);
  out_code = texelFetch(codes, from, 0);
}
`;

export const kHalveFragment = `${kPass}
uniform ivec4 place;  // the size of what is halved
void main() {
  vec4 sum = vec4(0.0);
  uint nearest = 65535u;
  for (int k = 0; k < 4; ++k) {
    ivec2 at = 2 * ivec2(gl_FragCoord.xy) + ivec2(k & 1, k >> 1);
    if (any(greaterThanEqual(at, place.xy))) continue;
    sum += texelFetch(colors, at, 0);
    nearest = min(nearest, texelFetch(codes, at, 0).r);
  }
  out_color = 0.25 * sum;
  out_code = uvec4(nearest, 0u, 0u, 0u);
}
`;

/** The result on its plane, as a nailboard from its own eye. */
export const kShowVertex = `#version 300 es
precision highp float;
uniform mat4 clip_from_local;
uniform vec4 forward_near;
uniform vec4 corner;        // g + x a + y b at the upper left, from the eye; its eye_z
uniform vec4 right, down;   // across the result; texels
out vec2 v_texel;
out float v_towards;
void main() {
  vec2 at = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  vec3 p = corner.xyz + at.x * right.xyz + at.y * down.xyz;
  gl_Position = clip_from_local * vec4(p, 1.0);
  // Depths are written: no far plane.
  gl_Position.z = 0.0;
  v_texel = at * vec2(right.w, down.w);
  v_towards = dot(forward_near.xyz, p) / corner.w;
}
`;

export const kShowFragment = `${kTarget}
in vec2 v_texel;
in float v_towards;
uniform vec4 forward_near;
uniform vec4 place;   // the size of the result, texels; its camera's planes
layout(location = 0) out vec4 out_color;
void main() {
  vec2 uv = clamp(v_texel, vec2(0.5), place.xy - 0.5);
  vec4 color = texture(colors, uv / vec2(textureSize(colors, 0)));
  if (color.a < 0.5) discard;
  ivec2 at = ivec2(uv), last = ivec2(place.xy) - 1;
  uint code = texelFetch(codes, at, 0).r;
  if (code == 65535u)
    // Where colours reach beyond what is there: the depth of the nearest beside.
    for (int k = 0; k < 9; ++k)
      code = min(code, texelFetch(codes, clamp(at + ivec2(k % 3, k / 3) - 1, ivec2(0), last), 0).r);
  float z = place.z * place.w / (place.w - float(code) / 65534.0 * (place.w - place.z));
  gl_FragDepth = clamp(1.0 - forward_near.w / (z * v_towards), 0.0, 1.0);
  out_color = vec4(color.rgb / color.a, 1.0);
}
`;
