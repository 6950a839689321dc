// Who finds which triangle each sample of a whole frame shows?
//
// The rasteriser (render/raster/frame_raster.h) or rays (render/rays/ray_visibility.h). Tiles then
// take over the samples, and shade what nothing else hides (render/raster/polygon_tiles.h). Opaque
// and masked parts only. All cores; the result does not depend on the number of threads.
#pragma once

#include <cstdint>
#include <span>

#include "rilievo/core/camera.h"
#include "rilievo/core/result.h"
#include "rilievo/render/cross_fade.h"
#include "rilievo/render/object_work.h"
#include "rilievo/render/placed_scene.h"
#include "rilievo/render/shading/picture_shader.h"

namespace rilievo {

// Finds the visible triangles of one scene's frames.
class FrameVisibility {
 public:
  virtual ~FrameVisibility() = default;

  // Finds 1 or 4 samples a pixel of `objects`, as `placed` places them, and of those that fade
  // within their ranges. Does not cull. Fails where the frame is too large or memory does not
  // suffice. Requires a perspective camera.
  virtual Result<> find_visible(const Camera& camera, int samples, const PlacedScene& placed,
                                std::span<const std::uint32_t> objects,
                                std::span<const CrossFade> fading) = 0;

  // The last frame: its samples; the meshes, in the order of their triangles; and both ready to be
  // shaded. Valid until the next one.
  [[nodiscard]] virtual const SampleBuffer& seen() const = 0;
  [[nodiscard]] virtual std::span<const PlacedMesh> meshes() const = 0;
  [[nodiscard]] virtual PictureView view(const Camera& camera) = 0;
  // What that took, of each of meshes(); empty: not known.
  [[nodiscard]] virtual std::span<const MeshWork> work() const { return {}; }
};

}  // namespace rilievo
