#include "rilievo/method/good_enough.h"

#include <gtest/gtest.h>

namespace rilievo {
namespace {

TEST(GoodEnough, frames_may_lose_what_is_allowed_or_what_the_cache_loses) {
  EXPECT_TRUE(good_enough(4, std::nullopt, 4));
  EXPECT_FALSE(good_enough(4.1, std::nullopt, 4));
  // A good cache allows no less, a bad one more.
  EXPECT_TRUE(good_enough(4, 1, 4));
  EXPECT_FALSE(good_enough(4.1, 1, 4));
  EXPECT_TRUE(good_enough(9, 9, 4));
  EXPECT_FALSE(good_enough(9.6, 9, 4));
  // The cache is as good as itself.
  EXPECT_TRUE(good_enough(12, 12, 4));
}

}  // namespace
}  // namespace rilievo
