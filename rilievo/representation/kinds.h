// The list of kinds of representation.
//
// To add a kind, add its folder and a line in kinds.cpp and gl/factories.cpp.
#pragma once

#include <filesystem>
#include <span>
#include <string_view>

#include "rilievo/kind/kind.h"

namespace rilievo {

// All kinds.
[[nodiscard]] std::span<const Kind* const> kinds();

// The kind of that name in `kinds`; null if there is none.
[[nodiscard]] const Kind* find_kind(std::span<const Kind* const> kinds, std::string_view name);

// The kind that a file with these attributes contains; null for a file of plain pictures.
[[nodiscard]] const Kind* kind_of_file(std::span<const Kind* const> kinds,
                                       const FileAttributes& attributes);

}  // namespace rilievo
