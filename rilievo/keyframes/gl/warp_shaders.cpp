#include "rilievo/keyframes/gl/warp_shaders.h"

#include <charconv>
#include <iterator>
#include <string>

#include "rilievo/keyframes/warp_sources.h"

namespace rilievo::shader {
namespace {

// What all passes know of keyframes. Rows of a map are x, y, 1 and w.
const char* const kKeyframes = R"(#version 450
struct Source {
  vec4 to_x, to_y, to_z, from_x, from_y, from_z;
  float weight, pixels_per_texel, largest_square;
  int width, height, finer, spare, unused;
};
layout(std140, binding = SOURCE_BLOCK) uniform Sources { Source sources[MOST_WARPED]; };
layout(binding = COLOR_UNIT) uniform usampler2D colors[MOST_WARPED];
layout(binding = DEPTH_UNIT) uniform sampler2D inverse_z[MOST_WARPED];  // negative: hidden
float along(vec4 row, vec2 p, float w) {
  return (row.x * p.x + (row.y * p.y + row.z)) + row.w * w;
}
float depth_of(int k, ivec2 texel) { return texelFetch(inverse_z[k], texel, 0).r; }
)";

// The nearest square stays, as by processors: numbers above 0 compare as their bits do. Rows -1 and
// `height` count as neighbours of the frame's.
const char* const kSplat = R"(
layout(local_size_x = SPLAT_GROUP) in;
layout(std430, binding = DEPTH_BLOCK) restrict buffer Depths { uint depths[]; };
layout(location = 0) uniform int k;
layout(location = 1) uniform ivec2 size;
layout(location = 2) uniform float near;  // 1 / z_near
void raise(int x, int y, float w) {
  int at = (y + 1) * size.x + x;
  uint bits = floatBitsToUint(w);
  if (depths[at] < bits) atomicMax(depths[at], bits);
}
// In pixels from the first one's centre; z and 1 / eye_z in the frame.
vec4 place(vec2 p, float w) {
  float z = along(sources[k].to_z, p, w);
  float per_z = 1.0 / max(z, 1e-6);
  vec2 q = vec2(along(sources[k].to_x, p, w), along(sources[k].to_y, p, w)) * per_z - 0.5;
  return vec4(q, z, w * per_z);
}
float farther(vec4 a, vec4 b) { return max(abs(a.x - b.x), abs(a.y - b.y)); }
// The crack to a neighbour of the same surface.
void close_crack(ivec2 neighbour, float w, vec4 from, float half_side) {
  if (neighbour.x >= sources[k].width || neighbour.y >= sources[k].height) return;
  float depth = depth_of(k, neighbour);
  float deeper = abs(depth - w);
  if (!(depth > 0.0) || !(deeper > LEAST_SLANT * w) || !(deeper <= SAME_SURFACE * w)) return;
  vec4 to = place(vec2(neighbour) + 0.5, depth);
  float apart = farther(from, to);
  if (!(to.z > 1e-6) || !(to.w <= near)) return;
  if (!(apart > half_side + half_side) || !(apart <= WIDEST_CRACK)) return;
  vec2 step = to.xy - from.xy;
  bool across = abs(step.x) >= abs(step.y);
  // Along the axis on which it goes farther, and beside it.
  vec2 begin = across ? from.xy : from.yx, by = across ? step : step.yx;
  ivec2 least = across ? ivec2(0, -1) : ivec2(-1, 0),
        most = across ? ivec2(size.x - 1, size.y) : ivec2(size.y, size.x - 1);
  int first = int(clamp(ceil(min(begin.x, begin.x + by.x)), float(least.x), float(most.x + 1))),
      last = int(clamp(floor(max(begin.x, begin.x + by.x)), float(least.x - 1), float(most.x)));
  for (int i = first; i <= last; ++i) {
    float way = clamp((float(i) - begin.x) / by.x, 0.0, 1.0);
    float middle = begin.y + way * by.y, w_there = from.w + way * (to.w - from.w);
    int low = int(clamp(ceil(middle - half_side), float(least.y), float(most.y + 1))),
        high = int(clamp(floor(middle + half_side), float(least.y - 1), float(most.y)));
    for (int j = low; j <= high; ++j) {
      if (across) raise(i, j, w_there); else raise(j, i, w_there);
    }
  }
}
void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  if (texel.x >= sources[k].width) return;
  float w = depth_of(k, texel);
  if (!(w > 0.0)) return;
  vec2 p = vec2(texel) + 0.5;
  vec4 q = place(p, w);
  if (!(q.z > 1e-6) || !(q.w <= near)) return;
  float magnified =
      min(max(1.0 / q.z * sources[k].pixels_per_texel, 1.0), sources[k].largest_square);
  float half_side = HALF_SQUARE * magnified;
  if (farther(q, place(p, 0.0)) > CRACK_PARALLAX) {
    close_crack(texel + ivec2(1, 0), w, q, half_side);
    close_crack(texel + ivec2(0, 1), w, q, half_side);
  }
  // Far outside, whole numbers do not suffice.
  ivec2 first = ivec2(clamp(ceil(q.xy - half_side), vec2(0.0, -1.0), vec2(size) + 1.0)),
        last = ivec2(clamp(floor(q.xy + half_side), vec2(-2.0), vec2(size.x - 1, size.y)));
  for (int y = first.y; y <= last.y; ++y)
    for (int x = first.x; x <= last.x; ++x) raise(x, y, q.w);
}
)";

