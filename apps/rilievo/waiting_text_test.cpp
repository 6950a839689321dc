#include "apps/rilievo/waiting_text.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <string>

namespace rilievo::app {
namespace {

TEST(WaitingText, is_shorter_than_the_line_and_keeps_the_end_of_the_name) {
  const std::string whole = "exec:/a/path/renderer: waiting for its picture, 12 s";
  const auto text = [](std::size_t columns) {
    return waiting_text("exec:/a/path/renderer", "picture", 12, columns);
  };
  EXPECT_EQ(text(0), whole);
  EXPECT_EQ(text(whole.size() + 1), whole);
  EXPECT_EQ(text(43), "...renderer: waiting for its picture, 12 s");
  EXPECT_EQ(text(10), "waiting f");
  for (std::size_t columns = 1; columns < 80; ++columns) EXPECT_LT(text(columns).size(), columns);
}

TEST(WaitingText, cuts_no_character_in_two) {
  for (std::size_t columns = 35; columns < 50; ++columns) {
    const std::string text = waiting_text("ééééééé", "picture", 1, columns);
    EXPECT_LT(text.size(), columns);
    const std::size_t cut = text.starts_with("...") ? 3 : 0;
    EXPECT_NE(std::uint8_t(text[cut]) & 0xC0, 0x80) << text;
  }
}

}  // namespace
}  // namespace rilievo::app
