#include "apps/rilievo/printable.h"

#include <gtest/gtest.h>

namespace rilievo::app {
namespace {

TEST(Printable, text_of_any_script_comes_out_as_it_is) {
  for (const std::string text : {"", "a b~\\", "Brücke", "橋", "🌉", "\xF4\x8F\xBF\xBF"})
    EXPECT_EQ(printable(text), text);
}

TEST(Printable, what_a_terminal_takes_for_an_order_is_spelt_out) {
  EXPECT_EQ(printable("a\x1b[2J\x07\r\n\t\x7f"), "a\\x1b[2J\\x07\\x0d\\x0a\\x09\\x7f");
  EXPECT_EQ(printable(std::string("\0b", 2)), "\\x00b");
  EXPECT_EQ(printable("\xC2\x9B"), "\\xc2\\x9b");           // CSI in one character
  EXPECT_EQ(printable("\xE2\x80\xAE"), "\\xe2\\x80\\xae");  // right to left from here
  EXPECT_EQ(printable("\xC2\xA0"), "\xC2\xA0");             // the first one behind C1
}

TEST(Printable, bytes_that_are_no_utf_8_are_spelt_out) {
  EXPECT_EQ(printable("\x9B"), "\\x9b");
  EXPECT_EQ(printable("\xC0\x9B"), "\\xc0\\x9b");  // too long for what it says
  EXPECT_EQ(printable("\xE0\x80\x9B"), "\\xe0\\x80\\x9b");
  EXPECT_EQ(printable("\xED\xA0\x80"), "\\xed\\xa0\\x80");           // half of a pair
  EXPECT_EQ(printable("\xF4\x90\x80\x80"), "\\xf4\\x90\\x80\\x80");  // beyond Unicode
  EXPECT_EQ(printable("\xE6\xA9"), "\\xe6\\xa9");                    // cut short
  EXPECT_EQ(printable("\xE6\x1b"), "\\xe6\\x1b");
}

}  // namespace
}  // namespace rilievo::app
