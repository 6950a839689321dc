// Writing files: write_file() and expect_writable() of core/file.h.

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cerrno>
#include <charconv>
#include <chrono>
#include <cstring>

#include "rilievo/core/descriptor.h"
#include "rilievo/core/file.h"
#include "rilievo/core/unfinished_files.h"

namespace rilievo {
namespace {

namespace fs = std::filesystem;

// Linux gives up after as many.
constexpr int kMaxLinks = 40;

Error cannot_write(const fs::path& path) {
  return {path.string(), std::string("cannot be written: ") + std::strerror(errno)};
}

// Where the bytes go.
struct Place {
  fs::path path;        // what a link points to
  bool linked = false;  // it is not the name that was given
  int descriptor = -1;  // of this process, if the name stands for one
  bool exists = false;  // otherwise `status` says nothing
  struct stat status {};

  // Written straight into; anything else is replaced.
  [[nodiscard]] bool is_stream() const {
    return descriptor >= 0 || (exists && !S_ISREG(status.st_mode));
  }
};

// N of /dev/fd/N; -1: it is another path.
int descriptor_named(const fs::path& path) {
  const fs::path folder = path.parent_path();
  if (folder != "/dev/fd" && folder != "/proc/self/fd") return -1;
  const std::string name = path.filename().string();
  int number = -1;
  const auto [end, error] = std::from_chars(name.data(), name.data() + name.size(), number);
  return error == std::errc() && end == name.data() + name.size() ? number : -1;
}

// Follows links by hand, because stat() names no target, and to where there is no file yet.
Result<Place> follow_links(const fs::path& path) {
  Place place{path};
  for (int links = 0; links <= kMaxLinks; ++links) {
    place.descriptor = descriptor_named(place.path);
    if (place.descriptor >= 0) return place;
    std::error_code is_no_link;
    const fs::path target = fs::read_symlink(place.path, is_no_link);
    if (is_no_link) return place;
    place.path = place.path.parent_path() / target;  // the target alone if that is absolute
    place.linked = true;
  }
  errno = ELOOP;
  return cannot_write(path);
}

// Errors: what can never be written, whatever else is done.
Result<Place> find_place(const fs::path& path) {
  struct stat status {};
  // The system's own rules on links come first.
  const bool exists = ::stat(path.c_str(), &status) == 0;
  if (!exists && errno != ENOENT && errno != ENOTDIR) return cannot_write(path);
  Result<Place> place = follow_links(path);
  if (!place) return place;
  if (place->descriptor >= 0) {
    const int flags = ::fcntl(place->descriptor, F_GETFL);
    if (flags >= 0 && (flags & O_ACCMODE) != O_RDONLY) return place;
    errno = EBADF;
    return cannot_write(path);
  }
  place->exists = exists;
  place->status = status;
  if (!exists) {
    const fs::path name = place->path.filename();
    if (name.empty() || name == "." || name == "..") return Error{path.string(), "names no file"};
    return place;
  }
  if (S_ISDIR(status.st_mode)) return Error{path.string(), "is a folder"};
  if (S_ISSOCK(status.st_mode)) return Error{path.string(), "is a socket, not a file"};
  // A folder's permissions would be enough to replace what is meant to be read only.
  if (::faccessat(AT_FDCWD, place->path.c_str(), W_OK, AT_EACCESS) != 0) return cannot_write(path);
  return place;
}

// A name beside `path` that no other writer uses. Processes of two containers may have one number
// and share a folder, so the time tells them apart.
fs::path temporary_beside(const fs::path& path) {
  static std::atomic<unsigned> count{0};
  const auto now = std::chrono::system_clock::now().time_since_epoch().count();
  // A name has at most 255 bytes.
  return path.parent_path() /
         (path.filename().string().substr(0, 200) + "." + std::to_string(::getpid()) + "-" +
          std::to_string(now) + "-" + std::to_string(count++) + ".part");
}

// A new file beside `path` that is removed unless it is renamed.
class Temporary {
 public:
  Temporary(const fs::path& path, mode_t mode)
      : path_(temporary_beside(path)),
        listed_(path_.string()),
        file_(::open(path_.c_str(), O_WRONLY | O_CREAT | O_EXCL | O_CLOEXEC, mode)) {
    exists_ = file_.fd >= 0;
  }
  ~Temporary() {
    if (exists_) ::unlink(path_.c_str());
  }
  Temporary(const Temporary&) = delete;
  Temporary& operator=(const Temporary&) = delete;

