#include "rilievo/method/open_baked.h"

#include <utility>

#include "rilievo/method/method.h"
#include "rilievo/representation/load_representation.h"

namespace rilievo {

Result<BakedFrames> open_baked(const std::filesystem::path& file, Backend& backend,
                               const BakedOptions& options) {
  Result<LoadedRepresentation> loaded = load_representation(file);
  if (!loaded) return loaded.error();
  const std::string name =
      options.method.empty() ? std::string(loaded->kind->name) : options.method;
  if (kind_method(name).kind != loaded->kind)
    return Error{file.string(),
                 "holds " + std::string(loaded->kind->name) + ", which is not drawn as " + name};
  BakedFrames baked;
  baked.kind = loaded->kind;
  baked.bounds = loaded->representation->bounds();
  baked.vantage = loaded->representation->vantage();
  baked.walk = loaded->representation->walk();
  MethodOptions methods;
  methods.kinds = options.kind;
  methods.outlines = options.outlines;
  methods.sky = options.sky;
  std::vector<StoredBeside> beside;
  for (const std::filesystem::path& other : options.beside) {
    Result<LoadedRepresentation> more = load_representation(other);
    if (!more) return more.error();
    beside.push_back({more->kind, std::move(more->representation)});
  }
  Result<Method> method = make_stored_method(name, methods, backend,
                                             std::move(loaded->representation), std::move(beside));
  if (!method) return Error{file.string(), method.error().message()};
  baked.frames = std::move(method->frames);
  return baked;
}

}  // namespace rilievo
