// What does a camera see of a Scene along each line of sight, including hidden surfaces? (S4.1)
//
// One ray for each texel, followed through everything: one sample for each surface that it crosses,
// including backs of single-sided surfaces, because other eyes can see their fronts. Depths are
// eye_z. Colours are those of cast_picture.h; the back of a single-sided surface has the colour of
// its front. The result does not depend on the number of threads.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>

#include "rilievo/core/depth_image.h"
#include "rilievo/render/rays/ray_scene.h"

namespace rilievo {

// Which surfaces become samples.
struct CastLayersOptions {
  // Surfaces within this distance along the ray become one, the nearest. Metres of eye_z.
  double merge = 0.0;
  // The largest number of samples on a ray.
  int max_layers = 256;
  std::span<const std::uint32_t> objects = {};  // indices into Scene::objects; empty: all
  // Smoother surfaces are shaded as if they were so rough.
  float least_roughness = 0;
};

// Casts a picture. Requires a valid parallel or perspective camera.
[[nodiscard]] LayeredDepthImage cast_layers(const RayScene& scene, const Camera& camera,
                                            const CastLayersOptions& options = {});

// The colour of a hit of the ray through the centre of texel (x, y), y from the top; none: the hit
// becomes no sample. Called by any number of threads at once.
using LayerShade = std::function<std::optional<glm::vec4>(const RayHit& hit, int x, int y)>;
// The same surfaces with other colours.
[[nodiscard]] LayeredDepthImage cast_layers(const RayScene& scene, const Camera& camera,
                                            const CastLayersOptions& options,
                                            const LayerShade& shade);

}  // namespace rilievo
