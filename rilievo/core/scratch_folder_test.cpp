#include "rilievo/core/scratch_folder.h"

#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <utility>

namespace rilievo {
namespace {

namespace fs = std::filesystem;

void make_old(const fs::path& folder) {
  fs::last_write_time(folder, fs::file_time_type::clock::now() - std::chrono::minutes(5));
}

std::string prefix_of(const char* name) {
  return std::string("rilievo-test-") + name + "-" + std::to_string(::getpid());
}

TEST(ScratchFolder, goes_with_all_that_is_in_it) {
  fs::path path;
  {
    Result<ScratchFolder> made = ScratchFolder::create(prefix_of("goes"));
    ASSERT_TRUE(made.ok());
    path = made->path();
    fs::create_directories(path / "deeper");
    std::ofstream(path / "deeper" / "file") << "content";
    ScratchFolder moved = std::move(*made);
    EXPECT_EQ(moved.path(), path);
    EXPECT_TRUE(fs::exists(path / "deeper" / "file"));
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST(ScratchFolder, removes_what_a_killed_process_left_and_nothing_else) {
  const std::string prefix = prefix_of("left");
  int ends[2];
  ASSERT_EQ(::pipe(ends), 0);
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    const Result<ScratchFolder> made = ScratchFolder::create(prefix);
    const std::string path = made ? made->path().string() : "?";
    (void)!::write(ends[1], path.data(), path.size());
    ::close(ends[1]);
    for (;;) ::pause();
  }
  ::close(ends[1]);
  std::string path(4096, '\0');
  path.resize(std::size_t(std::max<ssize_t>(0, ::read(ends[0], path.data(), path.size()))));
  ::close(ends[0]);
  std::ofstream(path + "/1.exr") << "a picture";
  // As old as it may be, it stays while its process lives.
  make_old(path);
  const fs::path others = fs::temp_directory_path() / (prefix + "er-things");
  fs::create_directory(others);
  make_old(others);
  { EXPECT_TRUE(ScratchFolder::create(prefix).ok()); }
  EXPECT_TRUE(fs::exists(path + "/1.exr"));

  ASSERT_EQ(::kill(child, SIGKILL), 0);
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
  // A young one may be about to be locked.
  fs::last_write_time(path, fs::file_time_type::clock::now());
  { EXPECT_TRUE(ScratchFolder::create(prefix).ok()); }
  EXPECT_TRUE(fs::exists(path));
  make_old(path);
  { EXPECT_TRUE(ScratchFolder::create(prefix).ok()); }
  EXPECT_FALSE(fs::exists(path));
  // Another prefix.
  EXPECT_TRUE(fs::exists(others));
  fs::remove(others);
}

}  // namespace
}  // namespace rilievo
