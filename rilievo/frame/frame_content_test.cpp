#include "rilievo/frame/frame_content.h"

#include <gtest/gtest.h>

namespace rilievo {
namespace {

TEST(FrameDecision, is_one_sentence) {
  EXPECT_EQ(FrameDecision{}.sentence(), "");
  EXPECT_EQ((FrameDecision{"direct", "the scene fits the frame"}).sentence(),
            "direct (the scene fits the frame)");
  EXPECT_EQ((FrameDecision{"cache", "the cheapest", 21.34, "direct", 30.06}).sentence(),
            "cache (the cheapest: 21.3 ms, direct 30.1 ms)");
}

}  // namespace
}  // namespace rilievo
