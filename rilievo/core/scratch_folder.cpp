#include "rilievo/core/scratch_folder.h"

#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <ctime>
#include <string>
#include <utility>

namespace rilievo {
namespace {

namespace fs = std::filesystem;

// Younger folders may be about to be locked.
constexpr std::time_t kYoung = 60;  // seconds

// Opens a folder, and locks it unless somebody has; -1 if it cannot. Programs that are started do
// not get the descriptor.
int lock_folder(const fs::path& path) {
  const int folder = ::open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
  if (folder < 0) return -1;
  if (::flock(folder, LOCK_EX | LOCK_NB) == 0) return folder;
  ::close(folder);
  return -1;
}

// Removes what dead processes left.
void remove_left(const fs::path& among, const std::string& prefix) {
  std::error_code failed;
  for (fs::directory_iterator at(among, failed), end; !failed && at != end; at.increment(failed)) {
    if (!at->path().filename().string().starts_with(prefix)) continue;
    struct ::stat about {};
    if (::lstat(at->path().c_str(), &about) != 0 || !S_ISDIR(about.st_mode)) continue;
    if (about.st_uid != ::geteuid() || std::time(nullptr) - about.st_mtime < kYoung) continue;
    const int folder = lock_folder(at->path());
    if (folder < 0) continue;
    std::error_code ignored;
    fs::remove_all(at->path(), ignored);
    ::close(folder);
  }
}

}  // namespace

Result<ScratchFolder> ScratchFolder::create(std::string_view prefix) {
  std::error_code failed;
  const fs::path among = fs::temp_directory_path(failed);
  const std::string start = std::string(prefix) + "-";
  std::string made = (among / (start + "XXXXXX")).string();
  if (failed) return Error{made, "is a folder that cannot be made: " + failed.message()};
  remove_left(among, start);
  if (!::mkdtemp(made.data())) return Error{made, "is a folder that cannot be made"};
  ScratchFolder folder;
  folder.path_ = made;
  folder.lock_ = lock_folder(made);
  return folder;
}

ScratchFolder::~ScratchFolder() { remove(); }

ScratchFolder::ScratchFolder(ScratchFolder&& other) noexcept
    : path_(std::exchange(other.path_, {})), lock_(std::exchange(other.lock_, -1)) {}

ScratchFolder& ScratchFolder::operator=(ScratchFolder&& other) noexcept {
  if (this == &other) return *this;
  remove();
  path_ = std::exchange(other.path_, {});
  lock_ = std::exchange(other.lock_, -1);
  return *this;
}

void ScratchFolder::remove() {
  std::error_code ignored;
  if (!path_.empty()) fs::remove_all(path_, ignored);
  if (lock_ >= 0) ::close(lock_);
  path_.clear();
  lock_ = -1;
}

}  // namespace rilievo
