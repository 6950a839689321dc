// The shaders of rilievo/environment_nodes/gl/node_shaders.cpp in GLSL ES 3.00. A vertex lies at
// direction / disparity from the node and is sent homogeneous, so that the rasteriser's own
// division corrects texture coordinates and the sky lies at infinity (S3.3).

import type { SkyEntry } from "../manifest.js";
import { beginProgram, compile, kScreenVertex } from "./program.js";

export const kSkyTexels = 2048;

const kVertex = `#version 300 es
precision highp float;
layout(location = 0) in vec3 direction;     // times the scale
layout(location = 1) in float disparity;    // code
#ifdef SKIN
layout(location = 2) in vec3 texture_direction;  // times 4 N
layout(location = 3) in float stretch;           // 8 times itself, plus 1; 0: always
out float v_stretch;
#endif
uniform mat4 clip_from_node;
uniform vec4 scales;  // 1 / N, disparity step, 1 / 4 N, twice the near plane
uniform float size;   // N
#ifdef SIDE
// Of a side, whose vertices lie on the plane before its face.
uniform mat3 face;    // rows: right, up, and the face's number times z
out vec2 v_texel;
out float v_disparity;  // code
flat out float v_layer;
#else
out vec3 v_direction;
#endif
void main() {
  vec4 place = vec4(direction * scales.x, disparity * scales.y);
  vec4 clip = clip_from_node * place;
  // No far plane: the sky has a disparity of 0 and the depth 1.
  clip.z = clip.w - scales.w * place.w;
  gl_Position = clip;
#ifdef SKIN
  v_direction = texture_direction * scales.z;
  v_stretch = (stretch - 1.0) * 0.125;
#elif defined(SIDE)
  v_texel = (0.5 + 0.5 * (face * place.xyz).xy) * size;
  v_disparity = disparity;
  v_layer = face[2][2];
#else
  v_direction = place.xyz;
#endif
}
`;

// A direction's face and its place there, from -1 to 1, of OpenGL's cube maps.
const kFaceOf = `int face_of(vec3 d, out vec2 st) {
  vec3 a = abs(d);
  bool x = a.x >= max(a.y, a.z), y = !x && a.y >= a.z;
  float along = x ? d.x : y ? d.y : d.z, ahead = abs(along);
  // Without branches, of which software runs both sides.
  float turned = along > 0.0 ? 1.0 : -1.0;
  st = vec2(x ? -turned * d.z : y ? d.x : turned * d.x, y ? turned * d.z : -d.y) / ahead;
  return (x ? 0 : y ? 2 : 4) + (along > 0.0 ? 0 : 1);
}
`;

