#include "rilievo/representation/load_representation.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <utility>

#include "rilievo/io/world_attributes.h"
#include "rilievo/representation/kind_methods.h"
#include "rilievo/representation/kinds.h"

namespace rilievo {

Result<LoadedRepresentation> load_representation(const std::filesystem::path& file) {
  // What it says of itself first: some kinds read its pictures as they need them.
  Result<PictureFile> loaded = load_picture_file(file, {0, 0});
  if (!loaded) return loaded.error();
  LoadedRepresentation made;
  made.kind = kind_of_file(kinds(), loaded->attributes);
  if (!made.kind)
    return Error{file.string(), fmt::format("holds plain pictures, nothing that was baked ({})",
                                            fmt::join(kind_names(), ", "))};
  if (!made.kind->reads_later) {
    loaded = load_picture_file(file);
    if (!loaded) return loaded.error();
  }
  const Result<WorldSpace> world = world_from(loaded->attributes.file);
  if (!world) return Error{file.string(), world.error().reason};
  Result<std::unique_ptr<Representation>> representation =
      made.kind->load(std::move(*loaded), file);
  if (!representation) return representation.error();
  made.representation = std::move(*representation);
  made.representation->world = *world;
  return made;
}

}  // namespace rilievo
