// Who closes a file descriptor? Internal: not a stable interface.
#pragma once

#include <unistd.h>

#include <utility>

namespace rilievo {

// Owns a POSIX file descriptor and closes it.
struct Descriptor {
  int fd = -1;

  explicit Descriptor(int opened) : fd(opened) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  // Returns false and sets errno if the data written is lost after all: some file systems report a
  // full disk only on close.
  bool close() { return fd < 0 || ::close(std::exchange(fd, -1)) == 0; }
};

}  // namespace rilievo
