// The way in which a backend draws each kind of representation.
#pragma once

#include <memory>
#include <span>
#include <string_view>

#include "rilievo/kind/kind.h"

namespace rilievo {

// A kind and what draws it by one backend.
struct DrawableRow {
  std::string_view kind;  // Kind::name
  // OpenGL's compile the kind's shaders and need a current context.
  Result<std::unique_ptr<DrawableFactory>> (*make_factory)() = nullptr;
};

// Makes the factory of the kind of that name. Fails if it is not in `rows`.
[[nodiscard]] Result<std::unique_ptr<DrawableFactory>> make_factory(
    std::span<const DrawableRow> rows, std::string_view kind);

}  // namespace rilievo
