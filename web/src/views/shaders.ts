// The shaders of rilievo/layered_impostor/gl/layered_shaders.cpp in GLSL ES 3.00, for one impostor:
// the surfaces of its pictures are met by a march along each pixel's ray. What is drawn lies in a
// layer as gl/shaders.ts' nodes do, so that the same pass merges it into the frame.

import { kBlock, kFactor, kLevels } from "./surface.js";

/** The most pictures of which a pixel chooses those in which it looks up its surface: their number. */
export const kMostViews = 10;
export const kMostAsked = 6;
/** vec4s of a picture in `view_data`. */
export const kViewVectors = 8;

// A box as one strip of 14 corners; what is seen from inside, its back faces, is drawn, so that the
// eye may be in it.
export const kViewVertex = `#version 300 es
precision highp float;
uniform mat4 clip_from_local;
uniform vec3 box_min, box_max;  // relative to the eye
out vec3 v_ray;  // to the box's back, from the eye
void main() {
  const int kStrip[14] = int[](6, 7, 4, 5, 1, 7, 3, 6, 2, 4, 0, 1, 2, 3);
  int c = kStrip[gl_VertexID];
  v_ray = mix(box_min, box_max, vec3(c >> 2, c >> 1 & 1, c & 1));
  gl_Position = clip_from_local * vec4(v_ray, 1.0);
  // Depths are written: no far plane.
  gl_Position.z = 0.0;
}
`;

