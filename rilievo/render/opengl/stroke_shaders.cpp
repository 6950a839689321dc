#include "rilievo/render/opengl/stroke_shaders.h"

namespace rilievo::shader {

const char* const kStrokeVertex = R"(
layout(std430, binding = 3) readonly buffer StrokeVertices { uint stroke_vertices[]; };
layout(std430, binding = 4) readonly buffer StrokeUvs { vec4 stroke_uvs[]; };
layout(location = 10) in float stroke_radius;  // metres; 0: as many pixels as follow
uniform float stroke_radius_px;

vec3 position;
vec4 normal, color;
vec2 uv0, uv1;

struct Stroke { vec3 position; vec4 normal, color, uv; };
Stroke stroke_vertex(int i) {
  Stroke s;
  uint at = 6u * uint(i);
  s.position = uintBitsToFloat(uvec3(stroke_vertices[at], stroke_vertices[at + 1u],
                                     stroke_vertices[at + 2u]));
  int n = int(stroke_vertices[at + 3u]);
  s.normal = vec4(vec3(bitfieldExtract(n, 0, 10), bitfieldExtract(n, 10, 10),
                       bitfieldExtract(n, 20, 10)) / 511.0, 0.0);
  s.color = vec4(unpackUnorm2x16(stroke_vertices[at + 4u]),
                 unpackUnorm2x16(stroke_vertices[at + 5u]));
#ifdef TEXTURES
  s.uv = stroke_uvs[i];
#else
  s.uv = vec4(0.0);
#endif
  return s;
}
void use(Stroke s) {
  position = s.position; normal = s.normal; color = s.color; uv0 = s.uv.xy; uv1 = s.uv.zw;
}
vec3 relative_of(vec3 p) {
  vec4 q = vec4(p, 1.0);
  return vec3(dot(row0, q), dot(row1, q), dot(row2, q));
}
const vec4 kNowhere = vec4(0.0, 0.0, 2.0, 1.0);

#ifdef DISCS
out vec2 v_local;  // in radii

void place_stroke(out vec3 relative, out vec4 place) {
  use(stroke_vertex(gl_VertexID / 3));
  relative = relative_of(position);
  place = view.clip_from_relative * vec4(relative, 1.0);
  // A triangle around the circle, and somewhat more: drivers round corners.
  const float kAround = 2.2;
  float angle = 2.0943951 * float(gl_VertexID % 3);
  vec2 way = kAround * vec2(cos(angle), sin(angle));
  v_local = way;
  if (place.w <= 0.0 || place.z < -place.w) {  // before the near plane
    place = kNowhere;
  } else if (stroke_radius > 0.0) {
    vec3 along = view.eye_direction.w == 0.0 ? view.eye_direction.xyz : normalize(relative);
    vec3 x = normalize(cross(along, abs(along.y) < 0.7 ? vec3(0, 1, 0) : vec3(1, 0, 0)));
    relative += stroke_radius * (way.x * x + way.y * cross(x, along));
    place = view.clip_from_relative * vec4(relative, 1.0);
  } else {
    place.xy += 2.0 * stroke_radius_px * place.w * way / view.raster.xy;
  }
}
#endif

#ifdef LINES
flat out vec4 v_ends;  // in the raster

void place_stroke(out vec3 relative, out vec4 place) {
  int line = gl_VertexID / 18;
  Stroke s[2] = Stroke[](stroke_vertex(2 * line), stroke_vertex(2 * line + 1));
  vec3 r[2];
  vec4 c[2];
  for (int k = 0; k < 2; ++k) {
    r[k] = relative_of(s[k].position);
    c[k] = view.clip_from_relative * vec4(r[k], 1.0);
  }
  // Cut at the near plane, and 64 pixels outside of the frame.
  float from = 0.0, to = 1.0;
  bool any = true;
  vec2 far = 1.0 + 128.0 / view.raster.xy;
  for (int plane = 0; plane < 5; ++plane) {
    float d[2];
    for (int k = 0; k < 2; ++k) {
      vec4 p = c[k];
      d[k] = plane == 0 ? p.z + p.w
           : plane == 1 ? far.x * p.w + p.x
           : plane == 2 ? far.x * p.w - p.x
           : plane == 3 ? far.y * p.w + p.y : far.y * p.w - p.y;
    }
    if (d[0] < 0.0 && d[1] < 0.0) any = false;
    float crossing = d[0] / (d[0] - d[1]);
    if (d[0] < 0.0 && d[1] >= 0.0) from = max(from, crossing);
    if (d[1] < 0.0 && d[0] >= 0.0) to = min(to, crossing);
  }
  float share[2] = float[](from, to);
  vec4 e[2];
  vec2 p[2];
  for (int k = 0; k < 2; ++k) {
    e[k] = share[k] <= 0.0 ? c[0] : share[k] >= 1.0 ? c[1] : mix(c[0], c[1], share[k]);
    p[k] = (0.5 + 0.5 * e[k].xy / e[k].w) * view.raster.xy;
  }
  v_ends = vec4(p[0], p[1]);
  vec2 along = p[1] - p[0];
  along = dot(along, along) > 1e-12 ? normalize(along) : vec2(1.0, 0.0);
  // Stations before the first end, there, at the second end, behind it; two sides each.
  const int kStation[6] = int[](0, 0, 1, 1, 0, 1), kSide[6] = int[](0, 1, 0, 0, 1, 1);
  int corner = gl_VertexID % 6, station = gl_VertexID % 18 / 6 + kStation[corner];
  int end = station < 2 ? 0 : 1;
  float reach = stroke_radius_px + 0.05;
  vec2 off = reach * (station == 0 ? -1.0 : station == 3 ? 1.0 : 0.0) * along +
             reach * (kSide[corner] == 0 ? -1.0 : 1.0) * vec2(-along.y, along.x);
  float t = share[end];
  use(s[0]);
  position = mix(s[0].position, s[1].position, t);
  normal = mix(s[0].normal, s[1].normal, t);
  color = mix(s[0].color, s[1].color, t);
  uv0 = mix(s[0].uv.xy, s[1].uv.xy, t);
  uv1 = mix(s[0].uv.zw, s[1].uv.zw, t);
  vec2 shift = 2.0 * off / view.raster.xy;
  place = e[end];
  place.xy += place.w * shift;
  // A step of the image at w = 1.
  vec3 x = transpose(view.clip_from_relative)[0].xyz, y = transpose(view.clip_from_relative)[1].xyz,
       w = transpose(view.clip_from_relative)[3].xyz;
  x -= dot(x, w) * w;
  y -= dot(y, w) * w;
  relative = mix(r[0], r[1], t) +
             place.w * (shift.x / dot(x, x) * x + shift.y / dot(y, y) * y);
  if (!any || from > to) place = kNowhere;
}
#endif
)";