const char* const kWholeFrame = R"(#version 450
void main() {
  gl_Position = vec4(float((gl_VertexID & 1) * 4) - 1.0, float((gl_VertexID >> 1) * 4) - 1.0, 0.0,
                     1.0);
}
)";

// As warp_rows.cpp and warp_lookup.inl, pixel by pixel; these say why.
const char* const kLookup = R"(
layout(std430, binding = DEPTH_BLOCK) restrict readonly buffer Depths { uint depths[]; };
// By strip and SKY_COLUMNS columns: not 0 where the sky is plain.
layout(std430, binding = PIXEL_BLOCK) restrict readonly buffer PlainSky { uint plain_sky[]; };
layout(location = 0) uniform int count;
layout(location = 1) uniform ivec2 size;
layout(location = 2) uniform ivec3 same;     // a source whose texels are the pixels; -1: none; left, top
layout(location = 3) uniform bool leaves_sky;
layout(location = 4) uniform bool any_cover;
layout(location = 5) uniform vec2 planes;    // z_near, z_far
layout(location = 6) uniform float nearest_thing;
layout(location = 7) uniform int cover_samples;
layout(binding = COVER_UNIT) uniform sampler2DMS cover;  // window_z, the last row first
layout(location = 0) out uint out_color;
layout(location = 1) out float out_inverse_z;

struct Found {
  vec3 sum;
  float weight, cover, front, own;
  bool too_near;
};

