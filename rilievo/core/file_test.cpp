#include "rilievo/core/file.h"

#include <gtest/gtest.h>
#include <sys/stat.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <future>

#include "rilievo/core/file_test_helpers.h"
#include "rilievo/core/unfinished_files.h"

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

TEST(File, a_link_stays_and_its_target_is_replaced) {
  const TemporaryFolder folder;
  ASSERT_TRUE(std::filesystem::create_directory(folder / "there"));
  // Relative to the folder of the link, through a second link, and to no file at first.
  std::filesystem::create_symlink("there/middle", folder / "link");
  std::filesystem::create_symlink("target", folder / "there" / "middle");
  for (const char* text : {"made", "replaced"}) {
    ASSERT_TRUE(write_file(folder / "link", text).ok());
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "link"));
    EXPECT_TRUE(std::filesystem::is_symlink(folder / "there" / "middle"));
    EXPECT_EQ(*read_file(folder / "there" / "target", 100), text);
  }
  EXPECT_EQ(folder.entries(), 2);
  std::filesystem::create_symlink("round", folder / "round");
  EXPECT_FALSE(write_file(folder / "round", "x").ok());
  EXPECT_FALSE(expect_writable(folder / "round").ok());
  std::filesystem::create_symlink("no_such_folder/f", folder / "lost");
  EXPECT_FALSE(write_file(folder / "lost", "x").ok());
  EXPECT_FALSE(expect_writable(folder / "lost").ok());
}

TEST(File, a_replaced_file_keeps_its_permissions) {
  const TemporaryFolder folder;
  for (const mode_t mode : {0600, 0644, 0640, 0755}) {
    ASSERT_TRUE(write_file(folder / "f", "old").ok());
    ASSERT_EQ(::chmod((folder / "f").c_str(), mode), 0);
    ASSERT_TRUE(write_file(folder / "f", "new").ok());
    struct stat status {};
    ASSERT_EQ(::stat((folder / "f").c_str(), &status), 0);
    EXPECT_EQ(status.st_mode & 0777, mode);
  }
}

TEST(File, devices_and_pipes_are_written_straight_into) {
  const TemporaryFolder folder;
  std::filesystem::create_symlink("/dev/null", folder / "null");
  std::filesystem::create_symlink("/dev/full", folder / "full");
  EXPECT_TRUE(expect_writable(folder / "null").ok());
  EXPECT_TRUE(write_file(folder / "null", "x").ok());
  const Result<> full = write_file(folder / "full", "x");
  ASSERT_FALSE(full.ok());
  EXPECT_EQ(full.error().where, (folder / "full").string());
  EXPECT_NE(full.error().reason.find("No space left"), std::string::npos);

  ASSERT_EQ(::mkfifo((folder / "pipe").c_str(), 0600), 0);
  // Opening it would wait for a reader.
  EXPECT_TRUE(expect_writable(folder / "pipe").ok());
  auto reader = std::async(std::launch::async, [&] {
    std::string text(4, ' ');
    FILE* pipe = std::fopen((folder / "pipe").c_str(), "r");
    text.resize(std::fread(text.data(), 1, text.size(), pipe));
    std::fclose(pipe);
    return text;
  });
  EXPECT_TRUE(write_file(folder / "pipe", "text").ok());
  EXPECT_EQ(reader.get(), "text");
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "null"));
  EXPECT_TRUE(std::filesystem::is_symlink(folder / "full"));
  EXPECT_TRUE(std::filesystem::is_fifo(folder / "pipe"));
  EXPECT_EQ(folder.entries(), 3);
}

TEST(File, a_descriptor_of_the_process_is_written_where_it_stands) {
  const TemporaryFolder folder;
  FILE* file = std::fopen((folder / "f").c_str(), "w");
  ASSERT_NE(file, nullptr);
  std::fputs("head ", file);
  std::fflush(file);
  const std::string name = "/dev/fd/" + std::to_string(::fileno(file));
  EXPECT_TRUE(expect_writable(name).ok());
  EXPECT_TRUE(write_file(name, "middle ").ok());
  std::fputs("tail", file);
  std::fclose(file);
  EXPECT_EQ(*read_file(folder / "f", 100), "head middle tail");
  EXPECT_FALSE(write_file(name, "x").ok());  // closed
  EXPECT_FALSE(expect_writable(name).ok());
}

TEST(File, what_cannot_be_written_is_told_beforehand) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "f", "old").ok());
  std::filesystem::create_symlink("nothing", folder / "dangling");
  const auto path = [&](const char* name) { return (folder / name).string(); };
  // What names the fault, and the name that is at fault.
  const std::pair<std::string, std::string> cases[] = {
      {folder.path().string(), folder.path().string()},
      {path("f/below"), path("f")},
      {path("f/far/below"), path("f")},
      {path("dangling/below"), path("dangling")},
      {path("new/"), path("new/")},
      {"/proc/no_file_can_be_made_here", "/proc"},
      {"", ""}};
  for (const auto& [place, named] : cases) {
    const Result<> told = expect_writable(place);
    ASSERT_FALSE(told.ok()) << place;
    EXPECT_EQ(told.error().where, named) << place;
    EXPECT_FALSE(write_file(place, "x").ok()) << place;
  }
  for (const char* good : {"f", "g", "dangling", "a/b/c"})
    EXPECT_TRUE(expect_writable(folder / good).ok()) << good;
  EXPECT_EQ(folder.entries(), 2);
  EXPECT_EQ(*read_file(folder / "f", 100), "old");
}

TEST(File, a_name_as_long_as_names_may_be_is_written) {
  const TemporaryFolder folder;
  EXPECT_TRUE(write_file(folder / std::string(255, 'n'), "x").ok());
}

TEST(UnfinishedFiles, a_signal_in_the_middle_of_writing_leaves_none) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "f", "old").ok());
  const pid_t child = ::fork();
  ASSERT_GE(child, 0);
  if (child == 0) {
    // The write that crosses the limit raises this signal while the file is open.
    std::signal(SIGXFSZ, [](int) {
      remove_unfinished_files();
      ::_exit(77);
    });
    const rlimit small{1000, 1000};
    ::setrlimit(RLIMIT_FSIZE, &small);
    const Result<> written = write_file(folder / "f", std::string(5000, 'x'));
    ::_exit(written.ok() ? 1 : 2);
  }
  int status = 0;
  ASSERT_EQ(::waitpid(child, &status, 0), child);
  ASSERT_TRUE(WIFEXITED(status));
  EXPECT_EQ(WEXITSTATUS(status), 77);
  EXPECT_EQ(folder.entries(), 1);
  EXPECT_EQ(*read_file(folder / "f", 100), "old");
}

TEST(UnfinishedFiles, only_what_is_being_written_is_removed) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "done", "x").ok());
  ASSERT_TRUE(write_file(folder / "open", "x").ok());
  { const UnfinishedFile gone((folder / "done").string()); }
  const UnfinishedFile open((folder / "open").string());
  remove_unfinished_files();
  EXPECT_TRUE(std::filesystem::exists(folder / "done"));
  EXPECT_FALSE(std::filesystem::exists(folder / "open"));
}

}  // namespace
}  // namespace rilievo
