// Which files are half written at this moment?
//
// The list has a fixed size, so that a signal handler can read it and remove the files.
#pragma once

#include <string>

namespace rilievo {

// Lists `path` for as long as the object lives. Paths longer than PATH_MAX and files beyond the
// 64th are not listed. Any thread.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(const std::string& path) noexcept;
  ~UnfinishedFile();
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;

 private:
  int slot_ = -1;
};

// Removes the temporary files that write_file() has open. Safe in a signal handler: only reads the
// list and calls unlink(). For a program that is about to end: writes in progress fail, and a file
// that another thread opens at the same time can remain.
void remove_unfinished_files() noexcept;

}  // namespace rilievo
