// What does a camera see of objects, rasterised without OpenGL?
//
// The picture that nailboard/gl/picture_atlas.h captures by OpenGL, for machines whose OpenGL is a
// processor too: nearest depth, coverage, shading as render/opengl/scene_shaders.h has it. What is
// seen is found first and then shaded once for each texel and triangle, so that triangles smaller
// than texels cost little. All cores; the same bytes for any number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// Rows from the bottom, as OpenGL has them.
struct RasterPicture {
  int width = 0, height = 0;
  std::vector<glm::u8vec4> color;  // sRGB, premultiplied; alpha is the share of covered samples
  std::vector<float> depth;        // window_z of the nearest sample; 1: nothing
};

class PictureRasterizer {
 public:
  // Can the scene's opaque parts be rasterised here? Not if any has textures or a mask.
  [[nodiscard]] static bool supports(const Scene& scene);

  // Memory that pictures of up to `size` texels a side take while they are drawn, theirs included;
  // besides a few hundred kilobytes for each thread.
  [[nodiscard]] static std::size_t bytes(int size, int samples);

  // `scene` must be supported and outlive it.
  explicit PictureRasterizer(const Scene& scene);
  PictureRasterizer(PictureRasterizer&&) noexcept;
  PictureRasterizer& operator=(PictureRasterizer&&) noexcept;
  ~PictureRasterizer();

  // The opaque parts of `objects`, placed by `poses` (of all objects). Requires a perspective
  // camera with all of the objects in front of its eye, and 1 or 4 samples a texel. What lies
  // before the near plane is drawn on it.
  void draw(const Camera& camera, std::span<const std::uint32_t> objects,
            std::span<const glm::mat4> poses, int samples, RasterPicture& picture);

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rilievo
