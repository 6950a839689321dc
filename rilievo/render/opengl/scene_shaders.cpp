// Metallic-roughness shading after appendix B of the glTF 2.0 specification: GGX distribution,
// Smith visibility, Schlick's Fresnel; ambient light from a two-colour sky, its mirror part by the
// approximation of [Karis 2014, Physically Based Shading on Mobile].
#include <glm/glm.hpp>

#include "rilievo/render/opengl/scene_shaders.h"
#include "rilievo/render/opengl/stroke_shaders.h"

namespace rilievo::shader {
namespace {

const char* const kCommon = R"(
layout(std140, binding = 0) uniform View {
  mat4 clip_from_relative;
  mat4 relative_from_clip;
  vec4 eye_direction;
  vec4 zenith, horizon, ground;
  vec4 sun_direction_count, sun_intensity;
  vec4 raster;
} view;
)";

const char* const kSky = R"(
// Radiance of the sky in a direction: a smooth blend over elevation.
vec3 sky_radiance(float elevation) {
  vec3 above = mix(view.horizon.rgb, view.zenith.rgb, sqrt(clamp(elevation, 0.0, 1.0)));
  return mix(above, view.ground.rgb, smoothstep(0.0, -0.08, elevation));
}
)";

const char* const kVertex = R"(
#ifndef STROKES
layout(location = 0) in vec3 position;
layout(location = 1) in vec4 normal;
layout(location = 2) in vec4 color;
layout(location = 3) in vec2 uv0;
layout(location = 4) in vec2 uv1;
#endif
#ifdef COLORS
out vec4 v_color;
#endif
#ifdef TEXTURES
out vec4 v_uv;
#endif
layout(location = 5) in vec4 row0;
layout(location = 6) in vec4 row1;
layout(location = 7) in vec4 row2;
#ifdef SHARE
layout(location = 9) in vec2 share;
flat out vec2 v_share;
#endif
#ifdef OBJECT_IDS
layout(location = 8) in uint object;
flat out uint v_object;
#else
out vec3 v_relative;
out vec3 v_normal;
#endif
#ifdef POSITION_CODE
out vec3 v_position;
#endif

#ifdef PEEL
invariant gl_Position;  // of identifiers and of colours: depths are compared
#endif
)";

const char* const kVertexMain = R"(
void main() {
#ifdef STROKES
  vec3 relative;
  place_stroke(relative, gl_Position);
#else
  vec4 p = vec4(position, 1.0);
  vec3 relative = vec3(dot(row0, p), dot(row1, p), dot(row2, p));
  gl_Position = view.clip_from_relative * vec4(relative, 1.0);
#endif
#ifdef OBJECT_IDS
  v_object = object;
#else
  v_relative = relative;
  // As normal_map() in core/linear_maps.h; lengths near 1, so that their squares are numbers.
  vec3 yz = cross(row1.xyz, row2.xyz), zx = cross(row2.xyz, row0.xyz), xy = cross(row0.xyz, row1.xyz);
  float longest = max(length(yz), max(length(zx), length(xy)));
  v_normal = (dot(row0.xyz, yz) < 0.0 ? -1.0 : 1.0) / (longest > 0.0 ? longest : 1.0) *
             vec3(dot(yz, normal.xyz), dot(zx, normal.xyz), dot(xy, normal.xyz));
#endif
#ifdef STROKES
#ifdef POSITION_CODE
  // Of the place that is shown. A flat placement has no inverse, and shows no code.
  mat3 linear = transpose(mat3(row0.xyz, row1.xyz, row2.xyz));
  v_position = inverse(linear) * (relative - vec3(row0.w, row1.w, row2.w));
#endif
#elif defined(POSITION_CODE)
  v_position = position;
#endif
#ifdef SHARE
  v_share = share;
#endif
#ifdef COLORS
  v_color = color;
#endif
#ifdef TEXTURES
  v_uv = vec4(uv0, uv1);
#endif
}
)";

const char* const kFragment = R"(
layout(std140, binding = 1) uniform Material {
  vec4 base_color;
  vec4 emissive_normal_scale;
  vec4 metallic_roughness_occlusion_cutoff;
  vec4 uv_rows[10];
  vec4 code_rows[3];
} material;

