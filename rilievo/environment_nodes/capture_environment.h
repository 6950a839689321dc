// What does a Scene look like all around a point? (S3.1)
//
// Six z-buffered faces by rays, without OpenGL, colours as cast_picture's. The sky is drawn where
// nothing is met: colour without depth. Same bytes for any number of threads.
#pragma once

#include "rilievo/core/depth_image.h"
#include "rilievo/render/rays/ray_scene.h"

namespace rilievo {

struct EnvironmentOptions {
  int size = 512;  // texels of a face's side, 2 to 4096
  double z_near = 0.05, z_far = 1000;
  bool sky = true;
};

[[nodiscard]] Result<EnvironmentMap> capture_environment(const RayScene& scene,
                                                         const glm::dvec3& eye,
                                                         const EnvironmentOptions& options);

}  // namespace rilievo
