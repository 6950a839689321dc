// Converged frames of a slow source, and what they show from elsewhere without depth per pixel.
#pragma once

#include <memory>
#include <string>

#include "rilievo/capture/capture_source.h"
#include "rilievo/core/camera.h"
#include "rilievo/core/color.h"
#include "rilievo/core/image.h"
#include "rilievo/core/result.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/scene/scene.h"

namespace rilievo::bench {

struct TracedFrame {
  Camera camera;
  Rgba8Image color;
  double median_z = 0;  // eye_z, metres, of what it shows; 0: nothing
};

// Frames by raytrace or exec:PROGRAM.
class TracedFrames {
 public:
  // Of `side` x `side` texels a pixel, with so many samples each: a texel shows one surface, a
  // pixel the mean of its texels as displayed. `scene` must outlive the object. Fails where the
  // source cannot be made.
  [[nodiscard]] static Result<TracedFrames> create(const Scene& scene, const std::string& source,
                                                   int side, int samples);
  // Fails where the source does.
  [[nodiscard]] Result<TracedFrame> frame(const Camera& camera) const;

 private:
  TracedFrames(const Scene& scene, std::unique_ptr<RayScene> rays, int side, int samples)
      : scene_(&scene), rays_(std::move(rays)), side_(side), samples_(samples) {}

  const Scene* scene_;
  std::unique_ptr<RayScene> rays_;
  std::unique_ptr<CaptureSource> source_;
  int side_, samples_;
  bool by_program_ = false;  // which has a sky of its own, and mixes surfaces in a texel
};

// What `eye` sees of the frame, if all of it stands on the plane at its median depth: bilinear.
// Beyond its edges its outermost pixels go on.
[[nodiscard]] Rgba8Image draw_on_plane(const TracedFrame& frame, const Camera& eye);

}  // namespace rilievo::bench
