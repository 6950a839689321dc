// Pictures in memory, captured by the rasteriser.
#pragma once

#include <memory>

#include "rilievo/core/result.h"
#include "rilievo/nailboard/nailboard_store.h"
#include "rilievo/render/placed_scene.h"

namespace rilievo {

// Would make_software_store() fail? The error says why.
[[nodiscard]] Result<> check_software_store(const NailboardStoreOptions& options);

// Makes an empty store; `placed` must outlive it. Fails if max_bytes does not suffice for captures,
// if the samples are neither 1 nor 4, and for OpenGL's captures.
[[nodiscard]] Result<std::unique_ptr<NailboardStore>> make_software_store(
    const PlacedScene& placed, const NailboardStoreOptions& options);

}  // namespace rilievo
