// A folder of files for the time of a process, removed at its end.
//
// A process that is killed leaves its folder behind. So each is locked as long as its process
// lives, and whoever makes one removes those that nobody has locked for a minute. Any thread.
#pragma once

#include <filesystem>
#include <string_view>

#include "rilievo/core/result.h"

namespace rilievo {

// A folder that is removed with the object.
class ScratchFolder {
 public:
  // Makes PREFIX-XXXXXX, of random letters, among the system's temporary files, for this user
  // alone; and removes those of the same prefix that dead processes of this user left.
  [[nodiscard]] static Result<ScratchFolder> create(std::string_view prefix);
  ScratchFolder() = default;  // none
  ~ScratchFolder();
  ScratchFolder(ScratchFolder&& other) noexcept;
  ScratchFolder& operator=(ScratchFolder&& other) noexcept;

  // Empty: there is none.
  [[nodiscard]] const std::filesystem::path& path() const { return path_; }

 private:
  void remove();

  std::filesystem::path path_;
  int lock_ = -1;  // a descriptor of the folder
};

}  // namespace rilievo
