// The kinds of representation as methods: baked before the first frame, or loaded from a file.
//
// Surroundings: all that stands still by one bake, what moves as polygons. Objects: each heavy one
// by a bake of its own.
#pragma once

#include "rilievo/method/method.h"
#include "rilievo/representation/bake_objects.h"

namespace rilievo {

// Bakes the backend's scene as it is placed, and makes the frames. The error names the option.
[[nodiscard]] Result<Method> make_kind_method(const KindMethod& method,
                                              const MethodOptions& options, Backend& backend);

// Relief impostors, which no kind is: their pictures are shaded while frames are drawn.
[[nodiscard]] Result<Method> make_relief_impostors(const MethodOptions& options, Backend& backend);

// Objects to bake before the first frame.
[[nodiscard]] ObjectDrawablesOptions object_options(const PreparedKind& kind, std::size_t max_bytes,
                                                    const Progress& progress);

}  // namespace rilievo
