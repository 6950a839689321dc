// The shaders of direct drawing, and which variants of them there are.
#pragma once

#include <cstddef>
#include <glm/glm.hpp>
#include <string>

#include "rilievo/gl/object.h"

namespace rilievo::shader {

// A variant is a set of these; what a mesh does not use costs it nothing.
enum Feature : unsigned {
  kColors = 1,    // vertex colours
  kTextures = 2,  // any texture at all
  kNormalMap = 4,
  kMask = 8,  // alpha mask
  kUnlit = 16,
  kBlend = 32,
  kObjectIds = 64,          // identifiers instead of colours
  kLinear = 128,            // OutputEncoding::linear
  kShare = 256,             // a share of the pixels only, chosen by kPixelHash
  kAnyLights = 512,         // up to kFewLights of any kind; without it, one directional light
  kBackPerspective = 1024,  // the camera's projection; without it, one of the others
  kMetallic = 2048,
  kEmissive = 4096,
  kManyLights = 8192,  // with kAnyLights: any number
  kPeel = 16384,       // behind given depths; back faces look as fronts where there is but one side
  // What changes nothing where there is no light.
  kOfLight = kNormalMap | kAnyLights | kBackPerspective | kMetallic | kEmissive | kManyLights,
};

// Matches the View block (std140).
struct ViewBlock {
  glm::mat4 clip_from_relative;
  glm::mat4 relative_from_clip;
  // xyz: seen from afar, the way to the eye; w: 0 if all rays are parallel.
  glm::vec4 eye_direction;
  glm::vec4 zenith, horizon, ground;
  // Of what is drawn without kAnyLights, the one light; w of the direction: how many there are.
  glm::vec4 sun_direction_count, sun_intensity;
};

// Few lights lie in a uniform block: a software rasteriser takes a third longer to shade with
// lights of a storage buffer.
inline constexpr std::size_t kFewLights = 16;
// Where either is bound.
inline constexpr unsigned kLightsBinding = 2;
// Matches an entry of Lights, which has kFewLights of them or, in a storage buffer, any number.
struct LightBlock {
  glm::vec4 position_range;   // relative to the eye
  glm::vec4 direction_kind;   // 0 directional, 1 point, 2 spot
  glm::vec4 intensity_inner;  // w: cosine of the inner cone
  glm::vec4 outer;            // x: cosine of the outer cone
};

// Of kPeel: the texture unit of the depths.
inline constexpr unsigned kPeeledUnit = 7;

[[nodiscard]] Result<gl::Program> make_scene_program(unsigned features);
[[nodiscard]] Result<gl::Program> make_sky_program(bool linear);

// GLSL `float pixel_hash()`: a number in [0, 1) for each pixel, evenly spread in every
// neighbourhood [Jimenez 2014, interleaved gradient noise]. What is drawn where the hash is in [a,
// b) and what is drawn where it is in [b, c) complement each other pixel by pixel, whatever drew
// them: so one fades into the other without blending, in any order, through the z-buffer.
extern const char* const kPixelHash;

// GLSL that turns linear light into what an 8-bit frame holds: `vec3 srgb_from_linear(vec3)`.
extern const char* const kSrgbFromLinear;

}  // namespace rilievo::shader
