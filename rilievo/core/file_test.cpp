#include "rilievo/core/file.h"

#include <gtest/gtest.h>

#include "rilievo/core/file_test_helpers.h"

namespace rilievo {
namespace {

TEST(File, what_is_written_is_read) {
  const TemporaryFolder folder;
  const std::string head("a\0b", 3), tail(100000, 'x');
  const std::span<const std::byte> pieces[] = {std::as_bytes(std::span(head)),
                                               std::as_bytes(std::span(tail))};
  ASSERT_TRUE(write_file(folder / "f", std::span(pieces)).ok());
  const Result<std::string> read = read_file(folder / "f", 1 << 20);
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(*read, head + tail);
  EXPECT_EQ(folder.entries(), 1);
  ASSERT_TRUE(write_file(folder / "f", "new").ok());
  EXPECT_EQ(*read_file(folder / "f", 3), "new");
}

TEST(File, a_failed_write_leaves_the_old_file_and_nothing_else) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "f", "old").ok());
  const Result<> wrote = [&] {
    const SmallDisk full(1000);
    return write_file(folder / "f", std::string(5000, 'x'));
  }();
  ASSERT_FALSE(wrote.ok());
  EXPECT_NE(wrote.error().message().find((folder / "f").string()), std::string::npos);
  EXPECT_EQ(*read_file(folder / "f", 100), "old");
  EXPECT_EQ(folder.entries(), 1);
}

TEST(File, what_cannot_be_read_or_written_is_an_error) {
  const TemporaryFolder folder;
  EXPECT_FALSE(read_file(folder / "missing", 100).ok());
  EXPECT_FALSE(read_file(folder.path(), 100).ok());
  EXPECT_FALSE(read_file("/dev/zero", 100).ok());
  ASSERT_TRUE(write_file(folder / "f", "12345").ok());
  EXPECT_TRUE(read_file(folder / "f", 5).ok());
  EXPECT_FALSE(read_file(folder / "f", 4).ok());
  EXPECT_FALSE(write_file(folder / "no_such_folder" / "f", "x").ok());
  EXPECT_FALSE(write_file(folder.path(), "x").ok());
  EXPECT_EQ(folder.entries(), 1);
}

}  // namespace
}  // namespace rilievo
