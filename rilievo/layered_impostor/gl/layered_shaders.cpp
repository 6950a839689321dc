// The march is that of layered_impostor/software/march_rays.cpp: there are the rules and their
// reasons.
#include "rilievo/layered_impostor/gl/layered_shaders.h"

#include <string>

#include "rilievo/render/opengl/outline_shader.h"
#include "rilievo/render/opengl/scene_shaders.h"
#include "rilievo/warp/surface_pyramid.h"

namespace rilievo::shader {
namespace {

const char* const kVersion = "#version 450\n";

const char* const kViews = R"(
struct View { vec4 u_row, v_row, w_row, apex, base, du, dv, depths; };
#ifdef VIEWS
layout(std140, binding = 0) uniform Views { View views[VIEWS]; };
#else
layout(std430, binding = 0) readonly buffer Views { View views[]; };
#endif
)";

const char* const kOutput = R"(
layout(binding = 0) uniform sampler2DArray color_texture;
#ifdef OBJECT_IDS
layout(binding = 5) uniform usampler2DArray object_texture;
layout(location = 1) uniform bool several_objects;
layout(location = 0) out uint out_object;
#else
layout(location = 0) out vec4 out_color;
#endif
)";

const char* const kInstance = R"(
struct Instance { mat4 clip_from_local; vec4 box_min, box_max, weights[3]; ivec4 views; };
layout(std140, binding = 1) uniform Instances { Instance instances[INSTANCES]; };
)";

// A box as one strip of 14 corners; what is seen from inside, its back faces, is drawn, so that the
// eye may be in it.
const char* const kSurfaceVertex = R"(
out vec3 v_ray;  // to the box's back, from the eye
flat out int v_instance;
void main() {
  int i = gl_InstanceID;
  const int kStrip[14] = int[](6, 7, 4, 5, 1, 7, 3, 6, 2, 4, 0, 1, 2, 3);
  int c = kStrip[gl_VertexID];
  v_ray = mix(instances[i].box_min.xyz, instances[i].box_max.xyz, vec3(c >> 2, c >> 1 & 1, c & 1));
  v_instance = i;
  gl_Position = instances[i].clip_from_local * vec4(v_ray, 1.0);
}
)";

const char* const kWalk = R"(
in vec3 v_ray;
flat in int v_instance;
// Of texels that show nothing 0 or less: silhouette_band().
layout(binding = 1) uniform sampler2DArray q_texture;
layout(binding = 2) uniform usampler2DArray slope_texture;  // halves, two by two
layout(binding = 3) uniform usampler2DArray links_texture;
// Levels side by side: the nearest q times sigma; the farthest q, negative if there are holes.
layout(binding = 4) uniform sampler2DArray cell_texture;
layout(location = 2) uniform int level_at[LEVELS];  // columns

// s: along the segment, of the hit; without one, of the edge passed last. The texel likewise.
// behind_from, behind_to: along it, where it passed behind an edge first, and came out last; 1 if it
// did not. beside: passed beside a silhouette, not far in front of it.
struct March {
  bool hit, behind, outline, beside;
  float s, behind_from, behind_to;
  ivec2 texel;
};

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
  if (q <= 0.0) return 1.0;
  vec2 d = p.xy - (vec2(texel) + 0.5);
  vec2 s = mix(slope.zw, slope.xy, greaterThanEqual(d, vec2(0.0)));
  return sigma * (p.z - q - dot(abs(d), s));
}

// Of the border of [low, low + side) in front, on either axis.
vec2 exits(ivec2 low, int side, vec2 from, vec2 inverse, vec2 ahead) {
  return (vec2(low) + ahead * float(side) - from) * inverse;
}

// Texels a pixel: `pixel` is its width, at `along` on the ray.
float texels_per_pixel(View view, vec3 along, mat2x3 pixel) {
  // (u w, v w, w)
  vec3 at = vec3(dot(view.u_row, vec4(along, 1.0)), dot(view.v_row, vec4(along, 1.0)),
                 dot(view.w_row, vec4(along, 1.0)));
  float most = 0.0;
  for (int i = 0; i < 2; ++i) {
    float w = dot(view.w_row.xyz, pixel[i]);
    vec2 step = vec2(dot(view.u_row.xyz, pixel[i]), dot(view.v_row.xyz, pixel[i]));
    step = abs(step - at.xy / at.z * w) / at.z;
    most = max(most, max(step.x, step.y));
  }
  return most;
}

