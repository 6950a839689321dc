#include "bench/drawn_bound.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "rilievo/core/sanitized_test_helpers.h"
#include "rilievo/gl/context_test_helpers.h"

namespace rilievo::bench {
namespace {

class DrawnBoundTest : public gl::ContextTest {};

TEST_F(DrawnBoundTest, no_ball_is_drawn_farther_off_than_its_picture_claims) {
  const int cases = std::max(200, sanitized_cases(600));  // of some 25 frames at least
  const auto stats = run_drawn_bound_benchmark({.cases = cases, .seed = 3});
  ASSERT_TRUE(stats.ok()) << stats.error().message();
  EXPECT_EQ(stats->violations, 0);
  EXPECT_LE(stats->bound_px_max, 1);
  EXPECT_GT(stats->captures, 0);
  EXPECT_GT(stats->moving, 0);
  EXPECT_GT(stats->fading, 0);
}

TEST_F(DrawnBoundTest, a_tenth_of_what_it_claims_is_not_enough) {
  const auto stats = run_drawn_bound_benchmark({.cases = 300, .error_px = 6, .scale = 0.1});
  ASSERT_TRUE(stats.ok());
  EXPECT_GT(stats->violations, 2);  // one in a hundred
}

}  // namespace
}  // namespace rilievo::bench
