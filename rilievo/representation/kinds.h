// The one list of kinds of representation.
//
// To add a kind: its folder, and a line in kinds.cpp and in gl/factories.cpp.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "rilievo/kind/kind.h"

namespace rilievo {

[[nodiscard]] std::span<const Kind* const> kinds();

// Of a list of kinds; null if it has none of that name.
[[nodiscard]] const Kind* find_kind(std::span<const Kind* const> kinds, std::string_view name);

// The kind that a file with these attributes says it holds; null if it holds plain pictures.
[[nodiscard]] const Kind* kind_of_file(std::span<const Kind* const> kinds,
                                       const FileAttributes& attributes);

}  // namespace rilievo
