// The shaders of rilievo/environment_nodes/gl/node_shaders.cpp in GLSL ES 3.00. A vertex lies at
// direction / disparity from the node and is sent homogeneous, so that the rasteriser's own
// division corrects texture coordinates and the sky lies at infinity (S3.3).

import { compile, kScreenVertex } from "./program.js";

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
out vec3 v_direction;
#ifdef UNMIXES
out float v_disparity;  // code
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
#else
  v_direction = place.xyz;
#endif
#ifdef UNMIXES
  v_disparity = disparity;
#endif
}
`;

// A direction's face and its place there, from -1 to 1, of OpenGL's cube maps.
const kFaceOf = `int face_of(vec3 d, out vec2 st) {
  vec3 a = abs(d);
  if (a.x >= a.y && a.x >= a.z) {
    st = vec2(d.x > 0.0 ? -d.z : d.z, -d.y) / a.x;
    return d.x > 0.0 ? 0 : 1;
  }
  if (a.y >= a.z) {
    st = vec2(d.x, d.y > 0.0 ? d.z : -d.z) / a.y;
    return d.y > 0.0 ? 2 : 3;
  }
  st = vec2(d.z > 0.0 ? d.x : -d.x, -d.y) / a.z;
  return d.z > 0.0 ? 4 : 5;
}
`;

// Beside silhouettes, where weights are 0, surfaces have the colours of those texels alone that lie
// about as deep as what is drawn, as kFragment of node_shaders.cpp says.
const kFragment = `#version 300 es
precision highp float;
precision highp int;
precision highp usampler2D;
in vec3 v_direction;
#ifdef SKIN
in float v_stretch;
uniform float widest_skin;  // pixels
#endif
uniform samplerCube faces;
#ifdef UNMIXES
in float v_disparity;
uniform usampler2D seen;  // SeenDrawer's (seen.ts)
uniform float unmix;      // tolerance; negative: all is mixed
float disparity_at(ivec2 texel) {
  uint code = texelFetch(seen, texel, 0).r;
  return code == 0u ? -1.0 : unpackHalf2x16(code - 1u).x;
}
vec4 texel_at(vec3 d) { return textureLod(faces, d, 0.0); }
vec3 surface_color(vec3 mixed) {
  vec3 a = abs(v_direction);
  float ahead = max(a.x, max(a.y, a.z));
  vec3 d = v_direction / ahead, s = vec3(1.0, 0.0, 0.0), t = vec3(0.0, -1.0, 0.0);
  int face = d.z > 0.0 ? 4 : 5;
  if (ahead == a.x) {
    face = d.x > 0.0 ? 0 : 1;
    s = vec3(0.0, 0.0, -d.x);
  } else if (ahead == a.y) {
    face = d.y > 0.0 ? 2 : 3;
    t = vec3(0.0, 0.0, d.y);
  } else {
    s.x = d.z;
  }
  // The four texels around, of which the first lies at low.
  int size = textureSize(faces, 0).x;
  vec2 at = (0.5 * vec2(dot(d, s), dot(d, t)) + 0.5) * float(size) - 0.5, low = floor(at);
  vec2 far = at - low, near = 1.0 - far;
  s *= 2.0 / float(size);
  t *= 2.0 / float(size);
  d -= far.x * s + far.y * t;
  vec4 c0 = texel_at(d), c1 = texel_at(d + s), c2 = texel_at(d + t), c3 = texel_at(d + s + t);
  if (min(min(c0.a, c1.a), min(c2.a, c3.a)) > 0.0) return mixed;
  ivec2 corner = ivec2(face % 3, face / 3) * size, last = ivec2(size - 1);
  ivec2 p = corner + clamp(ivec2(low), ivec2(0), last);
  ivec2 q = corner + clamp(ivec2(low) + 1, ivec2(0), last);
  float own = v_disparity / ahead;
  vec4 off = abs(vec4(disparity_at(p), disparity_at(ivec2(q.x, p.y)),
                      disparity_at(ivec2(p.x, q.y)), disparity_at(q)) - own);
  float least = min(min(off.x, off.y), min(off.z, off.w));
  vec4 weight = vec4(near.x, far.x, near.x, far.x) * vec4(near.y, near.y, far.y, far.y);
  weight = max(weight, 1e-3) * vec4(lessThanEqual(off, vec4(least + unmix * own)));
  return (weight.x * c0.rgb + weight.y * c1.rgb + weight.z * c2.rgb + weight.w * c3.rgb) /
         (weight.x + weight.y + weight.z + weight.w);
}
#endif
#ifdef OBJECT
uniform usampler2D objects;  // 3 x 2 faces
layout(location = 0) out uvec4 out_object;
${kFaceOf}
uint object_at(vec3 d) {
  vec2 st;
  int face = face_of(d, st);
  int size = textureSize(objects, 0).x / 3;
  ivec2 texel = clamp(ivec2(floor((0.5 * st + 0.5) * float(size))), ivec2(0), ivec2(size - 1));
  return texelFetch(objects, ivec2(face % 3, face / 3) * size + texel, 0).r;
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
  out_color = vec4(texture(faces, v_direction).rgb, 1.0 / 255.0);
#else
  // 0 is nothing, 1 a skin.
  vec4 color = texture(faces, v_direction);
#ifdef UNMIXES
  if (unmix >= 0.0 && color.a < 0.5) color.rgb = surface_color(color.rgb);
#endif
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
uniform mat4 node_from_eye[${layers}];
uniform vec4 node_rays;  // of a pixel's (x, y): at z = -1, xy + zw (x, y)
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
  if (farthest == 0.0) {
    vec4 skin = texelFetch(node_colors, ivec3(pixel, ${layers}), 0);
    color = skin.rgb;
    eye_z = layer_z(pixel, ${layers});
    return skin.a > 0.0;
  }
  if (farthest > nearest * (1.0 + 0.5 * node_merge.x)) {
    // Surfaces do not agree. Those of the first node, which sees the eye, are there.
    vec3 ray = vec3(node_rays.xy + node_rays.zw * (vec2(pixel) + 0.5), -1.0);
    float accepted = 1e38;
    if (c0.a > 0.0) accepted = d0;
${each(layers, (i) => i === 0 ? "" : `
    if (c${i}.a > 0.0) {
      // Nobody sees through the sky.
      if (d${i} < 1e12 * node_merge.y) {
        vec3 p = d${i} * ray;
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
  color = vec3(0.0);
  eye_z = nearest;
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
  color /= max(weights, 1e-20);
  return true;
}
`;
}

// node_share: 1 where the node sees what lies at p (eye space) or before it, 0 where it sees through
// p by the tolerance.
function shareFunction(node: number): string {
  return `
uniform highp usampler2D node_seen${node};
float node_share${node}(vec3 p) {
  vec3 seen = (node_from_eye[${node}] * vec4(p, 1.0)).xyz;
  vec2 st;
  int face = face_of(seen, st);
  int last = textureSize(node_seen${node}, 0).x / 3 - 1;
  ivec2 corner = ivec2(face % 3, face / 3) * (last + 1);
  ivec2 at = ivec2(floor((0.5 * st + 0.5) * float(last + 1) - 0.5));
  ivec2 a = corner + clamp(at, ivec2(0), ivec2(last)), b = corner + clamp(at + 1, ivec2(0), ivec2(last));
  uint code = max(max(texelFetch(node_seen${node}, a, 0).r, texelFetch(node_seen${node}, b, 0).r),
                  max(texelFetch(node_seen${node}, ivec2(a.x, b.y), 0).r,
                      texelFetch(node_seen${node}, ivec2(b.x, a.y), 0).r));
  // It says nothing.
  if (code == 0u) return 1.0;
  float nearest = unpackHalf2x16(code - 1u).x * node_steps[${node}];
  float ahead = max(max(abs(seen.x), abs(seen.y)), abs(seen.z));
  return clamp(2.0 - 2.0 * (1.0 / max(nearest * ahead, 1e-9) - 1.0) / node_merge.x, 0.0, 1.0);
}
`;
}

// The default sky of the library (rilievo/scene/scene.h), for what no node shows.
const kSkyColor = `
uniform mat3 world_from_pixel;  // the line of sight through a pixel's (x, y, 1)
vec4 sky_color() {
  float elevation = normalize(world_from_pixel * vec3(gl_FragCoord.xy, 1.0)).y;
  vec3 above = mix(vec3(0.75, 0.82, 0.90), vec3(0.25, 0.45, 0.85), sqrt(clamp(elevation, 0.0, 1.0)));
  vec3 linear = mix(above, vec3(0.20, 0.19, 0.17), smoothstep(0.0, 1.0, -elevation / 0.08));
  return vec4(mix(1.055 * pow(linear, vec3(1.0 / 2.4)) - 0.055, 12.92 * linear,
                  vec3(lessThanEqual(linear, vec3(0.0031308)))), 1.0);
}
`;

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
  if (!merge_nodes(ivec2(gl_FragCoord.xy) - corner, color, eye_z)) {
${sky ? "    out_color = sky_color();\n    gl_FragDepth = 1.0;\n    return;" : "    discard;"}
  }
  out_color = vec4(color, 1.0);
  // What lies beyond the far plane, as the sky, is drawn just before it, so that a sky drawn later
  // fills only the gaps.
  float z = (projection.y - projection.x * eye_z) / (projection.w - projection.z * eye_z);
  gl_FragDepth = min(0.5 * z + 0.5, 1.0 - exp2(-23.0));
}
`;
}

function withDefines(source: string, defines: readonly string[]): string {
  const end = source.indexOf("\n") + 1;
  return source.slice(0, end) + defines.map((d) => `#define ${d} 1\n`).join("") + source.slice(end);
}

export function nodeProgram(gl: WebGL2RenderingContext, ...defines: string[]): WebGLProgram {
  return compile(gl, "node", withDefines(kVertex, defines), withDefines(kFragment, defines));
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
