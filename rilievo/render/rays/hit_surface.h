// What is the surface like where a ray hits it?
//
// Position, normal, and the values of the material and its textures, for shading_model.h. Any
// thread.
#pragma once

#include <glm/glm.hpp>

#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/render/shading/shading_model.h"

namespace rilievo {

// The mesh that a hit shows, and its material.
[[nodiscard]] int mesh_of_hit(const RayScene& scene, const RayHit& hit);
[[nodiscard]] const SurfaceMaterial& surface_material(const RayScene& scene, const RayHit& hit);

// The surface at a hit of `ray`, one of `rays`, which say how large a texel is there. `eye` is
// where they come from; the surface's position is relative to it. World axes.
[[nodiscard]] shading_model::SurfacePoint<float> surface_of_hit(const RayScene& scene,
                                                                const RayHit& hit,
                                                                const PictureRays& rays,
                                                                const glm::vec3& ray,
                                                                const glm::dvec3& eye);

}  // namespace rilievo