// Beside silhouettes, where weights are 0, surfaces have the colours of those texels alone that lie
// about as deep as what is drawn, as kFragment of node_shaders.cpp says.
const kFragment = `#version 300 es
precision highp float;
precision highp int;
precision highp usampler2D;
precision highp sampler2DArray;
uniform sampler2DArray faces;
uniform float size;  // N
#ifdef SIDE
in vec2 v_texel;
in float v_disparity;
flat in float v_layer;
uniform usampler2D seen;  // NodePainter's (seen.ts)
uniform float unmix;      // tolerance; negative: all is mixed
uint code_at(int x, int y) { return texelFetch(seen, ivec2(x, y), 0).r & 0x7fffu; }
vec3 surface_color(vec3 mixed, ivec2 low, ivec2 p, ivec2 q) {
  vec2 far = v_texel - 0.5 - vec2(low), near = 1.0 - far;
  ivec3 at = ivec3(low + 1, v_layer);
  vec4 c0 = texelFetch(faces, at, 0), c1 = texelFetch(faces, at + ivec3(1, 0, 0), 0);
  vec4 c2 = texelFetch(faces, at + ivec3(0, 1, 0), 0), c3 = texelFetch(faces, at + ivec3(1, 1, 0), 0);
  uvec4 codes = uvec4(code_at(p.x, p.y), code_at(q.x, p.y), code_at(p.x, q.y), code_at(q.x, q.y));
  // Halves, less one; nothing is far from everything.
  vec4 off = abs(mix(uintBitsToFloat(codes * 8192u + 0x37ffe000u), vec4(-1.0), equal(codes, uvec4(0u))) -
                 v_disparity);
  float least = min(min(off.x, off.y), min(off.z, off.w));
  vec4 weight = vec4(near.x, far.x, near.x, far.x) * vec4(near.y, near.y, far.y, far.y);
  weight = max(weight, 1e-3) * vec4(lessThanEqual(off, vec4(least + unmix * v_disparity)));
  vec3 kept = (weight.x * c0.rgb + weight.y * c1.rgb + weight.z * c2.rgb + weight.w * c3.rgb) /
              (weight.x + weight.y + weight.z + weight.w);
  return min(min(c0.a, c1.a), min(c2.a, c3.a)) > 0.0 ? mixed : kept;
}
vec4 color_at() {
  vec4 color = textureLod(faces, vec3((v_texel + 1.0) / (size + 2.0), v_layer), 0.0);
  if (unmix < 0.0 || color.a >= 0.5) return color;
  // The four texels around, of which the first lies at low.
  int face = int(v_layer);
  ivec2 low = ivec2(floor(v_texel - 0.5)), last = ivec2(size) - 1;
  ivec2 corner = ivec2(face % 3, face / 3) * (last + 1), p = corner + clamp(low, ivec2(0), last);
  if ((texelFetch(seen, p, 0).r & 0x8000u) != 0u)
    color.rgb = surface_color(color.rgb, low, p, corner + clamp(low + 1, ivec2(0), last));
  return color;
}
#else
in vec3 v_direction;
${kFaceOf}
#endif
#ifdef SKIN
in float v_stretch;
uniform float widest_skin;  // pixels
#endif
#ifdef OBJECT
uniform usampler2D objects;  // 3 x 2 faces
layout(location = 0) out uvec4 out_object;
uint object_at(vec3 d) {
  vec2 st;
  int face = face_of(d, st), last = int(size) - 1;
  ivec2 texel = clamp(ivec2(floor((0.5 * st + 0.5) * size)), ivec2(0), ivec2(last));
  return texelFetch(objects, ivec2(face % 3, face / 3) * (last + 1) + texel, 0).r;
}
#else
layout(location = 0) out vec4 out_color;
#endif
void main() {
#ifdef SKIN
  // From 0 to 1 over its width.
  if (v_stretch >= 0.0 && fwidth(v_stretch) * widest_skin < 1.0) discard;
#endif
#ifdef OBJECT
  out_object = uvec4(object_at(v_direction), 0u, 0u, 1u);
#elif defined(SKIN)
  vec2 st;
  int face = face_of(v_direction, st);
  out_color = vec4(textureLod(faces, vec3(((0.5 * st + 0.5) * size + 1.0) / (size + 2.0), face), 0.0).rgb,
                   1.0 / 255.0);
#else
  // 0 is nothing, 1 a skin.
  vec4 color = color_at();
  out_color = vec4(color.rgb, (2.0 + 253.0 * color.a) / 255.0);
#endif
}
`;

function each(layers: number, line: (layer: number) => string): string {
  return Array.from({ length: layers }, (_, layer) => line(layer)).join("");
}

/**
 * The merge (S3.7), as kMergeFragment of node_shaders.cpp explains it: of each node its surfaces lie
 * in a layer of their own, and skins lie behind everything, those of all nodes in the last layer. A
 * node that is drawn alone has both in its layer. GLSL of
 * `bool merge_nodes(ivec2 pixel, out vec3 color, out float eye_z)`; colours are sRGB-encoded.
 */
