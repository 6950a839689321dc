// How does OpenGL draw each kind of representation?
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "rilievo/kind/kind.h"

namespace rilievo {

// A kind and the OpenGL backend that draws it.
struct DrawableRow {
  std::string_view kind;  // Kind::name
  // Compiles the kind's shaders. Needs a current OpenGL context.
  Result<std::unique_ptr<DrawableFactory>> (*make_factory)() = nullptr;
};

// The backends of all kinds.
[[nodiscard]] std::span<const DrawableRow> drawable_rows();

// Compiles the shaders of the kind of that name, which must be in `rows`.
[[nodiscard]] Result<std::unique_ptr<DrawableFactory>> make_factory(
    std::span<const DrawableRow> rows, std::string_view kind);

}  // namespace rilievo