Found find(vec2 p, float w, bool mixes) {
  Found found = Found(vec3(0.0), 0.0, 0.0, 0.0, 0.0, false);
  for (int k = 0; k < count; ++k) {
    Source source = sources[k];
    if (source.width < 2 || (source.spare != 0 && !(found.cover < float(ALL_SHOWN)))) continue;
    float z = along(source.from_z, p, w);
    float per_z = 1.0 / max(z, 1e-6);
    float scaled = per_z * float(1 << source.finer);
    vec2 q = vec2(along(source.from_x, p, w), along(source.from_y, p, w)) * scaled - 0.5;
    int columns = source.width << source.finer, rows = source.height << source.finer;
    if (!(z > 1e-6 && q.x >= 0.0 && q.y >= 0.0 && q.x < float(columns - 1) && q.y < float(rows - 1)))
      continue;
    if (z > MOST_MAGNIFIED) {
      found.too_near = true;
      continue;
    }
    float magnified = max(z * source.pixels_per_texel, 1.0);
    bool mixed = mixes && magnified < MOST_MIXED;
    vec2 a = q - floor(q);
    ivec2 at = ivec2(floor(q));
    float there = w * per_z, slack = SAME_SURFACE * there;
    float left = (1.0 - a.x) * float(TEXEL_WEIGHTS), right = a.x * float(TEXEL_WEIGHTS);
    uint shown = 0u, sure = 0u, known = 0u, front = 0u;
    uvec3 sum = uvec3(0u);
    for (int i = 0; i < 4; ++i) {
      ivec2 quarter = at + ivec2(i & 1, i >> 1);
      uint color = texelFetch(colors[k], quarter, 0).r;
      float depth = depth_of(k, quarter >> source.finer);
      uint all = uint(((i & 1) == 0 ? left : right) * ((i >> 1) == 0 ? 1.0 - a.y : a.y));
      uint shows = color >> 30, same_beside = color >> 27 & 7u, nearer_beside = color >> 24 & 7u;
      bool same = abs(depth - there) <= slack, hidden = depth < 0.0, before = depth < there - slack;
      bool own = shows == OWN, nearer = shows == NEARER;
      shown += same ? all : 0u;
      bool in_front = (same && own) || (before && nearer), behind = !nearer && (same || before);
      uint parts = in_front ? same_beside + OWN_PARTS : behind ? nearer_beside : 0u;
      front += hidden ? 0u : all * parts;
      uint weight = !same ? 0u : own ? all : mixed ? all >> OTHER_QUARTER_SHIFT : 0u;
      known += same && own ? all : 0u;
      sure += weight;
      sum += weight * uvec3(color & 255u, color >> 8 & 255u, color >> 16 & 255u);
    }
    float counts = sure > 0u ? source.weight / (magnified * magnified) : 0.0;
    found.cover = max(found.cover, float(shown));
    found.own = max(found.own, float(known));
    found.sum += counts * vec3(sum);
    float counted = counts * float(sure);
    found.weight += counted;
    found.front += counted * float(front);
  }
  return found;
}

bool has_color(Found found) { return found.cover > float(LEAST_SHOWN) && found.weight > 0.0; }
vec3 mean(Found found) { return found.sum / (found.weight > 0.0 ? found.weight : 1.0); }

bool seen_until(vec2 p, float w) {
  for (int k = 0; k < count; ++k) {
    Source source = sources[k];
    float z = along(source.from_z, p, w);
    float per_z = 1.0 / max(z, 1e-6);
    vec2 at = vec2(along(source.from_x, p, w), along(source.from_y, p, w)) * per_z;
    if (!(z > 1e-6 && at.x >= 0.0 && at.y >= 0.0 && at.x < float(source.width) &&
          at.y < float(source.height)))
      continue;
    if (abs(depth_of(k, ivec2(floor(at)))) <= w * per_z * (1.0 + SAME_SURFACE)) return true;
  }
  return false;
}

float splatted_at(int x, int y) {
  return x < 0 || x >= size.x ? 0.0 : uintBitsToFloat(depths[(y + 1) * size.x + x]);
}

// 1 / eye_z of the farthest of a pixel's samples; 0: one of them shows nothing.
float cover_at(ivec2 pixel) {
  float farthest = 0.0;
  for (int i = 0; i < cover_samples; ++i)
    farthest = max(farthest, texelFetch(cover, ivec2(pixel.x, size.y - 1 - pixel.y), i).r);
  return farthest >= 1.0 ? 0.0 : (1.0 - farthest * (planes.y - planes.x) / planes.y) / planes.x;
}