export function mergeFunction(layers: number): string {
  const head = `
uniform highp sampler2DArray node_colors;
uniform highp sampler2DArray node_depths;
uniform vec2 node_merge;  // tolerance, near plane of the layers
float layer_z(ivec2 pixel, int layer) {
  // The sky: far beyond all surfaces, but a number.
  return node_merge.y / max(1.0 - texelFetch(node_depths, ivec3(pixel, layer), 0).r, 1e-15);
}
`;
  if (layers === 1)
    return `${head}
bool merge_nodes(ivec2 pixel, out vec3 color, out float eye_z) {
  vec4 shown = texelFetch(node_colors, ivec3(pixel, 0), 0);
  color = shown.rgb;
  eye_z = layer_z(pixel, 0);
  return shown.a > 0.0;
}
`;
  // Unrolled: software rasterisers are slow with arrays.
  return `${head}
uniform float node_nearness[${layers}];
uniform float node_steps[${layers}];  // 1/m, of disparities
uniform mat4 node_from_pixel[${layers}];  // of (x z, y z, z, 1) at a pixel's (x, y) and eye_z z
${kFaceOf}
${each(layers, shareFunction)}
bool merge_nodes(ivec2 pixel, out vec3 color, out float eye_z) {
  float nearest = 1e38, farthest = 0.0;
${each(layers, (i) => `
  vec4 c${i} = texelFetch(node_colors, ivec3(pixel, ${i}), 0);
  float d${i} = layer_z(pixel, ${i}), s${i} = 1.0;
  if (c${i}.a > 0.0) {
    nearest = min(nearest, d${i});
    farthest = max(farthest, d${i});
  }`)}
  color = vec3(0.0);
  eye_z = 0.0;
  bool shows = farthest > 0.0;
  if (!shows) {
    vec4 skin = texelFetch(node_colors, ivec3(pixel, ${layers}), 0);
    color = skin.rgb;
    eye_z = layer_z(pixel, ${layers});
    shows = skin.a > 0.0;
  }
  if (farthest > nearest * (1.0 + 0.5 * node_merge.x)) {
    // Surfaces do not agree. Those of the first node, which sees the eye, are there.
    vec2 at = vec2(pixel) + 0.5;
    float accepted = 1e38;
    if (c0.a > 0.0) accepted = d0;
${each(layers, (i) => i === 0 ? "" : `
    if (c${i}.a > 0.0) {
      // Nobody sees through the sky.
      if (d${i} < 1e12 * node_merge.y) {
        vec4 p = vec4(d${i} * at, d${i}, 1.0);
${each(layers, (j) => j === i ? "" : `        s${i} = min(s${i}, node_share${j}(p));\n`)}
      }
      if (s${i} >= 0.5) accepted = min(accepted, d${i});
    }`)}
    if (accepted < 1e37) {
      nearest = accepted;
    } else {
      // Each is refuted by another one.
${each(layers, (i) => `      s${i} = 1.0;\n`)}
    }
  }
  float limit = nearest * (1.0 + node_merge.x);
  float weights = 0.0, most = -1.0;
${each(layers, (i) => `
  if (c${i}.a > 0.0 && d${i} <= limit) {
    float weight = s${i} * (max(c${i}.a * 255.0 - 2.0, 0.0) + 0.25) * node_nearness[${i}];
    if (weight > most) {
      most = weight;
      eye_z = d${i};
    }
    color += weight * c${i}.rgb;
    weights += weight;
  }`)}
  if (weights > 0.0) color /= weights;
  return shows;
}
`;
}

// node_share: 1 where the node sees what lies at p (node_from_pixel) or before it, 0 where it sees
// through p by the tolerance.
function shareFunction(node: number): string {
  return `
uniform highp usampler2D node_seen${node};
float node_share${node}(vec4 p) {
  vec3 seen = (node_from_pixel[${node}] * p).xyz;
  vec2 st;
  int face = face_of(seen, st), size = textureSize(node_seen${node}, 0).x / 3;
  ivec2 at = clamp(ivec2(floor((0.5 * st + 0.5) * float(size) - 0.5)), ivec2(0), ivec2(size - 1));
  // The largest of the four around it, of this face.
  uint code = texelFetch(node_seen${node}, at + ivec2(face % 3, face / 3) * size, 0).g;
  // A half, less one.
  float nearest = uintBitsToFloat(code * 8192u + 0x37ffe000u) * node_steps[${node}];
  float ahead = max(max(abs(seen.x), abs(seen.y)), abs(seen.z));
  float share = 2.0 - 2.0 * (1.0 / max(nearest * ahead, 1e-9) - 1.0) / node_merge.x;
  // It may say nothing.
  return code == 0u ? 1.0 : clamp(share, 0.0, 1.0);
}
`;
}

