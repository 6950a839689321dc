#include "rilievo/io/stroke_attributes.h"

#include <gtest/gtest.h>

namespace rilievo {
namespace {

TEST(StrokeAttributes, come_back_exactly) {
  for (const StrokeSize& strokes : {StrokeSize{0.1 / 3, 0}, {0, 5}, {1e-9, 2.5}, {0, 0}}) {
    Attributes file;
    store_strokes(strokes, file);
    EXPECT_EQ(file.empty(), !strokes.any());
    const Result<StrokeSize> read = strokes_from(file);
    ASSERT_TRUE(read.ok());
    EXPECT_EQ(*read, strokes);
  }
}

TEST(StrokeAttributes, what_is_broken_is_refused) {
  for (const char* text : {"", "1", "-1 0", "0 -1", "nan 0", "0 inf", "1e13 0", "1 x", "1 2 3"})
    EXPECT_FALSE(strokes_from({{"strokes", text}}).ok()) << text;
}

}  // namespace
}  // namespace rilievo
