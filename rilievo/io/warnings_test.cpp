#include "rilievo/io/warnings.h"

#include <gtest/gtest.h>

namespace rilievo {
namespace {

using Lines = std::vector<std::string>;

TEST(Warnings, alike_ones_are_folded) {
  Warnings warnings;
  EXPECT_TRUE(warnings.empty());
  for (int i = 0; i < 1272; ++i)
    warnings.add("a texture is left out: 'tex " + std::to_string(i) + ".png' is missing");
  for (int i = 0; i < 5; ++i) warnings.add("points are left out");  // the same words each time
  warnings.add("meshes[3].primitives[17] has no positions");
  warnings.add("meshes[4].primitives[0] has no positions");
  warnings.add("the file's 'a' is odd");
  warnings.add("the file's 'b' is odd");
  const Lines expected = {"a texture is left out: 'tex 0.png' is missing (and 1271 more like it)",
                          "points are left out",
                          "meshes[3].primitives[17] has no positions (and 1 more like it)",
                          "the file's 'a' is odd (and 1 more like it)"};
  EXPECT_EQ(warnings.lines(), expected);
}

TEST(Warnings, there_are_at_most_ten_lines) {
  const auto word = [](int i) { return std::string(std::size_t(i + 1), 'x'); };
  Warnings warnings;
  for (int i = 0; i < 10; ++i) warnings.add(word(i));
  EXPECT_EQ(warnings.lines().size(), 10u);
  EXPECT_EQ(warnings.lines().back(), word(9));
  for (int i = 10; i < 25; ++i) warnings.add(word(i));
  EXPECT_EQ(warnings.lines().size(), 10u);
  EXPECT_EQ(warnings.lines()[8], word(8));
  EXPECT_EQ(warnings.lines().back(), "and 16 more warnings of other kinds");
}

}  // namespace
}  // namespace rilievo