// `wide`: the level of cells of which four or fewer pixels are as wide as one; -1: none are.
March march_view(View view, vec3 from, vec3 to, int wide) {
  March march = March(false, false, false, false, 0.0, 0.0, 0.0, ivec2(0));
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
      } else {
        march.beside = march.beside || level <= wide;
        near = level == 0;
        level = max(level - 1, 0);
      }
    } while (!near && !done);
    if (done) break;
    // Its texels, up to an edge, or to where the surface is met.
    ivec2 block = texel >> BLOCK_BITS;
    bool edge = false;
    do {
      float q = texelFetch(q_texture, ivec3(texel, layer), 0).r;
      vec4 slope = slope_of(ivec3(texel, layer));
      enters = side_of(sigma, from + delta * t, texel, q, slope);
      edge = before > 0.0 && enters <= 0.0;
      vec2 ends = exits(texel, 1, from.xy, inverse, ahead);
      leave = min(min(ends.x, ends.y), 1.0);
      float leaves = side_of(sigma, from + delta * leave, texel, q, slope);
      vec2 z = sigma * (from.z + delta.z * vec2(t, leave));
      march.beside = march.beside || (q < 0.0 && min(z.x, z.y) <= -sigma * q);
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
      bool hole = moved == ivec2(0) || texelFetch(q_texture, beyond, 0).r <= 0.0;
      bool linked = !hole && (texelFetch(links_texture, beyond, 0).r >> link & 1u) != 0u;
      if (linked) {  // and they nearly meet: patch_gap()
        float q = texelFetch(q_texture, beyond, 0).r;
        float ahead = side_of(sigma, from + delta * t, beyond.xy, q, slope_of(beyond));
        linked = ahead - enters <= PATCH_GAP * q * min(length(view.du.xyz), length(view.dv.xyz));
      }
      march.hit = linked, march.s = t, march.texel = linked ? texel : beyond.xy;
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
    float q = texelFetch(q_texture, ivec3(texel, layer), 0).r;
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
)";

const char* const kSurfaceFragment = R"(
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
  wx -= wxy, wy -= wxy;
  vec4 sum = (1.0 - wx - wy - wxy) * texelFetch(color_texture, ivec3(march.texel, layer), 0);
  if (wx > 0.0) sum += wx * texelFetch(color_texture, ivec3(march.texel + ivec2(s.x, 0), layer), 0);
  if (wy > 0.0) sum += wy * texelFetch(color_texture, ivec3(march.texel + ivec2(0, s.y), layer), 0);
  if (wxy > 0.0) sum += wxy * texelFetch(color_texture, ivec3(march.texel + s, layer), 0);
  return sum;
}

float looks_along(vec4 apex, vec3 middle) {
  return apex.w * dot(normalize(middle - apex.xyz), middle);
}
// Of the views without weight that are not done the one that looks along the ray through `middle`;
// -1 if none does so as much as `least`.
int view_along(ivec4 list, vec3 middle, uint done, float least) {
  int best = -1;
  for (int k = list.z; k < list.y; ++k) {
    if ((done >> k & 1u) != 0u) continue;
    float along = looks_along(views[list.x + k].apex, middle);
    if (along > least || (along == least && best < 0)) best = k, least = along;
  }
  return best;
}

// Where the ray is at s of the stretch, whose ends are from and to: t is linear in s where it is
// divided by eye_z, as 1 is.
float ray_at(vec2 stretch, float from_q, float to_q, float s) {
  return mix(stretch.x * from_q, stretch.y * to_q, s) / mix(from_q, to_q, s);
}

// What a ray shows. Its colour is premultiplied, its alpha is coverage; depth above 1: nothing.
// whole: no silhouette passes beside what is shown. beside: the ray passes beside one.
struct Shown { vec4 color; float depth; uint object; bool whole, beside; };