// The middle of the samples that the triangle covers, from the pixel's centre, where it is shaded:
// the centre may lie outside the triangle, and on the plane of a slanted one far from it. As
// shading/band_shader.h, which `centroid` leaves to the driver.
vec2 middle = vec2(0.0);
const vec2 kFour[4] = vec2[](vec2(-0.125, -0.375), vec2(0.375, -0.125), vec2(-0.375, 0.125),
                             vec2(0.125, 0.375));
void find_middle(int covered) {
  if (gl_NumSamples != 4 || covered == 0 || covered == 15) return;
  for (int i = 0; i < 4; ++i)
    if ((covered >> i & 1) != 0) middle += kFour[i];
  middle /= float(bitCount(covered));
}

)";

const char* const kFragmentRest = R"(
#ifdef SHARE
flat in vec2 v_share;
#endif
#ifdef COLORS
in vec4 v_color;
#endif
#ifdef TEXTURES
in vec4 v_uv;
layout(binding = 0) uniform sampler2D base_color_texture;
layout(binding = 1) uniform sampler2D metallic_roughness_texture;
layout(binding = 2) uniform sampler2D normal_texture;
layout(binding = 3) uniform sampler2D occlusion_texture;
layout(binding = 4) uniform sampler2D emissive_texture;

vec2 uv_of(int unit, vec4 both) {
  vec4 a = material.uv_rows[2 * unit], b = material.uv_rows[2 * unit + 1];
  vec3 uv = vec3(a.w > 0.5 ? both.zw : both.xy, 1.0);
  return vec2(dot(a.xyz, uv), dot(b.xyz, uv));
}
// Differences are those between the pixels' centres.
vec4 textured(sampler2D t, int unit) {
  vec2 centre = uv_of(unit, v_uv);
  return textureGrad(t, uv_of(unit, interpolateAtOffset(v_uv, middle)), dFdx(centre),
                     dFdy(centre));
}
#endif

#ifdef PEEL
layout(binding = 7) uniform sampler2D peeled_depth;
uniform bool double_sided;
uniform float least_roughness;
#endif
#ifdef OBJECT_IDS
flat in uint v_object;
layout(location = 0) out uint out_object;
#else
in vec3 v_relative;
in vec3 v_normal;
layout(location = 0) out vec4 out_color;

#ifdef POSITION_CODE
in vec3 v_position;

// The linear light of the bytes that scene/position_colors.h defines.
vec3 position_color() {
  vec4 p = vec4(interpolateAtOffset(v_position, middle), 1.0);
  vec3 at = vec3(dot(material.code_rows[0], p), dot(material.code_rows[1], p),
                 dot(material.code_rows[2], p));
  vec3 c = at - 2.0 * floor(0.5 * at);
  c = min(c, 2.0 - c);
  return mix(pow((c + 0.055) / 1.055, vec3(2.4)), c / 12.92, lessThan(c, vec3(0.04045)));
}
#endif

const float kPi = 3.14159265;

// Reflected at normal incidence: of metals coloured.
#ifdef METALLIC
#define F0 vec3
#else
#define F0 float
#endif

// Light that leaves the surface towards `v`, per unit of light that arrives from `l`, times n.l.
vec3 reflected(vec3 n, vec3 v, vec3 l, vec3 diffuse, F0 f0, float alpha2) {
  float towards_l = dot(n, l), towards_v = dot(n, v);
  float n_l = clamp(towards_l, 0.0, 1.0), n_v = clamp(towards_v, 1e-4, 1.0);
  // With h halfway between l and v, |l + v|^2 = 2 (1 + l.v) = 4 (v.h)^2, and n.h follows.
  float v_h2 = clamp(0.5 + 0.5 * dot(l, v), 1e-6, 1.0);
  float up = max(towards_l + towards_v, 0.0);
  float n_h2 = min(0.25 * up * up / v_h2, 1.0);
  float d = n_h2 * (alpha2 - 1.0) + 1.0;
  float masked = n_l * sqrt(n_v * n_v * (1.0 - alpha2) + alpha2) +
                 n_v * sqrt(n_l * n_l * (1.0 - alpha2) + alpha2) + 1e-5;
  float distribution_visibility = 0.5 / kPi * alpha2 / (d * d * masked);
  float m = 1.0 - sqrt(v_h2), m2 = m * m;
  F0 fresnel = f0 + (1.0 - f0) * (m2 * m2 * m);
  return n_l * (1.0 / kPi * diffuse * (1.0 - fresnel) + fresnel * distribution_visibility);
}

