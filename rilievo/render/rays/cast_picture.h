// What does a camera see of a Scene, by one ray a texel?
//
// The picture that the rasteriser takes, without OpenGL: the same surfaces, depths (eye_z) and
// object identifiers. Colour is the diffuse part of its shading (base colour, lights, sky; no
// mirroring, no normal maps): enough to tell texels apart and to measure warps. Blended parts and
// the sky are left out. Same bytes for any number of threads.
#pragma once

#include "rilievo/core/depth_image.h"
#include "rilievo/render/rays/ray_scene.h"

namespace rilievo {

// Requires a valid camera.
[[nodiscard]] DepthImage cast_picture(const RayScene& scene, const Camera& camera);

// The colour of one texel: linear, opaque. `direction` is the ray's, unit.
[[nodiscard]] glm::vec4 shade_hit(const RayScene& scene, const RayHit& hit,
                                  const glm::vec3& position, const glm::vec3& direction);

// The ray of a raster position, from where the camera stops looking towards where it would rather
// see: an ordinary camera looks from its near plane, a back-perspective one from its far plane
// towards the apex, so that the first hit is the farthest from the apex (S2.1). `eye_z` along it is
// eye_z_start + t * eye_z_step for t in [0, 1].
struct CameraRay {
  glm::dvec3 origin, direction;
  double eye_z_start = 0, eye_z_step = 0;
};
[[nodiscard]] CameraRay camera_ray(const Camera& camera, const glm::dvec2& raster);

}  // namespace rilievo
