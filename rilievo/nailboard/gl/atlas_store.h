// Pictures in an atlas of textures, captured by OpenGL or by the rasteriser.
#pragma once

#include <memory>

#include "rilievo/core/result.h"
#include "rilievo/nailboard/nailboard_store.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo {

// Makes an empty store of `renderer`'s scene, which must outlive it. Needs a current OpenGL
// context. Fails where the atlas cannot be allocated.
[[nodiscard]] Result<std::unique_ptr<NailboardStore>> make_atlas_store(
    SceneRenderer& renderer, const NailboardStoreOptions& options);

}  // namespace rilievo