#ifdef ANY_LIGHTS
struct LightBlock { vec4 position_range, direction_kind, intensity_inner, outer; };
#ifdef MANY_LIGHTS
layout(std430, binding = 2) readonly buffer Lights { LightBlock lights[]; };
#else
layout(std140, binding = 2) uniform Lights { LightBlock lights[16]; };
#endif

// How much of the light's intensity arrives here, and the way to it.
float arrives(LightBlock light, out vec3 l) {
  l = -light.direction_kind.xyz;
  if (light.direction_kind.w < 0.5) return 1.0;
  vec3 to = light.position_range.xyz - interpolateAtOffset(v_relative, middle);
  float strength = 1.0, distance2 = max(dot(to, to), 1e-6), range = light.position_range.w;
  if (light.direction_kind.w > 1.5) {
    float cosine = dot(normalize(-to), light.direction_kind.xyz);
    strength = smoothstep(light.outer.x, light.intensity_inner.w, cosine);
  }
  l = to * inversesqrt(distance2);
  strength /= distance2;
  if (range > 0.0) {
    float r = distance2 / (range * range);
    strength *= clamp(1.0 - r * r, 0.0, 1.0);
  }
  return strength;
}
#endif

#ifdef NORMAL_MAP
// [Schueler 2013, Normal Mapping Without Precomputed Tangents]: the frame from screen derivatives.
vec3 mapped_normal(vec3 n) {
  vec2 uv = uv_of(2, v_uv);
  vec3 dp1 = dFdx(v_relative), dp2 = dFdy(v_relative);
  vec2 du1 = dFdx(uv), du2 = dFdy(uv);
  vec3 a = cross(dp2, n), b = cross(n, dp1);
  vec3 t = a * du1.x + b * du2.x, bt = a * du1.y + b * du2.y;
  float longest = max(dot(t, t), dot(bt, bt));
  if (longest <= 0.0) return n;
  // Seen from afar towards an apex, the picture's x and y turn the other way around n.
  if (dot(cross(dp1, dp2), n) < 0.0) {
    t = -t;
    bt = -bt;
  }
  vec3 m = textured(normal_texture, 2).xyz * 2.0 - 1.0;
  m.xy *= material.emissive_normal_scale.w;
  // glTF's texture v grows downwards as the bitangent grows upwards.
  return normalize(inversesqrt(longest) * (t * m.x - bt * m.y) + n * m.z);
}
#endif

vec3 shade(vec3 base, vec3 n, vec3 v) {
  float roughness = material.metallic_roughness_occlusion_cutoff.y;
  float occlusion = 1.0;
#ifdef TEXTURES
  vec4 mr = textured(metallic_roughness_texture, 1);
  roughness *= mr.g;
  occlusion += material.metallic_roughness_occlusion_cutoff.z *
               (textured(occlusion_texture, 3).r - 1.0);
#endif
  roughness = clamp(roughness, 0.045, 1.0);
#ifdef PEEL
  roughness = max(roughness, least_roughness);
#endif
#ifdef METALLIC
  float metallic = material.metallic_roughness_occlusion_cutoff.x;
#ifdef TEXTURES
  metallic *= mr.b;
#endif
  vec3 diffuse = base * (1.0 - metallic);
  vec3 f0 = mix(vec3(0.04), base, metallic);
#else
  vec3 diffuse = base;
  float f0 = 0.04;
#endif
  float alpha = roughness * roughness;

  float alpha2 = alpha * alpha;
#ifdef ANY_LIGHTS
  vec3 light = vec3(0.0);
  for (int i = 0; i < int(view.sun_direction_count.w); ++i) {
    vec3 l;
    float strength = arrives(lights[i], l);
    light += strength * lights[i].intensity_inner.rgb * reflected(n, v, l, diffuse, f0, alpha2);
  }
#else
  // One sun. A software rasteriser takes a quarter longer with the loop.
  vec3 light = view.sun_intensity.rgb *
               reflected(n, v, -view.sun_direction_count.xyz, diffuse, f0, alpha2);
#endif

  // The sky as ambient light: diffuse from the hemisphere around n, mirrored part by roughness.
  vec3 hemisphere = mix(view.ground.rgb, 0.5 * (view.zenith.rgb + view.horizon.rgb), 0.5 + 0.5 * n.y);
  vec3 mirrored = mix(sky_radiance(reflect(-v, n).y), hemisphere, roughness);
  float n_v = clamp(dot(n, v), 0.0, 1.0);
  vec4 r = roughness * vec4(-1.0, -0.0275, -0.572, 0.022) + vec4(1.0, 0.0425, 1.04, -0.04);
  float a004 = min(r.x * r.x, exp2(-9.28 * n_v)) * r.x + r.y;
  vec2 ab = vec2(-1.04, 1.04) * a004 + r.zw;
  // The approximation falls below 0 for rough black metals.
  light += occlusion * (0.6 * diffuse * hemisphere + max(f0 * ab.x + ab.y, F0(0.0)) * mirrored);

#ifdef EMISSIVE
  vec3 emissive = material.emissive_normal_scale.rgb;
#ifdef TEXTURES
  emissive *= textured(emissive_texture, 4).rgb;
#endif
  light += emissive;
#endif
  return light;
}
#endif

