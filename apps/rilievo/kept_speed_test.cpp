#include "apps/rilievo/kept_speed.h"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace rilievo::app {
namespace {

const SpeedDependsOn kHere{"llvmpipe", "4.5 Mesa 23", "a processor", "0.1 (abc)", 4};
const DrawSpeed kSpeed{{280, 9.5}, {11, 18}};

void expect_same(const KeptSpeed& a, const KeptSpeed& b) {
  EXPECT_EQ(a.speed.opengl.triangle_ns, b.speed.opengl.triangle_ns);
  EXPECT_EQ(a.speed.opengl.pixel_ns, b.speed.opengl.pixel_ns);
  EXPECT_EQ(a.speed.software.triangle_ns, b.speed.software.triangle_ns);
  EXPECT_EQ(a.speed.software.pixel_ns, b.speed.software.pixel_ns);
  EXPECT_EQ(a.measured_at, b.measured_at);
  EXPECT_EQ(a.agreed, b.agreed);
}

std::string file_of(const KeptSpeed& kept, const SpeedDependsOn& on) {
  return with_kept_speed("", kept, on);
}

// As kHere, but for the number of threads.
SpeedDependsOn with_threads(int threads) {
  SpeedDependsOn on = kHere;
  on.threads = threads;
  return on;
}

TEST(KeptSpeed, a_file_says_what_was_measured) {
  const KeptSpeed kept{kSpeed, 1'800'000'000, 3};
  const std::optional<KeptSpeed> read = find_kept_speed(file_of(kept, kHere), kHere);
  ASSERT_TRUE(read);
  expect_same(*read, kept);
}

TEST(KeptSpeed, of_another_machine_driver_or_build_it_is_not_read) {
  const std::string text = file_of({kSpeed, 5, 0}, kHere);
  for (std::string SpeedDependsOn::*part :
       {&SpeedDependsOn::gl_renderer, &SpeedDependsOn::gl_version, &SpeedDependsOn::processor,
        &SpeedDependsOn::program}) {
    SpeedDependsOn other = kHere;
    other.*part += "2";
    EXPECT_FALSE(find_kept_speed(text, other)) << other.*part;
  }
  SpeedDependsOn more = kHere;
  more.threads = 8;
  EXPECT_FALSE(find_kept_speed(text, more));
}

TEST(KeptSpeed, what_others_keep_stays) {
  std::string file;
  std::map<int, KeptSpeed> all;  // by threads: the slow twin
  std::mt19937 random(5);
  for (int i = 0; i < 200; ++i) {
    const int threads = 1 + int(random() % kMostKept);
    const KeptSpeed kept{kSpeed, i, int(random() % 9)};
    file = with_kept_speed(file, kept, with_threads(threads));
    all[threads] = kept;
    for (const auto& [other, expected] : all) {
      const std::optional<KeptSpeed> read = find_kept_speed(file, with_threads(other));
      ASSERT_TRUE(read) << other;
      expect_same(*read, expected);
    }
  }
}

TEST(KeptSpeed, the_oldest_of_many_goes) {
  std::string file;
  for (int i = 0; i < 100; ++i) file = with_kept_speed(file, {kSpeed, i, 0}, with_threads(i));
  // 64 kB are read of a file.
  EXPECT_LT(file.size(), 32'768u);
  for (int i = 0; i < 100; ++i)
    EXPECT_EQ(find_kept_speed(file, with_threads(i)).has_value(), i >= 100 - int(kMostKept)) << i;
}

TEST(KeptSpeed, what_is_damaged_of_another_goes) {
  std::string file =
      with_kept_speed(file_of({kSpeed, 7, 0}, with_threads(8)), {kSpeed, 5, 0}, kHere);
  file.replace(file.rfind("280"), 3, "-1");
  EXPECT_FALSE(find_kept_speed(file, with_threads(8)));
  EXPECT_TRUE(find_kept_speed(file, kHere));
  EXPECT_EQ(with_kept_speed(file, {kSpeed, 5, 0}, kHere), file_of({kSpeed, 5, 0}, kHere));
}

TEST(KeptSpeed, names_that_are_no_text_are_compared_as_well) {
  SpeedDependsOn odd = kHere;
  odd.gl_renderer = "\xff\xfe";
  EXPECT_TRUE(find_kept_speed(file_of({kSpeed, 5, 0}, odd), odd));
}

TEST(KeptSpeed, damaged_files_are_not_read) {
  const std::string text = file_of({kSpeed, 5, 0}, kHere);
  for (std::size_t length = 0; length + 2 < text.size(); ++length)
    EXPECT_FALSE(find_kept_speed(std::string_view(text).substr(0, length), kHere)) << length;
  for (const auto& [from, to] : {std::pair("280", "0"),
                                 {"280", "-1"},
                                 {"280", "1e99"},
                                 {"280", "\"a\""},
                                 {"\"measured_at\": 5", "\"measured_at\": -5"},
                                 {"\"measured_at\": 5", "\"measured_at\": 1e300"},
                                 {"\"agreed\": 0", "\"agreed\": -1"},
                                 {"\"agreed\": 0", "\"agreed\": 2147483647"},
                                 {"\"agreed\": 0", "\"agreed\": 1e300"},
                                 {"\"agreed\"", "\"x\""}}) {
    std::string other = text;
    const std::size_t at = other.find(from);
    ASSERT_NE(at, std::string::npos) << from;
    other.replace(at, std::string_view(from).size(), to);
    EXPECT_FALSE(find_kept_speed(other, kHere)) << to;
  }
}

TEST(KeptSpeed, holds_for_a_day_and_where_two_agree_for_a_month) {
  for (const auto& [agreed, most] : {std::pair(0, kFirstHolds), {1, kAgreedHolds}}) {
    const KeptSpeed kept{kSpeed, 1000, agreed};
    EXPECT_TRUE(holds(kept, 1000));
    EXPECT_TRUE(holds(kept, 1000 + most - 1));
    EXPECT_FALSE(holds(kept, 1000 + most));
    EXPECT_FALSE(holds(kept, 999));
  }
}

TEST(KeptSpeed, only_about_the_same_agrees) {
  const KeptSpeed before{kSpeed, 1000, 2};
  EXPECT_EQ(measured_again(nullptr, kSpeed, 7).agreed, 0);
  EXPECT_EQ(measured_again(&before, kSpeed, 7).agreed, 3);
  for (double PolygonTimes::*time : {&PolygonTimes::triangle_ns, &PolygonTimes::pixel_ns})
    for (PolygonTimes DrawSpeed::*of : {&DrawSpeed::opengl, &DrawSpeed::software})
      for (const double off : {1.4, 1.6, 1 / 1.4, 1 / 1.6}) {
        DrawSpeed other = kSpeed;
        other.*of.*time *= off;
        const KeptSpeed kept = measured_again(&before, other, 2000);
        EXPECT_EQ(kept.agreed, off < 1.5 && off > 1 / 1.5 ? 3 : 0) << off;
        EXPECT_EQ((kept.speed.*of).*time, (other.*of).*time);
        EXPECT_EQ(kept.measured_at, 2000);
      }
}

// Of measurements of which each may be disturbed, a run of every hour uses a disturbed one for at
// most a day, as long as no two in a row are off in the same way.
TEST(KeptSpeed, a_disturbed_measurement_decides_for_a_day_at_most) {
  std::mt19937 random(3);
  for (int walk = 0; walk < 50; ++walk) {
    std::optional<KeptSpeed> kept;
    bool disturbed = false;
    std::int64_t wrong_since = -1;
    for (std::int64_t now = 0; now < 120 * kFirstHolds; now += 3600) {
      if (!kept || !holds(*kept, now)) {
        DrawSpeed measured = kSpeed;
        disturbed = !disturbed && random() % 2 == 0;
        if (disturbed) measured.software.triangle_ns *= 5;
        kept = measured_again(kept ? &*kept : nullptr, measured, now);
      }
      const bool wrong = kept->speed.software.triangle_ns > kSpeed.software.triangle_ns;
      if (!wrong)
        wrong_since = -1;
      else if (wrong_since < 0)
        wrong_since = now;
      if (wrong) {
        EXPECT_LE(now - wrong_since, kFirstHolds);
      }
    }
  }
}

}  // namespace
}  // namespace rilievo::app
