// Which files are half written at this moment?
//
// A list of fixed size, so that a signal handler can remove them before the program ends.
#pragma once

#include <string>

namespace rilievo {

// Lists `path` while it lives. What is longer than PATH_MAX, or comes when the list is full (64
// files), is not listed. Any thread.
class UnfinishedFile {
 public:
  explicit UnfinishedFile(const std::string& path) noexcept;
  ~UnfinishedFile();
  UnfinishedFile(const UnfinishedFile&) = delete;
  UnfinishedFile& operator=(const UnfinishedFile&) = delete;

 private:
  int slot_ = -1;
};

// Removes the temporary files that write_file() has open. Safe in a signal handler: it only reads
// the list and calls unlink(). It is for a program that is about to end: what is being written
// fails, and a file that another thread begins meanwhile may stay.
void remove_unfinished_files() noexcept;

}  // namespace rilievo