void main() {
#ifdef STROKES
  int samples = stroke_samples() & gl_SampleMaskIn[0];
  if (samples == 0) discard;
  gl_SampleMask[0] = samples;
#else
  int samples = gl_SampleMaskIn[0] & 15;
#endif
#if !defined(MASK) && !defined(OBJECT_IDS)
  find_middle(samples);  // the edges of holes are found by differences between centres
#endif
#ifdef SHARE
  float hash = pixel_hash();
  if (hash < v_share.x || hash >= v_share.y) discard;
#endif
#if defined(PEEL) && defined(OBJECT_IDS)
  if (gl_FragCoord.z <= texelFetch(peeled_depth, ivec2(gl_FragCoord.xy), 0).r) discard;
#endif
  vec4 base = material.base_color;
#ifdef TEXTURES
  base *= textured(base_color_texture, 0);
#endif
#ifdef COLORS
  base *= interpolateAtOffset(v_color, middle);
#endif

  float alpha = 1.0;
#ifdef MASK
  float cutoff = material.metallic_roughness_occlusion_cutoff.w;
#if defined(PEEL)
  if (base.a < cutoff) discard;
#else
  // Sharpened to one pixel's width, and that share of the samples taken, rounded: what a driver
  // makes of alpha by itself may be half a sample more. Identifiers cover the same samples.
  float share = clamp((base.a - cutoff) / max(fwidth(base.a), 1e-4) + 0.5, 0.0, 1.0);
  int covered = int(share * float(gl_NumSamples) + 0.5);
  if (covered == 0) discard;
  gl_SampleMask[0] = (1 << covered) - 1;
#endif
#endif
#ifdef BLEND
  alpha = base.a;
#endif

#ifdef OBJECT_IDS
  out_object = v_object;
#else
#ifdef POSITION_CODE
  vec3 color = position_color();
#elif defined(UNLIT)
  vec3 color = base.rgb;
#else
#ifdef BACK_PERSPECTIVE
  vec3 v = interpolateAtOffset(v_relative, middle);  // to who sees it
#else
  vec3 v = view.eye_direction.w == 0.0 ? view.eye_direction.xyz
                                       : -normalize(interpolateAtOffset(v_relative, middle));
#endif
#ifdef STROKES
  vec3 facing = v;
#else
  vec3 facing = cross(dFdx(v_relative), dFdy(v_relative));
#endif
  vec3 n = interpolateAtOffset(v_normal, middle);
  // What the placement flattens has no normal where it stood upright: the triangle's.
  n = normalize(dot(n, n) > 1e-30 ? n : facing);
  // Both sides of a thin sheet are lit as seen. Which side that is, the triangle says: at a
  // silhouette the smooth normal of a visible face may already point away.
#ifdef PEEL
  // The back of what has but a front: seen from the other side of its plane.
  if (!double_sided && dot(v, n) < 0.0)
    v -= 2.0 * dot(v, n) * n;
  else
#endif
  if (dot(facing, v) * dot(facing, n) < 0.0) n = -n;
#ifdef BACK_PERSPECTIVE
  // The picture is for viewers far away: they see along its axis, not along its rays, which part
  // where theirs meet. What turns away from the axis is seen from beside it, by those for whom the
  // picture is still the nearest: some 20 degrees away, and so at 10 on average.
  v = view.eye_direction.xyz;
  v = normalize(v + max(0.0, 0.17 - dot(n, v)) * n);
#endif
#ifdef NORMAL_MAP
  n = mapped_normal(n);
#endif
  vec3 color = shade(base.rgb, n, v);
#endif
#ifndef LINEAR
  color = srgb_from_linear(color);
#endif
#ifdef BLEND
  color *= alpha;
#endif
  out_color = vec4(color, alpha);
#endif
}
)";

