#include "rilievo/core/processor_time.h"

#include <gtest/gtest.h>

#include <cstdio>
#include <ctime>
#include <string>
#include <thread>

namespace rilievo {
namespace {

// Works until this thread has taken so much processor time.
void work_for(double seconds) {
  const auto taken = [] {
    timespec at{};
    ::clock_gettime(CLOCK_THREAD_CPUTIME_ID, &at);
    return double(at.tv_sec) + 1e-9 * double(at.tv_nsec);
  };
  const double until = taken() + seconds;
  while (taken() < until) {
  }
}

TEST(ProcessorTime, counts_all_threads) {
  const double before = processor_seconds();
  std::thread other(work_for, 0.05);
  work_for(0.05);
  other.join();
  EXPECT_GE(processor_seconds() - before, 0.1);
}

TEST(ProcessorTime, does_not_count_waiting) {
  const double before = processor_seconds();
  ::usleep(500'000);
  EXPECT_LT(processor_seconds() - before, 0.25);
}

// A shell starts a program that works until it has taken 0.2 s by its own count. It counts while it
// runs, when the shell has waited for it, and when the shell has ended.
TEST(ProcessorTime, counts_what_programs_started_before_and_after_their_ends) {
  if (std::system("perl -e 1") != 0) GTEST_SKIP() << "there is no perl to do the work";
  const std::string work = "1 while (times)[0] + (times)[1] < 0.2";
  constexpr double kWorked = 0.18;  // `times` counts in steps of 0.01 s
  for (const std::string& command :
       {"perl -e '" + work + "; <STDIN>'; true", "perl -e '" + work + "'; read line"}) {
    const double before = processor_seconds();
    std::FILE* shell = ::popen(command.c_str(), "w");
    ASSERT_TRUE(shell);
    // If it is never counted, this does not end.
    while (processor_seconds() - before < kWorked) ::usleep(10'000);
    ::pclose(shell);
    EXPECT_GE(processor_seconds() - before, kWorked) << command;
  }
}

}  // namespace
}  // namespace rilievo
