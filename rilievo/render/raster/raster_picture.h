// What does a camera see of objects, rasterised without OpenGL?
//
// The picture that nailboard/gl/picture_atlas.h captures by OpenGL, for machines whose OpenGL is a
// processor too: nearest depth, coverage, shading as render/opengl/scene_shaders.h has it, of all
// materials. What is seen is found first and then shaded once for each texel and triangle, so that
// triangles smaller than texels cost little. All cores; the same bytes for any number of threads.
#pragma once

#include <cstddef>
#include <cstdint>
#include <glm/glm.hpp>
#include <memory>
#include <span>
#include <vector>

#include "rilievo/core/camera.h"
#include "rilievo/render/shading/picture_shader.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

class PictureRasterizer {
 public:
  // Memory that pictures of up to `size` texels a side take while they are drawn, theirs included;
  // besides a few hundred kilobytes for each thread.
  [[nodiscard]] static std::size_t bytes(int size, int samples);

  // `scene` must be valid and outlive it. Makes the smaller levels of its textures.
  explicit PictureRasterizer(const Scene& scene);
  PictureRasterizer(PictureRasterizer&&) noexcept;
  PictureRasterizer& operator=(PictureRasterizer&&) noexcept;
  ~PictureRasterizer();

  // The opaque and masked parts of `objects`, placed by `poses` (of all objects). Requires a
  // perspective camera with all of the objects in front of its eye, and 1 or 4 samples a texel.
  // What lies before the near plane is drawn on it.
  void draw(const Camera& camera, std::span<const std::uint32_t> objects,
            std::span<const glm::mat4> poses, int samples, RasterPicture& picture);

  // window_z of the farthest of all surfaces along the rays through the texels' centres, hidden
  // ones and faces turned away included; 1: nothing. Rows from the bottom. Of the same objects as
  // draw().
  void draw_farthest(const Camera& camera, std::span<const std::uint32_t> objects,
                     std::span<const glm::mat4> poses, std::vector<float>& depth);

  // Memory that the scene's textures take beyond the Scene's own.
  [[nodiscard]] std::size_t texture_bytes() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rilievo