  [[nodiscard]] bool exists() const { return exists_; }
  [[nodiscard]] int fd() const { return file_.fd; }
  bool rename_to(const fs::path& path) {
    if (!file_.close() || ::rename(path_.c_str(), path.c_str()) != 0) return false;
    exists_ = false;
    return true;
  }

 private:
  fs::path path_;
  // Before the file is made and until it is gone: a signal may come at any time.
  UnfinishedFile listed_;
  Descriptor file_;
  bool exists_ = false;
};

void keep_owner_and_mode(int fd, const struct stat& old) {
  mode_t mode = old.st_mode & 0777;
  // Few may give files away. Permissions of one group are not for another.
  if (::fchown(fd, old.st_uid, old.st_gid) != 0 && ::fchown(fd, uid_t(-1), old.st_gid) != 0)
    mode &= ~mode_t(S_IRWXG);
  // Not every file system has permissions.
  [[maybe_unused]] const int ignored = ::fchmod(fd, mode);
}

bool write_all(int fd, std::span<const std::span<const std::byte>> pieces) {
  for (std::span<const std::byte> bytes : pieces) {
    while (!bytes.empty()) {
      // Linux writes at most 2 GiB at a time.
      const ssize_t n = ::write(fd, bytes.data(), std::min<std::size_t>(bytes.size(), 1u << 30));
      if (n < 0 && errno == EINTR) continue;
      if (n == 0) errno = EIO;
      if (n <= 0) return false;
      bytes = bytes.subspan(std::size_t(n));
    }
  }
  return true;
}

// The folder that is there, of those above `file`.
Result<fs::path> folder_above(const fs::path& file) {
  fs::path folder = file.parent_path();
  struct stat status {};
  for (;; folder = folder.parent_path()) {
    if (folder.empty()) folder = ".";
    if (::stat(folder.c_str(), &status) == 0) break;
    if (::lstat(folder.c_str(), &status) == 0)
      return Error{folder.string(), "is a link that leads nowhere"};
    if ((errno != ENOENT && errno != ENOTDIR) || folder == ".") return cannot_write(folder);
  }
  if (!S_ISDIR(status.st_mode)) return Error{folder.string(), "is not a folder"};
  return folder;
}

}  // namespace

Result<> write_file(const fs::path& path, std::span<const std::span<const std::byte>> pieces) {
  const Result<Place> place = find_place(path);
  if (!place) return place.error();
  if (place->is_stream()) {
    Descriptor stream(place->descriptor >= 0
                          ? ::fcntl(place->descriptor, F_DUPFD_CLOEXEC, 0)
                          : ::open(place->path.c_str(), O_WRONLY | O_CLOEXEC | O_NOCTTY));
    if (stream.fd < 0 || !write_all(stream.fd, pieces) || !stream.close())
      return cannot_write(path);
    return Done{};
  }
  // What replaces a private file is never readable for others.
  Temporary temporary(place->path, place->exists ? 0600 : 0666);
  if (!temporary.exists()) return cannot_write(path);
  if (place->exists) keep_owner_and_mode(temporary.fd(), place->status);
  if (!write_all(temporary.fd(), pieces) || !temporary.rename_to(place->path))
    return cannot_write(path);
  return Done{};
}

Result<> write_file(const fs::path& path, std::string_view text) {
  const std::span<const std::byte> piece = std::as_bytes(std::span(text));
  return write_file(path, std::span(&piece, 1));
}

Result<> expect_writable(const fs::path& path) {
  const Result<Place> place = find_place(path);
  if (!place) return place.error();
  if (place->is_stream()) return Done{};
  const Result<fs::path> folder = folder_above(place->path);
  if (!folder) return folder.error();
  const fs::path own = place->path.parent_path();
  // The caller makes the folders of the name that was given, not of a link's target.
  if (place->linked && *folder != (own.empty() ? fs::path(".") : own))
    return Error{path.string(), "is a link into a folder that is not there: " + own.string()};
  // Only trying tells: permissions mean nothing to root, and some file systems lie.
  if (!Temporary(*folder / place->path.filename(), 0600).exists())
    return Error{folder->string(),
                 std::string("no file can be made in it: ") + std::strerror(errno)};
  return Done{};
}

}  // namespace rilievo
