// Turns and scales a scene whose file has another axis up, or other units than metres.
#pragma once

#include "rilievo/scene/scene.h"

namespace rilievo {

// The rotation that takes coordinates with `up` as the upward axis to those with +y up: z up
// becomes (x, z, -y), x up becomes (-y, x, z).
[[nodiscard]] glm::dmat3 upright_from(UpAxis up);

// Makes a scene in `metres_per_unit` (positive) and with `up` up one in metres with +y up, with its
// origin, lights and cameras; Scene::world remembers both. Light keeps its strength on surfaces.
void take_as(Scene& scene, UpAxis up, double metres_per_unit);

}  // namespace rilievo
