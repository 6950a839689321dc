// What does a Scene look like in all directions from a point? (S3.1)
//
// Six z-buffered faces by ray casting, without OpenGL, with the colours of cast_picture. Where no
// surface is hit, the sky has colour but no depth. The result does not depend on the number of
// threads.
#pragma once

#include "rilievo/core/depth_image.h"
#include "rilievo/render/rays/ray_scene.h"

namespace rilievo {

// The resolution and the range of the faces.
struct EnvironmentOptions {
  int size = 512;  // texels a side of a face, 2 to 4096
  double z_near = 0.05, z_far = 1000;
  bool sky = true;
};

// Captures the faces at `eye` (world space). The error says which option is out of range.
[[nodiscard]] Result<EnvironmentMap> capture_environment(const RayScene& scene,
                                                         const glm::dvec3& eye,
                                                         const EnvironmentOptions& options);

}  // namespace rilievo