void copy(ivec2 pixel) {
  ivec2 texel = pixel + same.yz;
  uvec3 sum = uvec3(2u);
  for (int i = 0; i < 4; ++i) {
    uint color = texelFetch(colors[same.x], 2 * texel + ivec2(i & 1, i >> 1), 0).r;
    sum += uvec3(color & 255u, color >> 8 & 255u, color >> 16 & 255u);
  }
  sum >>= 2;
  out_color = sum.r | sum.g << 8 | sum.b << 16 | 0xff000000u;
  out_inverse_z = depth_of(same.x, texel);
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  if (same.x >= 0) {
    copy(pixel);
    return;
  }
  vec2 p = vec2(pixel) + 0.5;
  float splatted = splatted_at(pixel.x, pixel.y);
  float left = splatted_at(pixel.x - 1, pixel.y), right = splatted_at(pixel.x + 1, pixel.y),
        over = splatted_at(pixel.x, pixel.y - 1), under = splatted_at(pixel.x, pixel.y + 1);
  float nearest = max(max(left, right), max(over, under)),
        farthest = min(min(left, right), min(over, under));
  out_inverse_z = 0.0;
  if (any_cover) {
    float hides = cover_at(pixel);
    if (hides > splatted) {
      bool unknown = !(hides > nearest_thing) && !seen_until(p, hides);
      out_color = unknown ? 0u : COVERED;
      return;
    }
  }
  int across = (size.x + SKY_COLUMNS - 1) / SKY_COLUMNS;
  if (leaves_sky && max(splatted, nearest) == 0.0 &&
      plain_sky[pixel.y / STRIP * across + pixel.x / SKY_COLUMNS] != 0u) {
    out_color = PLAIN_SKY;
    return;
  }
  const float times = 1.0 + SAME_SURFACE;
  bool is_behind = nearest > splatted * times;
  bool edge = is_behind || splatted > farthest * times;
  float front = is_behind ? nearest : splatted, back = is_behind ? splatted : farthest;
  Found nearer = find(p, front, edge || front > 0.0);
  bool known = has_color(nearer), left_behind = nearer.too_near && !known;
  bool shown = known && (edge || nearer.own > 0.0);
  float part = shown ? 1.0 : 0.0, w = front;
  vec3 sum = vec3(0.0);
  if (edge) {
    Found farther = find(p, back, true);
    bool behind = !left_behind && has_color(farther);
    if (behind) {
      float covers = nearer.front / (nearer.weight > 0.0 ? nearer.weight : 1.0);
      part = min(covers * (1.0 / (float(QUARTER_PARTS) * float(TEXEL_WEIGHTS))), 1.0);
      if (part < 0.5) w = back;
      shown = true;
      sum = (1.0 - part) * mean(farther);
    }
  }
  sum += part * mean(nearer);
  uvec3 bytes = uvec3(min(sum + 0.5, vec3(255.0)));
  out_color = shown ? bytes.r | bytes.g << 8 | bytes.b << 16 | 0xff000000u : 0u;
  out_inverse_z = shown ? w : 0.0;
}
)";

// A triangle for each, around the middle of its pixel: the size of points is the caller's state.
const char* const kFillVertex = R"(#version 450
layout(std430, binding = PIXEL_BLOCK) restrict readonly buffer Holes { uvec4 holes[]; };
layout(location = 0) uniform ivec2 size;
flat out uint v_color;
flat out float v_inverse_z;
void main() {
  uvec4 hole = holes[gl_VertexID / 3];  // x, y, colour, 1 / eye_z
  v_color = hole.z;
  v_inverse_z = uintBitsToFloat(hole.w);
  int corner = gl_VertexID % 3;
  vec2 around = vec2(1.0 - float(corner), corner == 1 ? 1.0 : -1.0) * 0.4;
  gl_Position = vec4(2.0 * (vec2(hole.xy) + 0.5 + around) / vec2(size) - 1.0, 0.0, 1.0);
}
)";

const char* const kFillFragment = R"(#version 450
flat in uint v_color;
flat in float v_inverse_z;
layout(location = 0) out uint out_color;
layout(location = 1) out float out_inverse_z;
void main() {
  out_color = v_color;
  out_inverse_z = v_inverse_z;
}
)";

const char* const kShowVertex = R"(#version 450
layout(location = 0) out vec2 v_at;  // within the viewport, y upwards
void main() {
  v_at = vec2(float((gl_VertexID & 1) * 2), float((gl_VertexID >> 1) * 2));
  gl_Position = vec4(2.0 * v_at - 1.0, 0.0, 1.0);
}
)";

