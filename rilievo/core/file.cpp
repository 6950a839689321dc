#include "rilievo/core/file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "rilievo/core/descriptor.h"

namespace rilievo {
namespace {

std::string last_error() { return std::strerror(errno); }

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

}  // namespace rilievo
