// The pieces of the scene `bridge` that have to fit together.
#pragma once

#include <cstdint>

#include "rilievo/scene/scene.h"

namespace rilievo {

inline constexpr float kBridgeHalfLength = 25.0f;
inline constexpr float kBridgeHalfWidth = 3.6f;  // to the outer faces of the walls

// Height of the road's surface at x, on the bridge and beyond.
[[nodiscard]] float deck_height(float x);

// Adds the bridge as about twenty objects of `triangles` in all.
void add_stone_bridge(Scene& scene, int material, double triangles, std::uint64_t seed);

}  // namespace rilievo
