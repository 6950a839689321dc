// What does a camera see of a Scene along each line of sight, hidden surfaces included? (S4.1)
//
// One ray a texel, followed through everything: a sample for each surface that it crosses, backs of
// single-sided surfaces too, since an eye elsewhere may see their fronts. Depths are eye_z. Colour
// is that of cast_picture.h; where a single-sided surface is met from behind, that of its front.
// Same bytes for any number of threads.
#pragma once

#include "rilievo/core/depth_image.h"
#include "rilievo/render/rays/ray_scene.h"

namespace rilievo {

struct CastLayersOptions {
  // Surfaces that lie closer together along the ray become one: the nearest. Metres of eye_z.
  double merge = 0.0;
  // No more samples than that on one ray.
  int max_layers = 256;
};

// Requires a valid camera: parallel, or perspective.
[[nodiscard]] LayeredDepthImage cast_layers(const RayScene& scene, const Camera& camera,
                                            const CastLayersOptions& options = {});

}  // namespace rilievo
