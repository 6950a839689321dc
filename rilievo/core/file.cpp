#include "rilievo/core/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <cstring>

namespace rilievo {
namespace {

// Owns a file descriptor.
struct Descriptor {
  int fd = -1;
  explicit Descriptor(int opened) : fd(opened) {}
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  ~Descriptor() {
    if (fd >= 0) ::close(fd);
  }
};

std::string last_error() { return std::strerror(errno); }

bool write_all(int fd, std::span<const std::byte> bytes) {
  while (!bytes.empty()) {
    // Linux writes at most 2 GiB at a time.
    const ssize_t n = ::write(fd, bytes.data(), std::min<std::size_t>(bytes.size(), 1u << 30));
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return false;
    bytes = bytes.subspan(std::size_t(n));
  }
  return true;
}

// A name beside `path` that no other writer of this or another process uses.
std::filesystem::path temporary_beside(const std::filesystem::path& path) {
  static std::atomic<unsigned> count{0};
  std::filesystem::path temporary = path;
  temporary += "." + std::to_string(::getpid()) + "-" + std::to_string(count++) + ".part";
  return temporary;
}

}  // namespace

Result<std::string> read_file(const std::filesystem::path& path, std::uint64_t max_bytes) {
  const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK));
  if (file.fd < 0) return Error{path.string(), last_error()};
  struct stat status {};
  if (::fstat(file.fd, &status) != 0) return Error{path.string(), last_error()};
  // Pipes and devices may never end.
  if (!S_ISREG(status.st_mode)) return Error{path.string(), "not a regular file"};
  if (std::uint64_t(status.st_size) > max_bytes)
    return Error{path.string(), "has " + std::to_string(status.st_size) + " bytes, more than the " +
                                    std::to_string(max_bytes) + " allowed"};
  std::string bytes(std::size_t(status.st_size), '\0');
  std::size_t done = 0;
  while (done < bytes.size()) {
    const ssize_t n =
        ::read(file.fd, bytes.data() + done, std::min<std::size_t>(bytes.size() - done, 1u << 30));
    if (n < 0 && errno == EINTR) continue;
    if (n < 0) return Error{path.string(), last_error()};
    if (n == 0) return Error{path.string(), "became shorter while it was read"};
    done += std::size_t(n);
  }
  return bytes;
}

Result<> write_file(const std::filesystem::path& path,
                    std::span<const std::span<const std::byte>> pieces) {
  const std::filesystem::path temporary = temporary_beside(path);
  int fd = ::open(temporary.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
  if (fd < 0) return Error{path.string(), last_error()};
  bool written = true;
  for (const std::span<const std::byte>& piece : pieces) written = written && write_all(fd, piece);
  std::string reason = written ? "" : last_error();
  // Some file systems tell only now that the disk is full.
  if (::close(fd) != 0 && written) written = false, reason = last_error();
  if (written && ::rename(temporary.c_str(), path.c_str()) != 0)
    written = false, reason = last_error();
  if (written) return Done{};
  ::unlink(temporary.c_str());
  return Error{path.string(), "cannot be written: " + reason};
}

Result<> write_file(const std::filesystem::path& path, std::string_view text) {
  const std::span<const std::byte> piece = std::as_bytes(std::span(text));
  return write_file(path, std::span(&piece, 1));
}

}  // namespace rilievo
