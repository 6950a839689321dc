// Which kinds of representation have a form for browsers?
//
// Like representation/kinds.h a list of rows: this folder knows the kinds, what lies above knows
// them by name.
#pragma once

#include <string_view>
#include <vector>

#include "rilievo/kind/kind.h"
#include "rilievo/web_walk/walk_writer.h"

namespace rilievo {

// The names of the kinds that can be written, the best for a walk first.
[[nodiscard]] std::vector<std::string_view> walk_kinds();

// Writes a representation and adds it to `manifest`. Fails for other kinds.
[[nodiscard]] Result<> add_to_walk(const Kind& kind, const Representation& representation,
                                   WalkWriter& writer, WalkManifest& manifest,
                                   const WalkOptions& options);

}  // namespace rilievo