// What is not warped is left to polygons, and to the sky. The sky of keyframes lies on the far
// plane: it is drawn by itself, over the scene's, where nothing else is.
const char* const kShowFragment = R"(#version 450
layout(location = 0) in vec2 v_at;
layout(location = 0) uniform vec2 planes;  // z_near, z_far
layout(location = 1) uniform bool shows_sky;
layout(binding = 0) uniform usampler2D contents;
layout(binding = 1) uniform sampler2D inverse_z;
#if OBJECTS
layout(location = 0) out uint out_object;
#else
layout(location = 0) out vec4 out_color;
#endif
void main() {
  ivec2 size = textureSize(contents, 0);
  ivec2 pixel = min(ivec2(v_at * vec2(size)), size - 1);
  pixel.y = size.y - 1 - pixel.y;
  uint content = texelFetch(contents, pixel, 0).r;
  float w = texelFetch(inverse_z, pixel, 0).r;
  bool sky = !(w * planes.y > 1.0);
#if OBJECTS
  if (content == 0u || sky) discard;
  out_object = content;
#else
  if (content >> 24 != 255u || sky != shows_sky) discard;
  out_color = unpackUnorm4x8(content);
#endif
  gl_FragDepth =
      sky ? 1.0 : clamp((1.0 - planes.x * w) * planes.y / (planes.y - planes.x), 0.0, 1.0);
}
)";

// Whatever the locale is.
std::string text_of(float value) {
  char text[32];
  const auto [end, error] =
      std::to_chars(std::begin(text), std::end(text), value, std::chars_format::scientific);
  return error == std::errc() ? std::string(text, end) : "0.0";
}

std::string constants() {
  const auto define = [](const char* name, const auto& value) {
    return std::string("#define ") + name + " " + value + "\n";
  };
  const auto whole = [&](const char* name, long value) {
    return define(name, std::to_string(value));
  };
  const auto bits = [&](const char* name, std::uint32_t value) {
    return define(name, std::to_string(value) + "u");
  };
  const auto number = [&](const char* name, float value) { return define(name, text_of(value)); };
  return whole("MOST_WARPED", kMostWarped) + whole("DEPTH_BLOCK", kDepthBlock) +
         whole("COLOR_UNIT", kColorUnit) + whole("DEPTH_UNIT", kDepthUnit) +
         whole("COVER_UNIT", kCoverUnit) + whole("SOURCE_BLOCK", kSourceBlock) +
         whole("PIXEL_BLOCK", kPixelBlock) + whole("SPLAT_GROUP", kSplatGroup) +
         number("HALF_SQUARE", kHalfSquare) + number("CRACK_PARALLAX", kCrackParallax) +
         number("LEAST_SLANT", kLeastSlant) + number("WIDEST_CRACK", kWidestCrack) +
         number("SAME_SURFACE", kSameSurfaceDepth) + number("MOST_MAGNIFIED", kMostMagnified) +
         number("MOST_MIXED", kMostMixed) + whole("TEXEL_WEIGHTS", kTexelWeights) +
         whole("ALL_SHOWN", kAllShown) + whole("LEAST_SHOWN", kLeastShown) +
         bits("OWN", std::uint32_t(Quarter::own)) + bits("NEARER", std::uint32_t(Quarter::nearer)) +
         bits("OWN_PARTS", kOwnParts) + whole("QUARTER_PARTS", kQuarterParts) +
         whole("OTHER_QUARTER_SHIFT", kOtherQuarterShift) + bits("COVERED", kCoveredPixel) +
         bits("PLAIN_SKY", kPlainSky) + whole("SKY_COLUMNS", kPlainSkyColumns) +
         whole("STRIP", WarpedFrame::kStrip);
}

}  // namespace

Result<gl::Program> make_splat_program() {
  return gl::make_compute_program("keyframes, forward", std::string(kKeyframes) + kSplat,
                                  constants());
}

Result<gl::Program> make_lookup_program() {
  return gl::make_program("keyframes, backward", kWholeFrame, std::string(kKeyframes) + kLookup,
                          constants());
}

Result<gl::Program> make_fill_program() {
  return gl::make_program("filled holes", kFillVertex, kFillFragment, constants());
}

Result<gl::Program> make_show_program(bool objects) {
  return gl::make_program("warped frame", kShowVertex, kShowFragment,
                          constants() + "#define OBJECTS " + (objects ? "1" : "0") + "\n");
}

}  // namespace rilievo::shader
