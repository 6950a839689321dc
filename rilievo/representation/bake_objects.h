// Baked representations that stand for single objects of a scene, wherever they are.
//
// Objects of one model whose poses differ by a translation share a representation. Light is baked
// into it, and only translations preserve sunlight; light from lamps and its falloff move along. An
// object with another orientation gets its own. A moving object carries its representation along,
// with the light at the time of the bake.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "rilievo/capture/capture_source.h"
#include "rilievo/kind/kind.h"
#include "rilievo/render/placed_scene.h"
#include "rilievo/representation/object_drawable.h"

namespace rilievo {

// Which objects to bake, and how.
struct ObjectDrawablesOptions {
  OptionValues bake, draw;            // of the kind
  std::uint64_t min_triangles = 300;  // lighter objects get none
  // Limit on the sum of DrawableFactory::expected_bytes; objects with the most triangles come
  // first.
  std::size_t max_bytes = std::size_t(256) << 20;
  Progress progress;  // of all objects together
};

// Bakes the scene as it is placed; `source` shows the same. Objects that nothing can be captured
// of, and those beyond the memory limit, get no representation. `factory` must outlive the
// drawables.
[[nodiscard]] Result<std::vector<ObjectDrawable>> bake_object_drawables(
    const PlacedScene& placed, CaptureSource& source, const Kind& kind, DrawableFactory& factory,
    const ObjectDrawablesOptions& options);

// Bakes all objects that stand still as one: a thing of many parts that hide each other, which
// would overlap where each is drawn for itself. Does not use options.min_triangles. Fails if
// nothing stands still or max_bytes does not suffice.
[[nodiscard]] Result<ObjectDrawable> bake_together_drawable(const PlacedScene& placed,
                                                            CaptureSource& source, const Kind& kind,
                                                            DrawableFactory& factory,
                                                            const ObjectDrawablesOptions& options);

// The surroundings to bake, and how.
struct SurroundingsOptions {
  OptionValues bake, draw;  // of the kind
  Box eyes = {};            // the region of the eyes, world space
  double beyond = 0;        // metres from `eyes` to the nearest point of an object's bounds
  Progress progress;
};

// Bakes all objects that stand still and lie beyond a distance as one. Fails if there are none.
[[nodiscard]] Result<ObjectDrawable> bake_surroundings_drawable(const PlacedScene& placed,
                                                                CaptureSource& source,
                                                                const Kind& kind,
                                                                DrawableFactory& factory,
                                                                const SurroundingsOptions& options);

}  // namespace rilievo