const char* const kSkyVertex = R"(
out vec3 v_direction;
void main() {
  vec2 corner = vec2((gl_VertexID << 1) & 2, gl_VertexID & 2) * 2.0 - 1.0;
  gl_Position = vec4(corner, 1.0, 1.0);
  vec4 far = view.relative_from_clip * gl_Position, near = view.relative_from_clip * vec4(corner, -1.0, 1.0);
  v_direction = far.xyz / far.w - near.xyz / near.w;
}
)";

const char* const kSkyFragment = R"(
in vec3 v_direction;
layout(location = 0) out vec4 out_color;
void main() {
  vec3 color = sky_radiance(normalize(v_direction).y);
#ifndef LINEAR
  color = srgb_from_linear(color);
#endif
  out_color = vec4(color, 1.0);
}
)";

const char* const kVersion = "#version 450\n";

}  // namespace

const char* const kPixelHash = R"(
float pixel_hash() {
  return fract(52.9829189 * fract(dot(floor(gl_FragCoord.xy), vec2(0.06711056, 0.00583715))));
}
)";

const char* const kSrgbFromLinear = R"(
// The power 1 / 2.4 = 5 / 6 of a square root, and that nearly a polynomial (minimax over what the
// curve holds for): within a fifth of a byte, at a fraction of the time of pow.
vec3 srgb_from_linear(vec3 c) {
  c = clamp(c, 0.0, 1.0);
  vec3 s = sqrt(c);
  vec3 curve = (((-0.30957186 * s + 0.84279114) * s - 0.94486092) * s + 1.44789933) * s - 0.03700467;
  return mix(12.92 * c, curve, step(vec3(0.0031308), c));
}
)";

Result<gl::Program> make_scene_program(unsigned features) {
  std::string defines;
  const auto define = [&](Feature feature, const char* name) {
    if (features & feature) defines += std::string("#define ") + name + " 1\n";
  };
  define(kColors, "COLORS");
  define(kTextures, "TEXTURES");
  define(kNormalMap, "NORMAL_MAP");
  define(kMask, "MASK");
  define(kUnlit, "UNLIT");
  define(kBlend, "BLEND");
  define(kObjectIds, "OBJECT_IDS");
  define(kLinear, "LINEAR");
  define(kShare, "SHARE");
  define(kAnyLights, "ANY_LIGHTS");
  define(kBackPerspective, "BACK_PERSPECTIVE");
  define(kMetallic, "METALLIC");
  define(kEmissive, "EMISSIVE");
  define(kManyLights, "MANY_LIGHTS");
  define(kPeel, "PEEL");
  define(kPositionCode, "POSITION_CODE");
  define(kDiscs, "DISCS");
  define(kLines, "LINES");
  const bool strokes = features & (kDiscs | kLines);
  if (strokes) defines += "#define STROKES 1\n";
  const std::string head = std::string(kVersion) + kCommon;
  return gl::make_program("scene", head + kVertex + (strokes ? kStrokeVertex : "") + kVertexMain,
                          head + kSky + kSrgbFromLinear + kPixelHash + kFragment +
                              (strokes ? kStrokeFragment : "") + kFragmentRest,
                          defines);
}

Result<gl::Program> make_sky_program(bool linear) {
  const std::string head = std::string(kVersion) + kCommon;
  return gl::make_program("sky", head + kSkyVertex, head + kSky + kSrgbFromLinear + kSkyFragment,
                          linear ? "#define LINEAR 1\n" : "");
}

}  // namespace rilievo::shader
