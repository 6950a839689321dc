#include "rilievo/io/text_scan.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace rilievo {
namespace {

TEST(TextScan, a_number_is_the_whole_word) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::pair<const char*, double> numbers[] = {{"0", 0},
                                                    {"-1.5", -1.5},
                                                    {"+2", 2},
                                                    {"1e+002", 100},
                                                    {".5", 0.5},
                                                    {"5.", 5},
                                                    {"0,95", 0.95},
                                                    {"-12,5", -12.5},
                                                    {"1,5e-3", 0.0015},
                                                    {"+0,5", 0.5},
                                                    {"inf", kInfinity},
                                                    {"1e999", kInfinity},
                                                    {"-1e999", -kInfinity},
                                                    {"1e-999", 0},
                                                    {"1.#INF", kInfinity},
                                                    {"-1.#INF00", -kInfinity},
                                                    {"1,234", 1.234}};
  for (const auto& [word, value] : numbers) EXPECT_EQ(number_of(word), value) << word;
  for (const char* word : {"nan", "NaN", "-nan(ind)", "1.#QNAN", "-1.#IND00"}) {
    ASSERT_TRUE(number_of(word)) << word;
    EXPECT_TRUE(std::isnan(*number_of(word))) << word;
  }
  for (const char* word : {"",        "x",      "1x", "3.1+e2", "0,95,", "1,",    ",5",    "1,2,3",
                           "1,234.5", "1.5,2",  "1;", "0x10",   "1f",    "1.#",   "1.#IN", "--1",
                           "+-1",     "1e999x", "1 ", "1,5,",   "-,5",   "1.2.3", "1/2"})
    EXPECT_FALSE(number_of(word)) << word;
  EXPECT_EQ(number_of(std::string(300, '0') + ",5"), 0.5);
}

TEST(TextScan, lines_end_by_any_convention) {
  const std::string_view text = "a\r\nb\nc\rd\n\ne";
  const std::pair<char, const char*> lines[] = {
      {'a', "line 1"}, {'b', "line 2"}, {'c', "line 3"}, {'d', "line 4"}, {'e', "line 6"}};
  for (const auto& [letter, line] : lines)
    EXPECT_EQ(line_name(text, text.data() + text.find(letter)), line) << letter;
}

}  // namespace
}  // namespace rilievo
