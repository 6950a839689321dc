// Which shaders draw a scene directly, and in which variants?
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <string>

#include "rilievo/gl/object.h"

namespace rilievo::shader {

// A variant of the shader is a set of these. A mesh does not pay for features that it does not use.
enum Feature : unsigned {
  kColors = 1,    // vertex colours
  kTextures = 2,  // any texture at all
  kNormalMap = 4,
  kMask = 8,  // alpha mask
  kUnlit = 16,
  kBlend = 32,
  kObjectIds = 64,          // identifiers instead of colours
  kLinear = 128,            // OutputEncoding::linear
  kShare = 256,             // a cross-fade range (kPixelHash)
  kAnyLights = 512,         // up to kFewLights of any kind; otherwise one directional light
  kBackPerspective = 1024,  // a back-perspective camera; otherwise another
  kMetallic = 2048,
  kEmissive = 4096,
  kManyLights = 8192,     // with kAnyLights: any number
  kPeel = 16384,          // surfaces behind given depths; single-sided back faces look like fronts
  kPositionCode = 32768,  // Material::code_from_mesh, with kUnlit
  kDiscs = 65536,         // points (stroke_shaders.h)
  kLines = 131072,        // lines
  // The features without effect where there is no light.
  kOfLight = kNormalMap | kAnyLights | kBackPerspective | kMetallic | kEmissive | kManyLights,
};

// The View block of the shaders (std140).
struct ViewBlock {
  glm::mat4 clip_from_relative;
  glm::mat4 relative_from_clip;
  // xyz: direction to the eye of a parallel camera; w: 0 if the camera is parallel.
  glm::vec4 eye_direction;
  glm::vec4 zenith, horizon, ground;
  // The one light of variants without kAnyLights; w of the direction is the number of lights.
  glm::vec4 sun_direction_count, sun_intensity;
  glm::vec4 raster;  // width and height, pixels
};

// Up to this number, lights lie in a uniform block: software rasterisers shade a third slower with
// lights in a storage buffer.
inline constexpr std::size_t kFewLights = 16;
// The binding of both.
inline constexpr unsigned kLightsBinding = 2;
// A light in the Lights block, which has kFewLights entries, or any number in a storage buffer.
struct LightBlock {
  glm::vec4 position_range;   // relative to the eye
  glm::vec4 direction_kind;   // 0 directional, 1 point, 2 spot
  glm::vec4 intensity_inner;  // w: cosine of the inner cone
  glm::vec4 outer;            // x: cosine of the outer cone
};

// The texture unit of these depths.
inline constexpr unsigned kPeeledUnit = 7;

// The program of a variant (a set of Feature), and that of the sky.
[[nodiscard]] Result<gl::Program> make_scene_program(unsigned features);
[[nodiscard]] Result<gl::Program> make_sky_program(bool linear);

// GLSL `float pixel_hash()`: a number in [0, 1) for each pixel, evenly distributed in every
// neighbourhood [Jimenez 2014, interleaved gradient noise]. Two things drawn with the cross-fade
// ranges [a, b) and [b, c) are complementary at each pixel. So one fades into the other through the
// z-buffer, in any drawing order, without blending.
extern const char* const kPixelHash;

// GLSL `vec3 srgb_from_linear(vec3)`: encodes linear light for an 8-bit frame.
extern const char* const kSrgbFromLinear;

}  // namespace rilievo::shader
