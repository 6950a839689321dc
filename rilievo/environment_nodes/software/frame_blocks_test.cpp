// The last node is drawn where it is needed, and what is drawn there is as if it were everywhere.
#include "rilievo/environment_nodes/software/frame_blocks.h"

#include <gtest/gtest.h>

#include "rilievo/environment_nodes/software/slow_nodes_test_helpers.h"

namespace rilievo {
namespace {

class LastInPartTest : public DrawnNodesTest {};

TEST(FrameBlocks, a_rectangle_touches_a_marked_block_if_one_of_its_pixels_lies_in_it) {
  Random random(3);
  for (int i = 0; i < 200; ++i) {
    const int width = int(random.between(1, 60)), height = int(random.between(1, 60));
    const auto within = [&](int size) {
      return std::min(int(random.between(0, float(size))), size - 1);
    };
    FrameBlocks blocks;
    blocks.begin(width, height);
    for (int k = 0; k < 3; ++k) {
      const int x = int(random.between(-2, 8)), y = int(random.between(-2, 8));
      blocks.mark(x, y, x + int(random.between(0, 2)), y);
    }
    blocks.finish();
    int asked = 0;
    for (int k = 0; k < 20; ++k, ++asked) {
      const int x0 = within(width), y0 = within(height), x1 = std::max(x0, within(width)),
                y1 = std::max(y0, within(height));
      bool any = false;
      for (int y = y0; y <= y1; ++y)
        for (int x = x0; x <= x1; ++x) any = any || blocks.holds(x, y);
      EXPECT_EQ(blocks.any(x0, y0, x1, y1), any);
    }
    EXPECT_EQ(asked, 20);
  }
}

TEST_F(LastInPartTest, in_all_parts_it_is_drawn_as_everywhere) {
  Random random(4);
  FrameParts all;
  all.marked.set();
  for (int i = 0; i < 6; ++i) {
    const Camera frame = random_camera(random);
    const Output output = i % 3 == 2 ? Output::object_id : Output::color;
    const int samples = output == Output::color ? 4 : 1;
    NodeDrawOptions options{NodeMerge::positional, true};
    const auto everywhere = drawn(frame, 3, options, samples, output);
    options.last_in = &all;
    const auto parts = drawn(frame, 3, options, samples, output);
    for (int block = 0; block < FrameTile::kBlockCount; ++block) {
      ASSERT_EQ(everywhere->planes(block), parts->planes(block));
      for (int s = 0; s < parts->planes(block); ++s)
        for (int p = 0; p < FrameTile::kBlockPixels; ++p)
          ASSERT_EQ(everywhere->plane(block, s).content[p], parts->plane(block, s).content[p]);
    }
  }
}

// Do the bytes differ by at most 1?
bool are_about_equal(std::uint32_t a, std::uint32_t b) {
  for (int shift = 0; shift < 32; shift += 8)
    if (std::abs(int(a >> shift & 0xff) - int(b >> shift & 0xff)) > 1) return false;
  return true;
}

// What is neither near the marked parts nor near a gap is as two nodes draw it.
TEST_F(LastInPartTest, elsewhere_it_is_left_out) {
  Random random(5);
  int with = 0, without = 0, neither = 0, matters = 0;
  for (int i = 0; i < 40; ++i) {
    const Camera frame = random_camera(random);
    FrameParts some;
    const int column = int(random.between(2, 40)), row = int(random.between(2, 20));
    for (int y = row; y < row + 6; ++y)
      for (int x = column; x < column + 6; ++x) some.marked.set(FrameParts::number(x, y));
    NodeDrawOptions options{NodeMerge::positional, true};
    const auto two = drawn(frame, 2, options, 1, Output::color),
               three = drawn(frame, 3, options, 1, Output::color);
    options.last_in = &some;
    const auto part = drawn(frame, 3, options, 1, Output::color);
    for (int y = 0; y < frame.height; ++y)
      for (int x = 0; x < frame.width; ++x) {
        const TilePixel at(*part, x, y);
        const auto of = [&](const FrameTile& tile) {
          return tile.first[at.block].content[at.pixel];
        };
        const int part_x = x * FrameParts::kColumns / frame.width,
                  part_y = FrameParts::kRows - 1 - y * FrameParts::kRows / frame.height;
        if (some.holds(part_x, part_y)) {
          EXPECT_EQ(of(*part), of(*three));
          ++with;
        } else {
          // Weights are shares of those of all nodes: they are rounded.
          neither += !are_about_equal(of(*part), of(*two)) && of(*part) != of(*three);
          without += of(*part) == of(*two) && of(*two) != of(*three);
        }
        matters += of(*two) != of(*three);
      }
  }
  EXPECT_GT(with, 1000);
  EXPECT_GT(matters, 1000);
  EXPECT_GT(without, matters / 10);
  EXPECT_EQ(neither, 0);
}

}  // namespace
}  // namespace rilievo
