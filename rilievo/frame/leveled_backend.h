// A backend of a scene whose objects show their levels of detail.
#pragma once

#include <memory>
#include <utility>

#include "rilievo/frame/backend.h"
#include "rilievo/frame/object_levels.h"

namespace rilievo {

// Levels, and the backend that draws their scene. For choosers, which keep it: the backend's frames
// are drawn from the levels that a chooser sets (show_level, choose_levels).
class LeveledBackend {
 public:
  // A backend like `backend`. Fails where it cannot be made.
  [[nodiscard]] static Result<std::unique_ptr<LeveledBackend>> create(const Backend& backend,
                                                                      ObjectLevels levels);

  [[nodiscard]] ObjectLevels& levels() { return levels_; }
  [[nodiscard]] Backend& backend() { return *backend_; }

 private:
  explicit LeveledBackend(ObjectLevels levels) : levels_(std::move(levels)) {}

  ObjectLevels levels_;
  std::unique_ptr<Backend> backend_;
};

}  // namespace rilievo
