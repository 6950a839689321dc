#include <gtest/gtest.h>

#include "rilievo/core/file.h"
#include "rilievo/core/file_test_helpers.h"
#include "rilievo/io/exr.h"
#include "rilievo/io/io_test_helpers.h"
#include "rilievo/io/png.h"

namespace rilievo {
namespace {

TEST(FullDisk, it_is_an_error_and_leaves_the_old_file_alone) {
  const TemporaryFolder folder;
  ASSERT_TRUE(write_file(folder / "a", "old").ok());
  const DepthImage picture = random_picture(1, 64, 48);
  {
    const SmallDisk full(1000);
    EXPECT_FALSE(write_file(folder / "a", std::string(5000, 'x')).ok());
    EXPECT_FALSE(save_png(folder / "a", Rgba8Image(1000, 1000)).ok());
    const Result<> saved = save_pictures(folder / "a", {&picture, 1});
    ASSERT_FALSE(saved.ok());
    EXPECT_EQ(saved.error().where, (folder / "a").string());
  }
  EXPECT_EQ(*read_file(folder / "a", 100), "old");
  EXPECT_EQ(folder.entries(), 1);
}

TEST(FullDisk, wherever_it_becomes_full_it_is_an_error) {
  const TemporaryFolder folder;
  const DepthImage picture = random_picture(2, 8, 6);
  ASSERT_TRUE(save_pictures(folder / "whole.exr", {&picture, 1}).ok());
  const std::uintmax_t bytes = std::filesystem::file_size(folder / "whole.exr");
  for (std::uintmax_t room = 0; room < bytes; room += 97) {
    const SmallDisk full(room);
    ASSERT_FALSE(save_pictures(folder / "cut.exr", {&picture, 1}).ok()) << room;
  }
  EXPECT_EQ(folder.entries(), 1);
}

}  // namespace
}  // namespace rilievo
