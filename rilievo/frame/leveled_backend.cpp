#include "rilievo/frame/leveled_backend.h"

namespace rilievo {

Result<std::unique_ptr<LeveledBackend>> LeveledBackend::create(const Backend& backend,
                                                               ObjectLevels levels) {
  std::unique_ptr<LeveledBackend> made(new LeveledBackend(std::move(levels)));
  Result<std::unique_ptr<Backend>> of = backend.make_backend(made->levels_.leveled.scene);
  if (!of) return of.error();
  made->backend_ = std::move(*of);
  return {std::move(made)};
}

}  // namespace rilievo
