// What does a kind need, besides a scene, to be baked and drawn as the command line asks for it?
#pragma once

#include <cstddef>
#include <memory>
#include <span>

#include "apps/rilievo/kinds.h"
#include "apps/rilievo/progress.h"
#include "rilievo/kind/kind.h"
#include "rilievo/representation/bake_objects.h"
#include "rilievo/representation/drawable_rows.h"

namespace rilievo::app {

// A kind with its options for baking and drawing, and its factory.
struct PreparedKind {
  OptionValues bake, draw;
  std::unique_ptr<DrawableFactory> factory;
};

// `rows` are a backend's factories. The error names the option.
[[nodiscard]] Result<PreparedKind> prepare(const KindMethod& method, const KindOptions& options,
                                           std::span<const DrawableRow> rows);

// Objects to bake before the first frame. `progress` outlives the result.
[[nodiscard]] ObjectDrawablesOptions object_options(const PreparedKind& kind, std::size_t max_bytes,
                                                    Progress& progress);

}  // namespace rilievo::app