// The rules are those of warp_surfaces(). first_decides: of the views that know it the best one alone
// is asked. pixel: its width and height, at the ray's end.
Shown look(vec3 ray, mat2x3 pixel, bool first_decides) {
  int instance = v_instance;
  mat4 clip_from_local = instances[instance].clip_from_local;
  vec2 clip_zw = (clip_from_local * vec4(ray, 0.0)).zw, clip_zw_eye = clip_from_local[3].zw;
  ivec4 list = instances[instance].views;
  vec3 a = instances[instance].box_min.xyz / ray, b = instances[instance].box_max.xyz / ray;
  vec3 lo = min(a, b), hi = max(a, b);
  // A sample's ray may pass beside the box.
  vec2 t = vec2(max(max(max(lo.x, lo.y), lo.z), 1e-6), min(min(min(hi.x, hi.y), hi.z), 1.0));

  Shown shown = Shown(vec4(0.0), 2.0, 0u, true, false);
  vec4 blended = vec4(0.0), doubtful_color = vec4(0.0);
  float surface = 0.0, nothing = 0.0, heaviest = 0.0;
  float depth = 2.0, doubtful_depth = 2.0;
  uint object = 0u, doubtful_object = 0u;
  bool skin = false, sees_through = false, doubtful_whole = true;
  int inside = 0;
  // What a view that is not certain says after its last edge, and how far others see.
  float beyond_from = 2.0, free_to = 0.0, beyond_depth = 2.0, known_along = -1e30;
  vec4 beyond_color = vec4(0.0);
  uint beyond_object = 0u;
  bool beyond_whole = true;
  if (t.x >= t.y) {
    shown.beside = true;  // of the box, and with it perhaps of what touches its faces
    return shown;
  }
  int asked = int(instances[instance].box_min.w);
  uint done = 0u;
  vec3 middle = 0.5 * (t.x + t.y) * ray;
  for (int i = 0; i < asked; ++i) {
    bool weighted = i < list.z;
    if ((!weighted || first_decides) && surface + nothing >= 0.999 * SURE) break;
    int chosen = i;
    if (!weighted) {
      if (beyond_from <= free_to) break;
      chosen = view_along(list, middle, done, known_along);
      if (chosen < 0) break;
    }
    float weight = weighted ? instances[instance].weights[i >> 2][i & 3] : SURE - surface - nothing;
    done |= 1u << chosen;
    View view = views[list.x + chosen];
    vec3 from, to;
    vec2 stretch = t;
    March march = March(false, false, false, false, 0.0, 0.0, 0.0, ivec2(0));
    if (frustum_segment(view, ray, stretch, from, to)) {
      float along = 0.5 * (stretch.x + stretch.y);
      float texels = texels_per_pixel(view, along * ray, along * pixel);
      march = march_view(view, from, to, texels < 1.0 ? -1 : texels < 4.0 ? 0 : 1);
    }
    shown.beside = shown.beside || march.beside;
    bool empty = !march.hit && view.depths.z > 0.0, nearer = false;
    if (march.behind) {
      free_to = max(free_to, ray_at(stretch, from.z, to.z, march.behind_from));
      float out_at = march.behind_to < 1.0 ? ray_at(stretch, from.z, to.z, march.behind_to) : 2.0;
      nearer = (march.hit || empty) && out_at < beyond_from;
      if (nearer) beyond_from = out_at, beyond_depth = 2.0;
    } else if (weighted && (march.hit || empty)) {
      known_along = max(known_along, looks_along(view.apex, middle));
    }
    if (!march.hit) {
      if (!march.behind) {
        nothing += weight * view.depths.z;
        sees_through = sees_through || view.depths.w > 0.0;
      }
      if (march.behind) inside += march.outline ? -1 : 1;
      if (!march.behind || march.outline) continue;
      if (doubtful_depth < 2.0 || skin) continue;
    }
    int layer = int(view.base.w);
    vec2 clip = ray_at(stretch, from.z, to.z, march.s) * clip_zw + clip_zw_eye;
    float z = 0.5 * clip.x / clip.y + 0.5;
    vec4 c = vec4(1.0);
    uint o = 0u;
#ifdef OBJECT_IDS
    o = several_objects ? texelFetch(object_texture, ivec3(march.texel, layer), 0).r : uint(list.w);
#else
    c = color_at(layer, march, mix(from.xy, to.xy, march.s));
#endif
    bool linked = texelFetch(links_texture, ivec3(march.texel, layer), 0).r == 255u;
    if (!march.hit || skin || z < doubtful_depth) {
      doubtful_depth = z, doubtful_color = c, doubtful_object = o, doubtful_whole = linked;
      skin = !march.hit;
    }
    if (nearer && march.hit)
      beyond_depth = z, beyond_color = c, beyond_object = o, beyond_whole = linked;
    if (!march.hit || march.behind) continue;
    surface += weight;
    blended += weight * c;
    shown.whole = shown.whole && linked;
    if (weight > heaviest) heaviest = weight, depth = z, object = o;
  }
  if (surface + nothing < 0.999 * SURE && beyond_from <= free_to) {
    float weight = SURE - surface - nothing;
    if (beyond_depth > 1.0) nothing += weight;
    else {
      surface += weight;
      blended += weight * beyond_color;
      shown.whole = shown.whole && beyond_whole;
      if (weight > heaviest) depth = beyond_depth, object = beyond_object;
    }
  }
  if (skin && (inside <= 0 || asked == 1)) doubtful_depth = 2.0;
  if (nothing > surface || (surface == 0.0 && sees_through)) return shown;
  if (surface > 0.0)
    shown.depth = depth, shown.object = object, shown.color = blended / (surface + nothing);
  else
    shown.depth = doubtful_depth, shown.object = doubtful_object, shown.color = doubtful_color,
    shown.whole = doubtful_whole;
  return shown;
}

