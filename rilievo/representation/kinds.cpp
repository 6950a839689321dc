#include "rilievo/representation/kinds.h"

#include <algorithm>
#include <array>

#include "rilievo/environment_nodes/environment_kind.h"
#include "rilievo/layered_impostor/layered_kind.h"
#include "rilievo/layered_relief/relief_kind.h"

namespace rilievo {

std::span<const Kind* const> kinds() {
  static const std::array all{
      &layered_impostor_kind(),
      &environment_nodes_kind(),
      &layered_relief_kind(),
  };
  return all;
}

const Kind* find_kind(std::span<const Kind* const> kinds, std::string_view name) {
  const auto found =
      std::find_if(kinds.begin(), kinds.end(), [&](const Kind* k) { return k->name == name; });
  return found == kinds.end() ? nullptr : *found;
}

const Kind* kind_of_file(std::span<const Kind* const> kinds, const FileAttributes& attributes) {
  const auto found = std::find_if(kinds.begin(), kinds.end(),
                                  [&](const Kind* k) { return k->matches(attributes); });
  return found == kinds.end() ? nullptr : *found;
}

}  // namespace rilievo