const char* const kStrokeFragment = R"(
#ifdef DISCS
in vec2 v_local;
bool covers(vec2 off) {
  vec2 at = interpolateAtOffset(v_local, off);
  return dot(at, at) <= 1.0;
}
#endif
#ifdef LINES
flat in vec4 v_ends;
uniform float stroke_radius_px;
bool covers(vec2 off) {
  const float kRounding = 1.0 / 4096.0;
  vec2 at = gl_FragCoord.xy + off - v_ends.xy, along = v_ends.zw - v_ends.xy;
  float length2 = dot(along, along);
  float s = length2 > 1e-12 ? clamp(dot(at, along) / length2, 0.0, 1.0) : 0.0;
  vec2 q = at - s * along;
  float reach = q.y + 0.381966 * q.x > 0.0 ? stroke_radius_px + 2.0 * kRounding
                                           : stroke_radius_px - kRounding;
  return dot(q, q) <= reach * reach;
}
#endif
int stroke_samples() {
  if (gl_NumSamples != 4) return covers(vec2(0.0)) ? (1 << gl_NumSamples) - 1 : 0;
  int covered = 0;
  for (int i = 0; i < 4; ++i)
    if (covers(kFour[i])) covered |= 1 << i;
  return covered;
}
)";

}  // namespace rilievo::shader
