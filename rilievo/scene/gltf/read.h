// glTF 2.0 -> Scene. Internal to loading; throws LoadError.
//
// Read here and not by a library: Debian 12's assimp (5.2.5) reads quantised attributes as garbage
// without an error and crashes on damaged files; tinygltf and cgltf leave the checks of indices,
// sizes and extensions, which is most of the work, to their caller.
#pragma once

#include "rilievo/io/load_context.h"
#include "rilievo/scene/scene.h"

namespace rilievo {

// `file`: a .glb, or a .gltf's JSON. Not yet finished, nor validated.
[[nodiscard]] Scene read_gltf(Bytes file, LoadContext& context);

}  // namespace rilievo
