// How OpenGL draws each kind of representation.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "rilievo/kind/kind.h"

namespace rilievo {

struct DrawableRow {
  std::string_view kind;  // Kind::name
  // Compiles the kind's shaders. Needs a current OpenGL context.
  Result<std::unique_ptr<DrawableFactory>> (*make_factory)() = nullptr;
};

[[nodiscard]] std::span<const DrawableRow> drawable_rows();

// Of the kind of that name in `rows`, which must have it.
[[nodiscard]] Result<std::unique_ptr<DrawableFactory>> make_factory(
    std::span<const DrawableRow> rows, std::string_view kind);

}  // namespace rilievo