export const kViewFragment = `#version 300 es
precision highp float;
precision highp int;
precision highp sampler2DArray;
precision highp usampler2DArray;
#define BLOCK_BITS ${Math.log2(kBlock)}
#define FACTOR_BITS ${Math.log2(kFactor)}
#define BLOCK ${kBlock}
#define LEVELS ${kLevels}
#define PATCH_GAP 0.25
#define SURE 0.25
in vec3 v_ray;
uniform vec3 box_min, box_max;
uniform vec4 view_data[${kMostViews * kViewVectors}];
uniform float view_weights[${kMostViews}];
// 1 or 0: an empty texel means that nothing is there; it may see through what is there.
uniform vec2 view_says[${kMostViews}];
uniform ivec2 view_counts;   // all, and those that have weight
uniform vec4 forward_near;   // the frame's; near plane of the layers
uniform int level_at[LEVELS];  // columns
uniform sampler2DArray color_texture;   // sRGB, premultiplied
uniform usampler2DArray code_texture;
uniform usampler2DArray slope_texture;  // halves, two by two
uniform usampler2DArray links_texture;
// Levels side by side: the nearest q times sigma; the farthest q, negative if there are holes.
uniform sampler2DArray cell_texture;
layout(location = 0) out vec4 out_color;

struct View { vec4 u_row, v_row, w_row, apex, base, du, dv, depths; };
View view_at(int i) {
  int k = ${kViewVectors} * i;
  return View(view_data[k], view_data[k + 1], view_data[k + 2], view_data[k + 3], view_data[k + 4],
              view_data[k + 5], view_data[k + 6], view_data[k + 7]);
}
// s: along the segment, of the hit; without one, of the edge passed last. The texel likewise.
// behind_from, behind_to: along it, where it passed behind an edge first, and came out last; 1 if it
// did not.
struct March { bool hit, behind, outline; float s, behind_from, behind_to; ivec2 texel; };

// depths: z_near, z_far, least, step; 0 is nothing.
float q_of(vec4 depths, ivec3 texel) {
  uint code = texelFetch(code_texture, texel, 0).r;
  return code == 0u ? 0.0 : depths.z + float(code - 1u) * depths.w;
}

// The stretch of the ray, t in [t.x, t.y], that lies in the view's frustum, as (u, v, q); narrows t.
bool frustum_segment(View view, vec3 ray, inout vec2 t, out vec3 from, out vec3 to) {
  vec3 c = vec3(view.u_row.w, view.v_row.w, view.w_row.w);
  vec3 d = vec3(dot(view.u_row.xyz, ray), dot(view.v_row.xyz, ray), dot(view.w_row.xyz, ray));
  vec3 p = c + t.x * d, q = c + t.y * d;
  vec2 size = vec2(view.du.w, view.dv.w);
  float at_p[6] = float[](p.z - view.depths.x, view.depths.y - p.z, p.x, p.y,
                          size.x * p.z - p.x, size.y * p.z - p.y);
  float at_q[6] = float[](q.z - view.depths.x, view.depths.y - q.z, q.x, q.y,
                          size.x * q.z - q.x, size.y * q.z - q.y);
  float begin = 0.0, end = 1.0;
  for (int i = 0; i < 6; ++i) {
    if (at_p[i] < 0.0 && at_q[i] < 0.0) end = -1.0;
    float s = at_p[i] / (at_p[i] - at_q[i]);
    if (at_p[i] < 0.0) begin = max(begin, s);
    else if (at_q[i] < 0.0) end = min(end, s);
  }
  t = mix(t.xx, t.yy, vec2(begin, end));
  vec3 a = mix(p, q, begin), b = mix(p, q, end);
  from = vec3(a.xy, 1.0) / a.z;
  to = vec3(b.xy, 1.0) / b.z;
  return begin < end;
}

vec4 slope_of(ivec3 texel) {
  uvec2 halves = texelFetch(slope_texture, texel, 0).rg;
  return vec4(unpackHalf2x16(halves.x), unpackHalf2x16(halves.y));
}

// > 0 in front of the piece of surface over the texel.
float side_of(float sigma, vec3 p, ivec2 texel, float q, vec4 slope) {
  if (q == 0.0) return 1.0;
  vec2 d = p.xy - (vec2(texel) + 0.5);
  vec2 s = mix(slope.zw, slope.xy, greaterThanEqual(d, vec2(0.0)));
  return sigma * (p.z - q - dot(abs(d), s));
}

// Of the border of [low, low + side) in front, on either axis.
vec2 exits(ivec2 low, int side, vec2 from, vec2 inverse, vec2 ahead) {
  return (vec2(low) + ahead * float(side) - from) * inverse;
}

March march_view(View view, vec3 from, vec3 to) {
  March march = March(false, false, false, 0.0, 0.0, 0.0, ivec2(0));
  float sigma = view.apex.w;
  int layer = int(view.base.w);
  ivec2 size = ivec2(view.du.w, view.dv.w);
  vec3 delta = to - from;
  vec2 inverse = 1.0 / mix(delta.xy, vec2(1e-12), lessThan(abs(delta.xy), vec2(1e-12)));
  vec2 ahead = step(vec2(0.0), inverse);
  ivec2 forward = ivec2(ahead) * 2 - 1;
  ivec2 texel = clamp(ivec2(floor(from.xy)), ivec2(0), size - 1), moved = ivec2(0);
  float t = 0.0, before = 1.0;  // the side that the last texel was left on
  float leave = 0.0, enters = 0.0;
  int level = LEVELS - 1;
  bool done = false;
  int steps = 0;
  do {
    // Cells, down to one of the finest level that cannot be stepped over.
    bool near = false;
    do {
      int side = BLOCK << (level * FACTOR_BITS);
      ivec2 at = texel >> (BLOCK_BITS + level * FACTOR_BITS), low = at * side;
      vec2 cell = texelFetch(cell_texture, ivec3(at.x + level_at[level], at.y, layer), 0).rg;
      vec2 ends = exits(low, side, from.xy, inverse, ahead);
      float end = min(min(ends.x, ends.y), 1.0);
      vec2 z = sigma * (from.z + delta.z * vec2(t, end));
      bool in_front = min(z.x, z.y) > cell.x;
      bool behind = before <= 0.0 && max(z.x, z.y) < sigma * abs(cell.y) &&
                    (cell.y > 0.0 || march.outline);
      if (in_front || behind) {
        bool across = ends.x <= ends.y;
        ivec2 inside = clamp(ivec2(floor(from.xy + delta.xy * end)), low, low + (side - 1));
        texel = across ? ivec2(low.x + (forward.x > 0 ? side : -1), inside.y)
                       : ivec2(inside.x, low.y + (forward.y > 0 ? side : -1));
        moved = across ? ivec2(forward.x, 0) : ivec2(0, forward.y);
        if (in_front && before <= 0.0) march.behind_to = t;
        t = end;
        before = in_front ? 1.0 : -1.0;
        done = end >= 1.0 || any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, size));
        // Into another cell of the coarser level: that may be stepped over as a whole.
        int coarser = BLOCK_BITS + (level + 1) * FACTOR_BITS;
        if (level + 1 < LEVELS && (texel >> coarser) != (low >> coarser)) ++level;
      } else if (level > 0) {
        --level;
      } else {
        near = true;
      }
    } while (!near && !done);
    if (done) break;
    // Its texels, up to an edge, or to where the surface is met.
    ivec2 block = texel >> BLOCK_BITS;
    bool edge = false;
    do {
      float q = q_of(view.depths, ivec3(texel, layer));
      vec4 slope = slope_of(ivec3(texel, layer));
      enters = side_of(sigma, from + delta * t, texel, q, slope);
      edge = before > 0.0 && enters <= 0.0;
      vec2 ends = exits(texel, 1, from.xy, inverse, ahead);
      leave = min(min(ends.x, ends.y), 1.0);
      float leaves = side_of(sigma, from + delta * leave, texel, q, slope);
      if (before <= 0.0 && max(enters, leaves) > 0.0) march.behind_to = enters > 0.0 ? t : leave;
      march.hit = enters > 0.0 && leaves <= 0.0;
      done = march.hit || (!edge && leave >= 1.0);
      if (!edge && !done) {
        moved = ends.x <= ends.y ? ivec2(forward.x, 0) : ivec2(0, forward.y);
        texel += moved;
        t = leave;
        before = leaves;
        done = any(lessThan(texel, ivec2(0))) || any(greaterThanEqual(texel, size));
      }
    } while (!done && !edge && (texel >> BLOCK_BITS) == block);
    if (edge) {
      // Is it the surface's end, or only where two linked pieces do not quite meet?
      ivec3 beyond = ivec3(texel - moved, layer);
      int link = moved.x != 0 ? (moved.x > 0 ? 0 : 4) : (moved.y > 0 ? 2 : 6);
      bool hole = moved == ivec2(0) || q_of(view.depths, beyond) == 0.0;
      bool linked = !hole && (texelFetch(links_texture, beyond, 0).r >> link & 1u) != 0u;
      if (linked) {  // and they nearly meet: patch_gap()
        float q = q_of(view.depths, beyond);
        float passed = side_of(sigma, from + delta * t, beyond.xy, q, slope_of(beyond));
        linked = passed - enters <= PATCH_GAP * q * min(length(view.du.xyz), length(view.dv.xyz));
      }
      march.hit = linked;
      march.s = t;
      march.texel = linked ? texel : beyond.xy;
      if (!march.behind) march.behind_from = t;
      march.behind = march.behind || !linked;
      march.outline = march.outline || hole;
      done = linked;
      leave = t;
      before = -1.0;
    }
    if ((texel >> (BLOCK_BITS + FACTOR_BITS)) != (block >> FACTOR_BITS)) level = min(1, LEVELS - 1);
    // Every round leaves a texel, or the surface's front; rounding must not make it endless.
  } while (!done && ++steps < 16384);
  if (!march.hit && before <= 0.0) march.behind_to = 1.0;
  // Between t (in front) and leave (not) the piece is met: a line against a plane in each of the
  // stretches between the texel's middle lines.
  if (march.hit && leave > t) {
    float q = q_of(view.depths, ivec3(texel, layer));
    vec4 slope = slope_of(ivec3(texel, layer));
    vec2 middle = clamp((vec2(texel) + 0.5 - from.xy) * inverse, t, leave);
    vec4 at = vec4(t, min(middle.x, middle.y), max(middle.x, middle.y), leave);
    vec4 s = vec4(enters, side_of(sigma, from + delta * at.y, texel, q, slope),
                  side_of(sigma, from + delta * at.z, texel, q, slope),
                  side_of(sigma, from + delta * at.w, texel, q, slope));
    vec4 piece = s.y <= 0.0 ? vec4(at.xy, s.xy)
                            : s.z <= 0.0 ? vec4(at.yz, s.yz) : vec4(at.zw, s.zw);
    march.s = piece.x + (piece.y - piece.x) * clamp(piece.z / (piece.z - piece.w), 0.0, 1.0);
    march.texel = texel;
  }
  return march;
}

// Between the texels that are linked to the one that was hit: sample_weights().
vec4 color_at(int layer, March march, vec2 at) {
  vec2 offset = at - (vec2(march.texel) + 0.5), f = min(abs(offset), 0.5);
  ivec2 s = ivec2(offset.x >= 0.0 ? 1 : -1, offset.y >= 0.0 ? 1 : -1);
  uint links = texelFetch(links_texture, ivec3(march.texel, layer), 0).r;
  int x = s.x > 0 ? 0 : 4, y = s.y > 0 ? 2 : 6;
  int xy = s.x > 0 ? (s.y > 0 ? 1 : 7) : (s.y > 0 ? 3 : 5);
  float wx = (links >> x & 1u) != 0u ? f.x : 0.0;
  float wy = (links >> y & 1u) != 0u ? f.y : 0.0;
  float wxy = (links >> xy & 1u) != 0u ? wx * wy : 0.0;
  wx -= wxy;
  wy -= wxy;
  vec4 sum = (1.0 - wx - wy - wxy) * texelFetch(color_texture, ivec3(march.texel, layer), 0);
  if (wx > 0.0) sum += wx * texelFetch(color_texture, ivec3(march.texel + ivec2(s.x, 0), layer), 0);
  if (wy > 0.0) sum += wy * texelFetch(color_texture, ivec3(march.texel + ivec2(0, s.y), layer), 0);
  if (wxy > 0.0) sum += wxy * texelFetch(color_texture, ivec3(march.texel + s, layer), 0);
  return sum;
}

float looks_along(vec4 apex, vec3 middle) {
  return apex.w * dot(normalize(middle - apex.xyz), middle);
}
// Of the views without weight that are not done the one that looks along the ray through 'middle';
// -1 if none does so as much as 'least'.
int view_along(vec3 middle, uint done, float least) {
  int best = -1;
  for (int k = view_counts.y; k < view_counts.x; ++k) {
    if ((done >> k & 1u) != 0u) continue;
    float along = looks_along(view_data[${kViewVectors} * k + 3], middle);
    if (along > least || (along == least && best < 0)) {
      best = k;
      least = along;
    }
  }
  return best;
}

// Where the ray is at s of the stretch, whose ends are from and to: t is linear in s where it is
// divided by eye_z, as 1 is.
float ray_at(vec2 stretch, float from_q, float to_q, float s) {
  return mix(stretch.x * from_q, stretch.y * to_q, s) / mix(from_q, to_q, s);
}

void main() {
  vec3 a = box_min / v_ray, b = box_max / v_ray;
  vec3 lo = min(a, b);
  vec2 t = vec2(max(max(max(lo.x, lo.y), lo.z), 1e-6), 1.0);
  float speed = dot(forward_near.xyz, v_ray);  // eye_z over the ray

  // The rules are those of warp_surfaces() (rilievo/layered_impostor/surface_warp.cpp).
  vec4 blended = vec4(0.0), doubtful_color = vec4(0.0);
  float surface = 0.0, nothing = 0.0, heaviest = 0.0;
  float depth = 1e38, doubtful_depth = 1e38;  // eye_z
  bool skin = false, sees_through = false;
  int inside = 0;
  // What a view that is not certain says after its last edge, and how far others see.
  float beyond_from = 2.0, free_to = 0.0, beyond_depth = 1e38, known_along = -1e30;
  vec4 beyond_color = vec4(0.0);
  uint done = 0u;
  vec3 middle = 0.5 * (t.x + t.y) * v_ray;
  int asked = min(view_counts.x, ${kMostAsked});
  for (int i = 0; i < asked; ++i) {
    bool weighty = i < view_counts.y;
    int chosen = i;
    if (!weighty) {
      if (surface + nothing >= 0.999 * SURE || beyond_from <= free_to) break;
      chosen = view_along(middle, done, known_along);
      if (chosen < 0) break;
    }
    float weight = weighty ? view_weights[i] : SURE - surface - nothing;
    done |= 1u << chosen;
    View view = view_at(chosen);
    vec2 says = view_says[chosen];
    vec3 from, to;
    vec2 stretch = t;
    March march = March(false, false, false, 0.0, 0.0, 0.0, ivec2(0));
    if (frustum_segment(view, v_ray, stretch, from, to)) march = march_view(view, from, to);
    bool empty = !march.hit && says.x > 0.0, nearer = false;
    if (march.behind) {
      free_to = max(free_to, ray_at(stretch, from.z, to.z, march.behind_from));
      float out_at = march.behind_to < 1.0 ? ray_at(stretch, from.z, to.z, march.behind_to) : 2.0;
      nearer = (march.hit || empty) && out_at < beyond_from;
      if (nearer) {
        beyond_from = out_at;
        beyond_depth = 1e38;
      }
    } else if (weighty && (march.hit || empty)) {
      known_along = max(known_along, looks_along(view.apex, middle));
    }
    if (!march.hit) {
      if (!march.behind) {
        nothing += weight * says.x;
        sees_through = sees_through || says.y > 0.0;
      }
      if (march.behind) inside += march.outline ? -1 : 1;
      if (!march.behind || march.outline) continue;
      if (doubtful_depth < 1e37 || skin) continue;
    }
    int layer = int(view.base.w);
    float z = ray_at(stretch, from.z, to.z, march.s) * speed;
    vec4 c = color_at(layer, march, mix(from.xy, to.xy, march.s));
    if (!march.hit || skin || z < doubtful_depth) {
      doubtful_depth = z;
      doubtful_color = c;
      skin = !march.hit;
    }
    if (nearer && march.hit) {
      beyond_depth = z;
      beyond_color = c;
    }
    if (!march.hit || march.behind) continue;
    surface += weight;
    blended += weight * c;
    if (weight > heaviest) {
      heaviest = weight;
      depth = z;
    }
  }
  if (surface + nothing < 0.999 * SURE && beyond_from <= free_to) {
    float weight = SURE - surface - nothing;
    if (beyond_depth > 1e37) {
      nothing += weight;
    } else {
      surface += weight;
      blended += weight * beyond_color;
      if (weight > heaviest) depth = beyond_depth;
    }
  }
  if (skin && (inside <= 0 || view_counts.x == 1)) doubtful_depth = 1e38;
  if (nothing > surface || (surface == 0.0 && sees_through)) discard;
  if (surface == 0.0) {
    depth = doubtful_depth;
    blended = doubtful_color;
    surface = 1.0;
  }
  if (depth > 1e37) discard;
  gl_FragDepth = clamp(1.0 - forward_near.w / depth, 0.0, 1.0);
  blended /= surface;
  out_color = vec4(blended.rgb / max(blended.a, 1e-3), 1.0);
}
`;
