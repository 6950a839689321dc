// The shaders of keyframes. A vertex is a corner of a texel with a disparity and is sent homogeneous,
// so that the rasteriser's division corrects places in the picture and the sky lies at infinity.

import { compile, kScreenVertex } from "../gl/program.js";

const kVertex = `#version 300 es
precision highp float;
layout(location = 0) in vec2 corner;
layout(location = 1) in float code;
uniform mat4 clip_from_raster;  // of x, y, disparity, 1
uniform vec4 scales;            // texels a unit of corners, step, offset, twice the near plane
out vec3 v_place;               // texels from the top left, code
void main() {
  vec2 texel = corner * scales.x;
  float disparity = code > 0.0 ? (code + scales.z) * scales.y : 0.0;
  vec4 clip = clip_from_raster * vec4(texel, disparity, 1.0);
  // No far plane: the sky has the depth 1.
  clip.z = clip.w - scales.w * disparity;
  gl_Position = clip;
  v_place = vec3(texel, code);
}
`;

// Surfaces that touch no cut are plain bilinear. BESIDE a cut those of the four texels around count that lie
// about as deep as what is drawn; of a SKIN those that lie farthest: it fills what is behind the nearer surface.
const kFragment = `#version 300 es
precision highp float;
precision highp int;
precision highp usampler2D;
in vec3 v_place;
uniform sampler2D colors;
uniform vec4 size;        // 1 / width, 1 / height, offset, share of a disparity
#if defined(BESIDE) || defined(SKIN)
uniform usampler2D codes;
#endif
layout(location = 0) out vec4 out_color;
void main() {
#if defined(BESIDE) || defined(SKIN)
  ivec2 last = textureSize(codes, 0) - 1;
  vec2 from = clamp(v_place.xy, vec2(0.5), vec2(last) + 0.5) - 0.5, low = floor(from), far = from - low, near = 1.0 - far;
  ivec2 p = ivec2(low), q = min(p + 1, last);
  vec4 around = vec4(texelFetch(codes, p, 0).r, texelFetch(codes, ivec2(q.x, p.y), 0).r,
                     texelFetch(codes, ivec2(p.x, q.y), 0).r, texelFetch(codes, q, 0).r);
#ifdef SKIN
  float wanted = min(min(around.x, around.y), min(around.z, around.w));
#else
  float wanted = v_place.z;
#endif
  vec4 off = abs(around - wanted);
  // The sky is far from everything.
  off = mix(off, vec4(wanted > 0.0 ? 1e9 : 0.0), equal(around, vec4(0.0)));
  float least = min(min(off.x, off.y), min(off.z, off.w));
  vec4 weight = max(vec4(near.x, far.x, near.x, far.x) * vec4(near.y, near.y, far.y, far.y), 1e-3) *
                vec4(lessThanEqual(off, vec4(least + 2.0 + size.w * (wanted + size.z))));
  vec3 sum = weight.x * texelFetch(colors, p, 0).rgb + weight.y * texelFetch(colors, ivec2(q.x, p.y), 0).rgb +
             weight.z * texelFetch(colors, ivec2(p.x, q.y), 0).rgb + weight.w * texelFetch(colors, q, 0).rgb;
  out_color = vec4(sum / (weight.x + weight.y + weight.z + weight.w), 1.0);
#else
  out_color = vec4(textureLod(colors, v_place.xy * size.xy, 0.0).rgb, 1.0);
#endif
}
`;

/** Keyframes that count less than this share of the best are not mixed with it. */
export const kSpare = 0.4;
/** In the first layer's depths lie surfaces, behind them coarse pictures, skins, aprons. */
export const kFills = 4;
/** A part of the depths from 0 to 1 is that of one of them. */
export const kFillDepth = 0.2;

// The nearest surface is shown; keyframes that show it, too, are mixed by what they count, but those
// that count little beside the best. w is the near plane by the distance; 0 is the sky.
function mergeFragment(layers: number): string {
  const each = (line: (layer: number) => string) => Array.from({ length: layers }, (_, i) => line(i)).join("");
  return `#version 300 es
precision highp float;
precision highp int;
uniform highp sampler2DArray colors;
uniform highp sampler2DArray depths;
uniform float counts[${layers}];
uniform float tolerance;
uniform float near_ratio;  // of the near plane of the frame by that of the layers
layout(location = 0) out vec4 out_color;
float w_of(float depth) {
  float w = 1.0 - (depth - floor(depth * ${kFills}.0) / ${kFills}.0) / ${kFillDepth};
  // What is as far as this is the sky.
  return w < 4e-6 ? 0.0 : near_ratio * w;
}
void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
${each((i) => `
  vec4 c${i} = texelFetch(colors, ivec3(pixel, ${i}), 0);
  float z${i} = texelFetch(depths, ivec3(pixel, ${i}), 0).r, w${i} = z${i} < 1.0 / ${kFills}.0 ? w_of(z${i}) : -1.0;`)}
  float nearest = ${each((i) => `max(w${i}, `)}-1.0${")".repeat(layers)};
  if (nearest < 0.0) {
    if (c0.a == 0.0) discard;
    out_color = c0;
    gl_FragDepth = max(0.0, 1.0 - w_of(z0));
    return;
  }
${layers === 1 ? `
  out_color = c0;
  gl_FragDepth = max(0.0, 1.0 - w0);` : `
  float limit = nearest / (1.0 + tolerance), most = 0.0, w = 0.0, sum = 0.0;
  vec3 color = vec3(0.0);
${each((i) => `
  float k${i} = w${i} >= limit ? counts[${i}] : 0.0;
  most = max(most, k${i});`)}
${each((i) => `
  if (k${i} == most) w = w${i};
  if (k${i} >= ${kSpare} * most) {
    color += k${i} * c${i}.rgb;
    sum += k${i};
  }`)}
  out_color = vec4(color / sum, 1.0);
  gl_FragDepth = max(0.0, 1.0 - w);`}
}
`;
}

export function keyframeProgram(gl: WebGL2RenderingContext, define: "SURFACE" | "BESIDE" | "SKIN"): WebGLProgram {
  const end = kFragment.indexOf("\n") + 1;
  return compile(gl, "keyframe", kVertex, `${kFragment.slice(0, end)}#define ${define} 1\n${kFragment.slice(end)}`);
}

export function mergeProgram(gl: WebGL2RenderingContext, layers: number): WebGLProgram {
  return compile(gl, "merge of keyframes", kScreenVertex, mergeFragment(layers));
}
