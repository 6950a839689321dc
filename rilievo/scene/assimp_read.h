// OBJ, PLY and STL -> Scene, by assimp. Internal to loading; throws LoadFault.
#pragma once

#include "rilievo/scene/load_context.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// `extension`: "obj", "ply" or "stl". Not yet finished, nor validated.
[[nodiscard]] Scene read_with_assimp(Bytes file, const std::string& extension,
                                     LoadContext& context);

}  // namespace rilievo
