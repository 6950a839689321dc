// The file that a program of --source exec:PROGRAM opens.
#pragma once

#include <string>

#include "apps/rilievo/scene_file.h"
#include "rilievo/core/result.h"
#include "rilievo/core/scratch_folder.h"
#include "rilievo/method/method.h"
#include "rilievo/scene/scene.h"

namespace rilievo::app {

// A scene's own file, or one that is written for the program and removed with the object.
class ProgramScene {
 public:
  // The file of the scene `named` (a path or builtin:NAME), opened with `limits`, if it is what
  // frames show. A built-in scene has none, and --up and --units change what a file says: then
  // `shown` is written, in metres with y up. Fails where that cannot be written.
  [[nodiscard]] static Result<ProgramScene> create(const std::string& named,
                                                   const FileLimits& limits, const Scene& shown);
  // For methods: sets options.program_scene where their source is a program and --program-scene
  // names no file of its own. Valid as long as the object.
  [[nodiscard]] static Result<ProgramScene> create(const std::string& named,
                                                   const FileLimits& limits, const Scene& shown,
                                                   MethodOptions& options);
  [[nodiscard]] const std::string& file() const { return file_; }
  // Was it written for the program?
  [[nodiscard]] bool written() const { return !scratch_.path().empty(); }

 private:
  std::string file_;
  ScratchFolder scratch_;
};

}  // namespace rilievo::app
