// A file descriptor that closes itself. For this library's own use.
#pragma once

#include <unistd.h>

#include <utility>

namespace rilievo {

struct Descriptor {
  int fd = -1;

  explicit Descriptor(int opened) : fd(opened) {}
  ~Descriptor() { close(); }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;

  // False, with errno, if what was written is lost after all: some file systems say only now that
  // the disk is full.
  bool close() { return fd < 0 || ::close(std::exchange(fd, -1)) == 0; }
};

}  // namespace rilievo