// The sky of the walk or, if it has none, the default of the library, for what no node shows.
const kSkyColor = `
uniform mat3 world_from_pixel;  // the line of sight through a pixel's (x, y, 1)
uniform highp sampler2D sky;    // skyTexels()
vec4 sky_color() {
  float elevation = normalize(world_from_pixel * vec3(gl_FragCoord.xy, 1.0)).y;
  float at = elevation > 0.0 ? 0.5 + 0.5 * sqrt(elevation) : 0.5 + 0.5 * max(elevation / 0.08, -1.0);
  return textureLod(sky, vec2((at * ${kSkyTexels - 1}.0 + 0.5) / ${kSkyTexels}.0, 0.5), 0.0);
}
`;

/** As rilievo/scene/scene.h has it. */
export const kDefaultSky: SkyEntry = {
  zenith: [0.25, 0.45, 0.85], horizon: [0.75, 0.82, 0.9], ground: [0.2, 0.19, 0.17],
};

/** RGBA of a sky: half of it below the horizon, as far as that changes, half by the root of the elevation. */
export function skyTexels(of: SkyEntry): Uint8ClampedArray {
  const texels = new Uint8ClampedArray(4 * kSkyTexels);
  for (let i = 0; i < kSkyTexels; ++i) {
    const at = (2 * i) / (kSkyTexels - 1) - 1, above = Math.max(0, at), below = Math.max(0, -at);
    const ground = below * below * (3 - 2 * below);
    for (let c = 0; c < 3; ++c) {
      const sky = of.horizon[c] * (1 - above) + of.zenith[c] * above;
      const linear = sky * (1 - ground) + of.ground[c] * ground;
      // Below 0.003 this is 2 of 255 too dark, at most.
      texels[4 * i + c] = 255 * (1.055 * linear ** (1 / 2.4) - 0.055);
    }
    texels[4 * i + 3] = 255;
  }
  return texels;
}

function mergeFragment(layers: number, sky: boolean): string {
  return `#version 300 es
precision highp float;
precision highp int;
${mergeFunction(layers)}${sky ? kSkyColor : ""}
uniform vec4 projection;  // elements [2][2], [3][2], [2][3], [3][3] of the clip matrix
uniform ivec2 corner;     // of the viewport
layout(location = 0) out vec4 out_color;
void main() {
  vec3 color;
  float eye_z;
  bool shows = merge_nodes(ivec2(gl_FragCoord.xy) - corner, color, eye_z);
  out_color = vec4(color, 1.0);
  // What lies beyond the far plane, as the sky, is drawn just before it, so that a sky drawn later
  // fills only the gaps.
  float z = (projection.y - projection.x * eye_z) / (projection.w - projection.z * eye_z);
  gl_FragDepth = shows ? min(0.5 * z + 0.5, 1.0 - exp2(-23.0)) : 1.0;
${sky ? "  if (!shows) out_color = sky_color();" : "  if (!shows) discard;"}
}
`;
}

function withDefines(source: string, defines: readonly string[]): string {
  const end = source.indexOf("\n") + 1;
  return source.slice(0, end) + defines.map((d) => `#define ${d} 1\n`).join("") + source.slice(end);
}

/** Begun; NodeDrawer checks it. */
export function nodeProgram(gl: WebGL2RenderingContext, ...defines: string[]): WebGLProgram {
  return beginProgram(gl, "node", withDefines(kVertex, defines), withDefines(kFragment, defines));
}

/** With a sky it is drawn where no node shows anything. */
export function mergeProgram(gl: WebGL2RenderingContext, layers: number, sky: boolean):
    WebGLProgram {
  return compile(gl, "merge", kScreenVertex, mergeFragment(layers, sky));
}

const kShowObjects = `#version 300 es
precision highp float;
precision highp usampler2D;
uniform usampler2D objects;
layout(location = 0) out vec4 out_color;
void main() {
  uint id = texelFetch(objects, ivec2(gl_FragCoord.xy), 0).r;
  out_color = vec4(float(id & 255u), float(id >> 8u), 0.0, 255.0) / 255.0;
}
`;

export function showObjectsProgram(gl: WebGL2RenderingContext): WebGLProgram {
  return compile(gl, "objects", kScreenVertex, kShowObjects);
}

const kSky = `#version 300 es
precision highp float;
${kSkyColor}
layout(location = 0) out vec4 out_color;
void main() { out_color = sky_color(); }
`;

export function skyProgram(gl: WebGL2RenderingContext): WebGLProgram {
  // On the far plane.
  return compile(gl, "sky", kScreenVertex.replace("0.0,\n", "1.0,\n"), kSky);
}
