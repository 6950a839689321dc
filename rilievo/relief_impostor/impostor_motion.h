// How far the surface of an impostor moves by itself: skins and morph targets.
#pragma once

#include <span>

#include "rilievo/relief_impostor/impostor_workers.h"
#include "rilievo/scene/bend.h"

namespace rilievo {

// Sets how the surface of an impostor's objects moves at most: what ImpostorObject has of speed,
// jump and period. `bounds`: deformation_bounds(). The objects are where they are at `placed`.
void set_deformation(const Scene& scene, std::span<const DeformationBounds> bounds, double placed,
                     ImpostorObject& object);

}  // namespace rilievo
