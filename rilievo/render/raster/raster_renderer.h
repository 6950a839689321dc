// How does our rasteriser draw whole frames, without OpenGL?
//
// Of the objects in view, all triangles; those that reach behind the eye are cut at the near plane.
#pragma once

#include <memory>

#include "rilievo/render/shading/frame_renderer.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// Rasterises frames of one scene. Frames have at most SampleRaster::kMaxSize pixels a side.
class RasterRenderer final : public FrameRenderer {
 public:
  // `scene` must be valid and outlive the object. Makes the mip levels of its textures.
  explicit RasterRenderer(const Scene& scene);
  ~RasterRenderer() override;

  Result<> set_time(double time) override;
  Result<> draw(const Camera& camera, int samples, RasterPicture& picture) override;
  Result<> draw_objects(const Camera& camera, ObjectPicture& picture) override;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace rilievo