void main() {
  // Across the ray: the box's faces are slanted.
  mat2x3 pixel = mat2x3(dFdx(v_ray), dFdy(v_ray));
  for (int i = 0; i < 2; ++i) pixel[i] -= dot(pixel[i], v_ray) / dot(v_ray, v_ray) * v_ray;
  Shown shown = look(v_ray, pixel, false);
#ifdef OBJECT_IDS
  if (shown.depth > 1.0) discard;
  out_object = shown.object;
#else
  // All samples show what the centre shows. Along silhouettes, as
  // layered_impostor/software/layered_tiles.cpp: a silhouette may pass beside the texel that is
  // shown, or beside the ray, or passes between this pixel and one that is drawn along with it.
  bool some = shown.depth <= 1.0, missed = !some;
  bool along = abs(dFdx(float(some))) + abs(dFdy(float(some))) > 0.0;
  vec4 color = shown.color / max(shown.color.a, 1e-3);
  int covered = some ? -1 : 0;  // however many samples the frame has
  if (gl_NumSamples == 4 && (along || (some ? !shown.whole : shown.beside))) {
    const vec2 kPlaces[4] = vec2[](vec2(-0.125, -0.375), vec2(0.375, -0.125), vec2(-0.375, 0.125),
                                   vec2(0.125, 0.375));
    vec4 at_samples[4];
    for (int s = 0; s < 4; ++s) {
      Shown at_sample = look(interpolateAtOffset(v_ray, kPlaces[s]), pixel, missed);
      bool met = at_sample.depth <= 1.0;
      at_samples[s] = met ? at_sample.color : vec4(0.0);
      along = along || !met;
      if (met && !some) shown.depth = at_sample.depth, some = true;
    }
    vec4 sum = vec4(0.0);
    covered = 0;
    for (int s = 0; s < 4; ++s) {
      if (along && int(4.0 * at_samples[s].a + 0.5) <= s) continue;
      covered |= 1 << s;
      sum += at_samples[s] / max(at_samples[s].a, 1e-3);
    }
    color = sum;
  }
  if (covered == 0) discard;
  gl_SampleMask[0] = covered;
  out_color = vec4(color.rgb / max(color.a, 1e-3), 1.0);
#endif
  gl_FragDepth = shown.depth;
}
)";

