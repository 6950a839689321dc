#include "rilievo/core/file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>

#include <csignal>
#include <random>

namespace rilievo {
namespace {

namespace fs = std::filesystem;

// An empty folder that disappears with its test.
struct Folder {
  fs::path path =
      fs::temp_directory_path() / ("rilievo_file_test_" + std::to_string(std::random_device{}()));
  Folder() { fs::create_directory(path); }
  ~Folder() { fs::remove_all(path); }
  [[nodiscard]] int entries() const {
    return int(std::distance(fs::directory_iterator(path), fs::directory_iterator()));
  }
};

TEST(File, what_is_written_is_read) {
  const Folder folder;
  const std::string head("a\0b", 3), tail(100000, 'x');
  const std::span<const std::byte> pieces[] = {std::as_bytes(std::span(head)),
                                               std::as_bytes(std::span(tail))};
  ASSERT_TRUE(write_file(folder.path / "f", std::span(pieces)).ok());
  const Result<std::string> read = read_file(folder.path / "f", 1 << 20);
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(*read, head + tail);
  EXPECT_EQ(folder.entries(), 1);
  ASSERT_TRUE(write_file(folder.path / "f", "new").ok());
  EXPECT_EQ(*read_file(folder.path / "f", 3), "new");
}

TEST(File, a_failed_write_leaves_the_old_file_and_nothing_else) {
  const Folder folder;
  ASSERT_TRUE(write_file(folder.path / "f", "old").ok());
  // A limit on the size of files stands in for a full disk.
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_FSIZE, &before), 0);
  const auto handler = std::signal(SIGXFSZ, SIG_IGN);
  const rlimit small{1000, before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_FSIZE, &small), 0);
  const Result<> wrote = write_file(folder.path / "f", std::string(5000, 'x'));
  setrlimit(RLIMIT_FSIZE, &before);
  std::signal(SIGXFSZ, handler);
  ASSERT_FALSE(wrote.ok());
  EXPECT_NE(wrote.error().message().find((folder.path / "f").string()), std::string::npos);
  EXPECT_EQ(*read_file(folder.path / "f", 100), "old");
  EXPECT_EQ(folder.entries(), 1);
}

TEST(File, what_cannot_be_read_or_written_is_an_error) {
  const Folder folder;
  EXPECT_FALSE(read_file(folder.path / "missing", 100).ok());
  EXPECT_FALSE(read_file(folder.path, 100).ok());
  EXPECT_FALSE(read_file("/dev/zero", 100).ok());
  ASSERT_TRUE(write_file(folder.path / "f", "12345").ok());
  EXPECT_TRUE(read_file(folder.path / "f", 5).ok());
  EXPECT_FALSE(read_file(folder.path / "f", 4).ok());
  EXPECT_FALSE(write_file(folder.path / "no_such_folder" / "f", "x").ok());
  EXPECT_FALSE(write_file(folder.path, "x").ok());
  EXPECT_EQ(folder.entries(), 1);
}

}  // namespace
}  // namespace rilievo
