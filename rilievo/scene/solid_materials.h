// Which materials blend by name only?
//
// Exporters often declare materials as blended of which no texel lets anything through. Drawn as
// opaque they look the same, without the order of triangles that blending depends on; and pictures
// with depth can show them.
#pragma once

#include "rilievo/scene/scene.h"

namespace rilievo {

// Makes those blended materials opaque whose alpha is 1 everywhere: the factor, all texels of the
// texture, and the colours of all vertices of meshes that have them. Requires indices that are
// valid or -1.
void make_solid_materials_opaque(Scene& scene);

}  // namespace rilievo
