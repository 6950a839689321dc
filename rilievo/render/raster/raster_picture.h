// Objects rasterised without OpenGL.
//
// Gives the picture that nailboard/gl/nailboard_atlas.h captures by OpenGL: nearest depth,
// coverage, and the shading of render/opengl/scene_shaders.h for all materials. For machines whose
// OpenGL runs on the CPU. First finds the visible triangles, then shades once for each pair of a
// texel and a visible triangle, so that triangles smaller than texels cost little. Uses all cores;
// the result does not depend on the number of threads.
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

// eye_z of window_z, rows from the bottom, 1 where there is nothing. Requires a perspective camera.
[[nodiscard]] Image<float> eye_z_from_window_z(std::span<const float> window_z,
                                               const Camera& camera);

// Rasterises pictures of one scene.
class PictureRasterizer {
 public:
  // The memory that drawing pictures of up to `size` texels a side takes, including the picture,
  // plus a few hundred kilobytes for each thread.
  [[nodiscard]] static std::size_t bytes(int size, int samples);

  // `scene` must be valid and outlive the object. Makes the mip levels of its textures.
  explicit PictureRasterizer(const Scene& scene);
  PictureRasterizer(PictureRasterizer&&) noexcept;
  PictureRasterizer& operator=(PictureRasterizer&&) noexcept;
  ~PictureRasterizer();

  // Captures the opaque and masked parts of `objects`, wherever they are, placed by `poses` (of all
  // objects), as cast_picture() does by rays: eye_z, object and linear light, with a sky or
  // without. Requires a valid perspective camera of at most SampleRaster::kMaxSize texels a side,
  // and 1 or 4 samples, or a staggered one.
  [[nodiscard]] DepthImage capture(const Camera& camera, std::span<const std::uint32_t> objects,
                                   std::span<const glm::mat4> poses, int samples,
                                   bool with_sky = false, bool staggered = false);
  // eye_z of the farthest of all surfaces along the rays through the texels' centres, including
  // hidden ones and back faces; kNoDepth if there is none. Surfaces beyond the far plane count as
  // on it.
  [[nodiscard]] Image<float> capture_farthest(const Camera& camera,
                                              std::span<const std::uint32_t> objects,
                                              std::span<const glm::mat4> poses);

  // Draws the opaque and masked parts of `objects`, placed by `poses` (of all objects). Requires a
  // perspective camera with all of the objects in front of its eye, and 1 or 4 samples per texel.
  // Parts in front of the near plane are drawn on it.
  void draw(const Camera& camera, std::span<const std::uint32_t> objects,
            std::span<const glm::mat4> poses, int samples, RasterPicture& picture);

  // The same in two steps. place() finds where the parts of such objects are now; draw() and
  // draw_farthest() of what was placed read neither objects nor poses, which may change meanwhile.
  // Any thread may call place() while one thread draws.
  void place(const Camera& camera, std::span<const std::uint32_t> objects,
             std::span<const glm::mat4> poses, std::vector<PlacedMesh>& placed) const;
  void draw(const Camera& camera, std::span<const PlacedMesh> placed, int samples,
            RasterPicture& picture);
  void draw_farthest(const Camera& camera, std::span<const PlacedMesh> placed,
                     std::vector<float>& depth);

  // Draws the object identifiers of the same picture at the texels' centres.
  void draw_objects(const Camera& camera, std::span<const std::uint32_t> objects,
                    std::span<const glm::mat4> poses, ObjectPicture& picture);

  // Draws the window_z of the farthest of all surfaces along the rays through the texels' centres,
  // including hidden ones and back faces; 1 if there is none. Rows from the bottom. Objects as in
  // draw(), but all of them beyond the near plane: what lies in front of it counts as nothing.
  void draw_farthest(const Camera& camera, std::span<const std::uint32_t> objects,
                     std::span<const glm::mat4> poses, std::vector<float>& depth);

  // The scene's materials, which others may share.
  [[nodiscard]] const std::shared_ptr<const SurfaceMaterials>& materials() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rilievo
