#include "rilievo/measure/visibility.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

namespace rilievo {
namespace {

// Blobs of a few identifiers, some of them 0.
IdImage random_ids(std::mt19937& rng, int w, int h) {
  IdImage ids(w, h);
  for (int i = 0; i < 4; ++i) {
    const int x0 = int(rng() % w), y0 = int(rng() % h);
    const int x1 = x0 + int(rng() % w), y1 = y0 + int(rng() % h);
    const std::uint32_t id = rng() % 4;
    for (int y = y0; y < std::min(y1, h); ++y)
      for (int x = x0; x < std::min(x1, w); ++x) ids(x, y) = id;
  }
  return ids;
}

// The header's words: every neighbour of every pixel.
bool near_boundary(const IdImage& ids, int x, int y, int margin) {
  for (int j = y - margin; j <= y + margin; ++j)
    for (int i = x - margin; i <= x + margin; ++i)
      if (i >= 0 && i < ids.width() && j >= 0 && j < ids.height() && ids(i, j) != ids(x, y))
        return true;
  return false;
}

TEST(Visibility, counts_what_the_slow_definition_counts) {
  std::mt19937 rng(1);
  for (int round = 0; round < 300; ++round) {
    const int w = 1 + int(rng() % 30), h = 1 + int(rng() % 30);
    const IdImage truth = random_ids(rng, w, h);
    IdImage other = truth;
    for (std::uint32_t& id : other.texels())
      if (rng() % 5 == 0) id = rng() % 4;
    const int margin = int(rng() % 4);
    Visibility slow;
    for (int y = 0; y < h; ++y)
      for (int x = 0; x < w; ++x) {
        if (near_boundary(truth, x, y, margin)) continue;
        ++slow.counted;
        slow.wrong += truth(x, y) != other(x, y);
        slow.counted_objects += truth(x, y) != 0;
        slow.uncovered += truth(x, y) != 0 && other(x, y) == 0;
      }
    const Visibility fast = compare_visibility(truth, other, margin);
    ASSERT_EQ(fast.counted, slow.counted);
    ASSERT_EQ(fast.wrong, slow.wrong);
    ASSERT_EQ(fast.counted_objects, slow.counted_objects);
    ASSERT_EQ(fast.uncovered, slow.uncovered);
  }
}

TEST(Visibility, shares_are_of_what_is_counted) {
  // 10 x 10: the left half is object 7. Columns 4 and 5 touch the boundary: 80 pixels are counted.
  IdImage truth(10, 10);
  for (int y = 0; y < 10; ++y)
    for (int x = 0; x < 5; ++x) truth(x, y) = 7;
  IdImage other = truth;
  for (int y = 0; y < 10; ++y) other(4, y) = 0;  // an edge that moved by a pixel is no fault
  EXPECT_EQ(compare_visibility(truth, other).wrong_share(), 0);
  other(0, 0) = 0;  // wrong and uncovered
  other(1, 0) = 9;  // wrong
  other(9, 9) = 7;  // wrong: an object where the sky should be
  const Visibility v = compare_visibility(truth, other);
  EXPECT_EQ(v.counted, 80u);
  EXPECT_DOUBLE_EQ(v.wrong_share(), 3.0 / 80);
  EXPECT_DOUBLE_EQ(v.uncovered_share(), 1.0 / 40);
}

TEST(Visibility, a_frame_of_boundaries_counts_nothing) {
  IdImage board(8, 8);
  for (int y = 0; y < 8; ++y)
    for (int x = 0; x < 8; ++x) board(x, y) = std::uint32_t(x + y) % 2;
  const Visibility v = compare_visibility(board, IdImage(8, 8));
  EXPECT_EQ(v.counted, 0u);
  EXPECT_EQ(v.wrong_share(), 0);
  EXPECT_EQ(v.uncovered_share(), 0);
}

TEST(DepthErrors, are_relative_to_the_true_depth_and_of_the_same_object_only) {
  const IdImage truth(4, 4, 3u);
  IdImage ids = truth;
  Image<float> true_z(4, 4, 10.0f), z(4, 4, 10.0f);
  z(0, 0) = 11.0f;                            // 10 % off
  z(1, 0) = 5.0f;                             // 50 % off
  ids(2, 0) = 4, z(2, 0) = 100.0f;            // another object
  z(3, 0) = INFINITY;                         // nothing there
  true_z(0, 1) = INFINITY, true_z(1, 1) = 0;  // no true depth
  Histogram errors;
  add_depth_errors(truth, ids, true_z, z, errors);
  EXPECT_EQ(errors.count(), 12u);
  EXPECT_EQ(errors.percentile(0.5), 0);
  // Rounded up by at most one part in 64, never down.
  EXPECT_GE(errors.percentile(1.0), 0.5);
  EXPECT_LE(errors.percentile(1.0), 0.5 * (1 + 1.0 / 64));
  EXPECT_GE(errors.percentile(11.0 / 12), 0.1f);
  EXPECT_LE(errors.percentile(11.0 / 12), 0.1 * (1 + 1.0 / 64) + 1e-7);
}

TEST(Visibility, an_object_is_missing_if_enough_of_it_was_counted_and_none_is_drawn) {
  IdImage truth(24, 20, 0), frame(24, 20, 0);
  const auto fill = [](IdImage& image, int left, int top, int w, int h, std::uint32_t object) {
    for (int y = top; y < top + h; ++y)
      for (int x = left; x < left + w; ++x) image(x, y) = object;
  };
  fill(truth, 2, 2, 10, 10, 1);  // 4 x 4 pixels are three or more away from its boundary
  fill(truth, 13, 2, 9, 10, 2);  // 3 x 4: too few
  EXPECT_EQ(count_missing_objects(truth, truth), 0);
  EXPECT_EQ(count_missing_objects(truth, frame), 1);
  EXPECT_EQ(count_missing_objects(truth, frame, 2), 2);
  EXPECT_EQ(count_missing_objects(truth, frame, 3, 12), 2);
  frame(23, 19) = 1;  // anywhere
  EXPECT_EQ(count_missing_objects(truth, frame), 0);
}

}  // namespace
}  // namespace rilievo
