#include "rilievo/kind/option.h"

#include <gtest/gtest.h>

#include <array>
#include <random>
#include <vector>

namespace rilievo {
namespace {

const std::array kOptions{
    Option{.name = "count",
           .type = OptionType::integer,
           .default_value = "3",
           .help = "How many",
           .min = 1,
           .max = 10},
    Option{.name = "share", .type = OptionType::number, .default_value = "0.5", .min = 0, .max = 1},
    Option{.name = "fast", .type = OptionType::flag, .default_value = "off"},
    Option{.name = "way",
           .type = OptionType::choice,
           .default_value = "left",
           .choices = {"left", "right"}},
    Option{.name = "at", .type = OptionType::point, .default_value = ""},
    Option{.name = "points", .type = OptionType::points, .default_value = ""},
    Option{.name = "box", .type = OptionType::box, .default_value = ""},
};

TEST(OptionValues, start_as_their_defaults_and_know_what_was_given) {
  OptionValues values(kOptions);
  EXPECT_EQ(values.integer("count"), 3);
  EXPECT_EQ(values.number("share"), 0.5);
  EXPECT_FALSE(values.flag("fast"));
  EXPECT_EQ(values.text("way"), "left");
  EXPECT_TRUE(values.numbers("at").empty());
  EXPECT_FALSE(values.given("count"));
  ASSERT_TRUE(values.set("count", "7").ok());
  EXPECT_TRUE(values.given("count"));
  EXPECT_EQ(values.expect_none_of({"count"}, "is for others").error().message(),
            "--count: is for others");
  EXPECT_EQ(values.integer("count"), 7);
  EXPECT_TRUE(values.has("box"));
  EXPECT_FALSE(values.has("boxes"));
}

TEST(OptionValues, take_what_the_option_says_and_nothing_else) {
  OptionValues values(kOptions);
  for (const auto& [name, good] : {std::pair{"count", "1"},
                                   {"count", "10"},
                                   {"share", "1e-3"},
                                   {"fast", "on"},
                                   {"way", "right"},
                                   {"at", "1,-2.5,3e2"},
                                   {"points", "1,2,3"},
                                   {"points", "1,2,3 -4,5e1,6"},
                                   {"box", "0,0,0,1,2,3"}})
    EXPECT_TRUE(values.set(name, good).ok()) << name << " " << good;
  EXPECT_EQ(values.numbers("points"), (std::vector<double>{1, 2, 3, -4, 50, 6}));
  const OptionValues before = values;
  for (const auto& [name, bad] : {std::pair{"count", "0"},
                                  {"count", "11"},
                                  {"count", "2.5"},
                                  {"count", ""},
                                  {"count", "x"},
                                  {"share", "nan"},
                                  {"share", "inf"},
                                  {"share", "1.01"},
                                  {"share", "0.5 "},
                                  {"fast", "yes"},
                                  {"way", "up"},
                                  {"way", ""},
                                  {"at", "1,2"},
                                  {"at", "1,2,3,4"},
                                  {"at", "1,,3"},
                                  {"at", "1,2,nan"},
                                  {"points", "1,2"},
                                  {"points", "1,2,3 4"},
                                  {"points", "1,2,3  4,5,6"},
                                  {"points", "1,2,3 4,5,inf"},
                                  {"box", "0,0,0,1,2"},
                                  {"box", "0,0,0,1,0,3"},
                                  {"box", "0,0,0,1,1,1e999"}}) {
    const Result<> set = values.set(name, bad);
    ASSERT_FALSE(set.ok()) << name << " " << bad;
    EXPECT_EQ(set.error().where, std::string("--") + name);
    EXPECT_EQ(values.text(name), before.text(name));
  }
}

TEST(OptionValues, never_take_a_random_text_that_is_not_a_number_in_range) {
  std::mt19937 rng(1);
  OptionValues values(kOptions);
  for (int i = 0; i < 20000; ++i) {
    std::string text;
    for (unsigned length = rng() % 8; length > 0; --length)
      text += "0123456789.-+eE,xn "[rng() % 19];
    if (!values.set("count", text)) continue;
    EXPECT_GE(values.integer("count"), 1) << text;
    EXPECT_LE(values.integer("count"), 10) << text;
  }
}

}  // namespace
}  // namespace rilievo
