// glTF 2.0 -> Scene. Internal to loading; throws LoadFault.
#pragma once

#include "rilievo/io/load_context.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// `file`: a .glb, or a .gltf's JSON. Not yet finished, nor validated.
[[nodiscard]] Scene read_gltf(Bytes file, LoadContext& context);

}  // namespace rilievo
