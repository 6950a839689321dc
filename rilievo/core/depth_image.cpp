#include "rilievo/core/depth_image.h"

#include <cmath>
#include <string>

namespace rilievo {

std::array<Camera, 6> environment_cameras(const glm::dvec3& eye, int size, double z_near,
                                          double z_far) {
  struct Axis {
    glm::dvec3 forward, up;
  };
  // OpenGL 4.5 core, table 8.19: t grows against these `up`s.
  constexpr int kFaces = 6;
  const Axis axes[kFaces] = {{{1, 0, 0}, {0, -1, 0}}, {{-1, 0, 0}, {0, -1, 0}},
                             {{0, 1, 0}, {0, 0, 1}},  {{0, -1, 0}, {0, 0, -1}},
                             {{0, 0, 1}, {0, -1, 0}}, {{0, 0, -1}, {0, -1, 0}}};
  std::array<Camera, 6> cameras;
  for (int i = 0; i < kFaces; ++i) {
    Camera& c = cameras[i];
    const glm::dvec3 right = glm::cross(axes[i].forward, axes[i].up);
    c.world_from_eye = {glm::dvec4(right, 0), glm::dvec4(axes[i].up, 0),
                        glm::dvec4(-axes[i].forward, 0), glm::dvec4(eye, 1)};
    c.z_near = z_near;
    c.z_far = z_far;
    c.width = c.height = size;
  }
  return cameras;
}

Result<> validate(const DepthImage& picture) {
  if (Result<> camera = validate(picture.camera); !camera) return camera;
  const int w = picture.camera.width, h = picture.camera.height;
  const auto sized = [&](const auto& plane) { return plane.width() == w && plane.height() == h; };
  if (!sized(picture.color) || !sized(picture.depth) ||
      (!picture.object.empty() && !sized(picture.object)))
    return Error{"picture", "its planes do not have the camera's size"};
  for (const glm::vec4& c : picture.color.texels())
    if (!std::isfinite(c.r) || !std::isfinite(c.g) || !std::isfinite(c.b) || !std::isfinite(c.a))
      return Error{"picture", "a colour is not finite"};
  for (float d : picture.depth.texels())
    if (!(std::isfinite(d) || d == kNoDepth)) return Error{"picture", "a depth is not a number"};
  return Done{};
}

Result<> validate(const LayeredDepthImage& layers) {
  if (Result<> camera = validate(layers.camera); !camera) return camera;
  const std::size_t texels = std::size_t(layers.camera.width) * std::size_t(layers.camera.height);
  if (layers.first.size() != texels + 1 || layers.first.front() != 0 ||
      layers.first.back() != layers.samples.size())
    return Error{"picture", "its index does not have the camera's size"};
  for (std::size_t i = 0; i < texels; ++i) {
    if (layers.first[i] > layers.first[i + 1] || layers.first[i + 1] > layers.samples.size())
      return Error{"picture", "its index does not ascend"};
    for (std::size_t s = layers.first[i]; s < layers.first[i + 1]; ++s) {
      const LayerSample& sample = layers.samples[s];
      for (int k = 0; k < 4; ++k)
        if (!std::isfinite(sample.color[k])) return Error{"picture", "a colour is not finite"};
      if (!std::isfinite(sample.depth) || !std::isfinite(sample.back) || sample.back < sample.depth)
        return Error{"picture", "a sample has no depth, or ends before it begins"};
      if (s > layers.first[i] && sample.depth < layers.samples[s - 1].depth)
        return Error{"picture", "its samples are not in the order of their depths"};
    }
  }
  return Done{};
}

}  // namespace rilievo