const char* const kSliceVertex = R"(
layout(location = 0) in vec4 rect;
layout(location = 1) in vec4 depths;
layout(location = 2) in vec4 share;
layout(location = 0) uniform mat4 clip_from_local;
out vec2 v_at;
flat out vec4 v_slice;  // front, back, layer
flat out vec2 v_share;
flat out uint v_object;
void main() {
  View view = views[int(share.z)];
  v_at = mix(rect.xy, rect.zw, vec2(gl_VertexID & 1, gl_VertexID >> 1));
  vec3 p = view.apex.xyz +
           depths.x * (view.base.xyz + v_at.x * view.du.xyz + v_at.y * view.dv.xyz);
  gl_Position = clip_from_local * vec4(p, 1.0);
  v_slice = vec4(depths.yz, view.base.w, 0.0);
  v_share = share.xy;
  v_object = floatBitsToUint(share.w);
}
)";

const char* const kSliceFragment = R"(
in vec2 v_at;
flat in vec4 v_slice;
flat in vec2 v_share;
flat in uint v_object;
layout(binding = 1) uniform sampler2DArray interval_texture;
void main() {
  ivec3 texel = ivec3(v_at, int(v_slice.z));
  vec2 interval = texelFetch(interval_texture, texel, 0).rg;
  if (interval.y < v_slice.x || interval.x >= v_slice.y) discard;
#ifdef SHARE
  float hash = pixel_hash();
  if (hash < v_share.x || hash >= v_share.y) discard;
#endif
#ifdef OBJECT_IDS
  out_object = several_objects ? texelFetch(object_texture, texel, 0).r : v_object;
#else
  vec4 color = texelFetch(color_texture, texel, 0);
  out_color = vec4(color.rgb / max(color.a, 1e-3), 1.0);
#endif
}
)";

// Edge i runs along axis i / 4, from the corner that has two bits of i across it.
const char* const kBoxVertex = R"(
layout(location = 0) uniform mat4 clip_from_local;
layout(location = 1) uniform vec3 box_min;
layout(location = 2) uniform vec3 box_max;
void main() {
  int edge = gl_VertexID >> 1, axis = edge >> 2;
  vec3 corner;
  corner[axis] = float(gl_VertexID & 1);
  corner[(axis + 1) % 3] = float(edge & 1);
  corner[(axis + 2) % 3] = float(edge >> 1 & 1);
  gl_Position = clip_from_local * vec4(mix(box_min, box_max, corner), 1.0);
}
)";

std::string defines(LayeredOutput output) {
  static_assert(SurfacePyramid::kBlock == 4 && SurfacePyramid::kFactor == 4);
  std::string text =
      "#define BLOCK 4\n#define BLOCK_BITS 2\n#define FACTOR_BITS 2\n#define SHARE 1\n";
  text += "#define SURE " + std::to_string(kSureWeight) + "\n";
  text += "#define PATCH_GAP " + std::to_string(kPatchGap) + "\n";
  text += "#define LEVELS " + std::to_string(SurfacePyramid::kLevels) + "\n";
  if (output == LayeredOutput::objects) text += "#define OBJECT_IDS 1\n";
  return text;
}

// Uniform blocks have sizes: so many are drawn at once. They are read much faster than storage.
std::string block_sizes() {
  return "#define INSTANCES " + std::to_string(kMaxInstances) + "\n#define VIEWS " +
         std::to_string(kMaxInstances * kMaxViewsAtHand) + "\n";
}

}  // namespace

Result<gl::Program> make_surface_program(LayeredOutput output) {
  const std::string head = kVersion;
  return gl::make_program("layered surfaces", head + kInstance + kSurfaceVertex,
                          head + kViews + kOutput + kInstance + kWalk + kSurfaceFragment,
                          defines(output) + block_sizes());
}

Result<gl::Program> make_slice_program(LayeredOutput output) {
  const std::string head = kVersion;
  return gl::make_program("layered slices", head + kViews + kSliceVertex,
                          head + kOutput + kPixelHash + kSliceFragment, defines(output));
}

Result<gl::Program> make_box_program() {
  return make_outline_program(std::string(kVersion) + kBoxVertex);
}

}  // namespace rilievo::shader
