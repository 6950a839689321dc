#include "bench/depth_coders.h"

#include <gtest/gtest.h>

#include <random>

namespace rilievo::bench {
namespace {

TEST(DepthCoders, RvlReturnsWhatWasStored) {
  std::mt19937 random(5);
  Image<std::uint16_t> plane(61, 17);
  for (std::uint16_t& code : plane.texels()) {
    const bool sky = random() % 3 == 0;
    code = sky ? std::uint16_t(0) : std::uint16_t(random());
  }
  EXPECT_EQ(decode_rvl(encode_rvl(plane), 61, 17), plane);
}

}  // namespace
}  // namespace rilievo::bench
