// The shaders of rilievo/nailboard/gl/nailboard_shaders.cpp in GLSL ES 3.00, for exact depths. Each
// instance is a picture on its polygon; what is drawn lies in a layer as gl/shaders.ts' nodes do.
//
// Let E be the capturing eye and P the point of the polygon at a pixel, both relative to the frame's
// eye: the surface that the texel shows lies at E + (P - E) d / plane_z, with d its eye_z in the
// capture.

/** Floats of an instance. */
export const kBoardFloats = 20;

export const kBoardVertex = `#version 300 es
precision highp float;
layout(location = 0) in vec4 eye_layer;      // E
layout(location = 1) in vec4 corner_plane;   // the polygon's upper left corner from E; plane_z
layout(location = 2) in vec4 right_width;    // edges of the polygon; texels
layout(location = 3) in vec4 down_height;
layout(location = 4) in vec4 depths;         // least, step; 1 / size of the texture array
uniform mat4 clip_from_local;
uniform vec4 forward_near;
out vec2 v_uv;  // texels
out float v_towards;  // eye_z of P - E in the frame
flat out vec4 v_depths;
flat out vec4 v_size_layer_eye;  // eye_z of E in the frame
flat out float v_plane;
void main() {
  vec2 corner = vec2(gl_VertexID & 1, gl_VertexID >> 1);
  vec3 p = corner_plane.xyz + corner.x * right_width.xyz + corner.y * down_height.xyz;
  gl_Position = clip_from_local * vec4(eye_layer.xyz + p, 1.0);
  // Depths are written: no far plane.
  gl_Position.z = 0.0;
  v_uv = corner * vec2(right_width.w, down_height.w);
  v_towards = dot(forward_near.xyz, p);
  v_depths = depths;
  v_size_layer_eye = vec4(right_width.w, down_height.w, eye_layer.w,
                          dot(forward_near.xyz, eye_layer.xyz));
  v_plane = corner_plane.w;
}
`;

export const kBoardFragment = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2DArray;
precision highp usampler2DArray;
in vec2 v_uv;
in float v_towards;
flat in vec4 v_depths;
flat in vec4 v_size_layer_eye;
flat in float v_plane;
uniform vec4 forward_near;
uniform sampler2DArray color_texture;   // sRGB, premultiplied
uniform usampler2DArray code_texture;
layout(location = 0) out vec4 out_color;
void main() {
  vec2 uv = clamp(v_uv, vec2(0.5), v_size_layer_eye.xy - 0.5);
  uint code = texelFetch(code_texture, ivec3(uv, v_size_layer_eye.z), 0).r;
  vec4 color = texture(color_texture, vec3(uv * v_depths.zw, v_size_layer_eye.z));
  if (code == 0u || color.a < 0.5) discard;
  float q = v_depths.x + float(code - 1u) * v_depths.y;
  float eye_z = v_size_layer_eye.w + v_towards / (q * v_plane);
  if (eye_z <= 0.0) discard;
  gl_FragDepth = clamp(1.0 - forward_near.w / eye_z, 0.0, 1.0);
  out_color = vec4(color.rgb / color.a, 1.0);
}
`;
