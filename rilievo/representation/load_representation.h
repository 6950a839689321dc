// A baked file: which kind it holds, and what.
#pragma once

#include <filesystem>
#include <memory>

#include "rilievo/kind/kind.h"

namespace rilievo {

// The content of a file.
struct LoadedRepresentation {
  const Kind* kind = nullptr;
  std::unique_ptr<Representation> representation;
};

// Loads a file that `rilievo bake` or a kind's save() has written. Fails where it cannot be read,
// or holds plain pictures.
[[nodiscard]] Result<LoadedRepresentation> load_representation(const std::filesystem::path& file);

}  // namespace rilievo
