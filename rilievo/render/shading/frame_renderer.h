// Which renderers draw whole frames of a scene on processors, without OpenGL?
//
// The rasteriser (render/raster/raster_renderer.h) and ray casting (render/rays/ray_renderer.h).
// They draw the opaque and masked parts, with the same shading, textures and samples as OpenGL
// does; blended parts and the sky are left out. All cores; the result does not depend on the number
// of threads.
#pragma once

#include "rilievo/core/camera.h"
#include "rilievo/core/result.h"
#include "rilievo/render/shading/picture_shader.h"

namespace rilievo {

// Draws frames of one scene.
class FrameRenderer {
 public:
  virtual ~FrameRenderer() = default;

  // Places each object at `time` (seconds). Fails if memory does not suffice.
  virtual Result<> set_time(double time) = 0;
  // Draws the frame of a perspective camera with 1 or 4 samples per pixel. What lies before the
  // near plane is invisible.
  virtual Result<> draw(const Camera& camera, int samples, RasterPicture& picture) = 0;
  // The objects and depths at pixel centres.
  virtual Result<> draw_objects(const Camera& camera, ObjectPicture& picture) = 0;
};

}  // namespace rilievo
