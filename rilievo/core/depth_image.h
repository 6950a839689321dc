// A picture with depth, captured once and re-drawn from new eyes.
//
// Colours are linear, premultiplied by alpha; alpha is coverage. A texel that shows nothing has
// colour 0 0 0 0 and depth kNoDepth. All planes of one picture have the camera's size.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/core/depth.h"
#include "rilievo/core/image.h"

namespace rilievo {

// Object identifiers start at 1; 0 is "no object" (the sky).
inline constexpr std::uint32_t kNoObject = 0;

// A picture with depth: a colour and one depth at each texel, from a known camera.
struct DepthImage {
  std::string name;
  Camera camera;
  DepthKind depth_kind = DepthKind::eye_z;
  ColorImage color;
  Image<float> depth;
  Image<std::uint32_t> object;  // empty, or the identifier of the object that each texel shows

  // Does the texel show anything?
  [[nodiscard]] bool covered(int x, int y) const { return depth(x, y) != kNoDepth; }
};

// One surface crossing on a line of sight (S4.1). For a surface, `back` equals `depth`; a volume's
// sample extends from `depth` to `back`.
struct LayerSample {
  glm::vec4 color{0.0f};
  float depth = kNoDepth;
  float back = kNoDepth;
  std::uint32_t object = kNoObject;
};

// All surfaces along each line of sight, nearest first: samples of texel (x, y) are
// samples[first[y * width + x] ... first[y * width + x + 1]).
struct LayeredDepthImage {
  std::string name;
  Camera camera;
  DepthKind depth_kind = DepthKind::eye_z;
  std::vector<std::uint64_t> first;  // width * height + 1
  std::vector<LayerSample> samples;
};

// Six z-buffered 90-degree faces from one point (S3.1), in the order +x -x +y -y +z -z. The faces'
// cameras share one position; `up` of each is OpenGL's cube map convention.
struct EnvironmentMap {
  std::string name;
  std::array<DepthImage, 6> faces;
};

// The six cameras of an EnvironmentMap at `eye`, `size` texels square.
[[nodiscard]] std::array<Camera, 6> environment_cameras(const glm::dvec3& eye, int size,
                                                        double z_near, double z_far);

// Do the planes agree with the camera, is every colour finite, every depth finite or kNoDepth?
[[nodiscard]] Result<> validate(const DepthImage& picture);
// Does the index fit the camera and the samples; are depths finite and ascending along each line of
// sight, `back` not before `depth`, colours finite?
[[nodiscard]] Result<> validate(const LayeredDepthImage& layers);

}  // namespace rilievo
