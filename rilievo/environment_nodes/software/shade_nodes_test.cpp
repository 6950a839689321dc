// Against a slow drawing, which asks every triangle about every sample; against OpenGL's in
// cache/gl/software_kinds_test.cpp.
#include "rilievo/environment_nodes/software/shade_nodes.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <span>
#include <string>
#include <vector>

#include "rilievo/environment_nodes/software/slow_nodes_test_helpers.h"

namespace rilievo {
namespace {

class ShadeNodesTest : public DrawnNodesTest {
 protected:
  // What sample s of a pixel is to show of nodes over each other: the nearest one, and what is as
  // near within what depths can tell.
  [[nodiscard]] static std::vector<SlowPixel> looks(const SlowNodes& slow, std::size_t count, int x,
                                                    int y, int s, int samples) {
    const glm::dvec2 corner(x, kShadeHeight - 1 - y);
    const auto in = [&](int sample) {
      return samples == 1 ? glm::dvec2(0.5)
                          : glm::dvec2(double(FrameTile::kSampleX[sample]),
                                       1 - double(FrameTile::kSampleY[sample]));
    };
    std::vector<SlowPixel> out(1);
    for (std::size_t n = 0; n < count; ++n) {
      const SlowSample seen = slow.look(n, corner + in(s));
      if (!(seen.inverse_z > 0)) continue;
      // A triangle has one colour in a pixel, at its depth in the first sample if it is seen there.
      const SlowSample first = slow.look(n, corner + in(0));
      const bool same = first.inverse_z > 0 && first.triangle == seen.triangle;
      const SlowTexel texel = slow.shade(n, same ? first : seen, corner + 0.5);
      out.push_back({seen.inverse_z, texel.color, texel.object});
    }
    std::sort(out.begin(), out.end(),
              [](const SlowPixel& a, const SlowPixel& b) { return a.inverse_z > b.inverse_z; });
    while (out.back().inverse_z < out[0].inverse_z - kDepthError * (1 + out[0].inverse_z))
      out.pop_back();
    return out;
  }

  struct Differences {
    int samples = 0, shown = 0, skins = 0, depth = 0, color = 0;
  };
  // The visibility buffer's depth has 24 bits.
  static constexpr double kDepthError = 1e-5;
  // A sample as it was drawn, with what it is to show: one of these, if depths do not tell which is
  // in front. The depth may be off by `slope` besides.
  static void compare(Differences& found, std::span<const SlowPixel> expected, double slope,
                      const FrameTile::Plane& drawn, int pixel, float nothing) {
    const double z = double(drawn.inverse_z[pixel]);
    const bool shown = z > double(nothing);
    ++found.samples, found.shown += shown;
    bool depth = shown != (expected[0].inverse_z > 0), color = false;
    if (shown && !depth) {
      depth = color = true;
      for (const SlowPixel& one : expected) {
        if (std::abs(z - one.inverse_z) > kDepthError * (1 + one.inverse_z) + slope) continue;
        depth = false;
        const std::uint32_t content = drawn.content[pixel];
        bool alike = true;
        for (int c = 0; c < 3; ++c)  // both are rounded
          alike = alike && std::abs(double(content >> (8 * c) & 0xff) - one.color[c]) <= 1.01;
        color = color && !alike;
      }
    }
    found.depth += depth, found.color += color && !depth;
  }
  // Where a sample lies within 1/256 of a pixel of an edge, either side is right; of skins that are
  // narrow in part, where the width is the limit.
  static void expect_few(const Differences& found) {
    EXPECT_GT(found.shown, found.samples / 2);
    EXPECT_LE(found.depth, found.samples / 200) << "of " << found.samples;
    EXPECT_LE(found.color, found.samples / 200) << "of " << found.samples;
  }
};

TEST_F(ShadeNodesTest, merged_nodes_are_what_the_slow_drawing_shows) {
  Random random(5);
  for (const NodeMerge merge :
       {NodeMerge::binary, NodeMerge::weighted, NodeMerge::positional, NodeMerge::first})
    for (const bool skin : {false, true}) {
      SCOPED_TRACE(std::to_string(int(merge)) + (skin ? ", skins" : ""));
      Differences found;
      for (int i = 0; i < 6; ++i) {
        const Camera frame = random_camera(random);
        const NodeDrawOptions options{.merge = merge, .skin = skin};
        const SlowNodes slow(frame, first(3), options);
        const auto tile = drawn(frame, 3, options, 1, Output::color);
        for (int y = 0; y < frame.height; ++y)
          for (int x = 0; x < frame.width; ++x) {
            const SlowPixel pixel = slow.merged({x + 0.5, frame.height - y - 0.5});
            const TilePixel at(*tile, x, y);
            const FrameTile::Plane& plane = tile->first[at.block];
            compare(found, {&pixel, 1}, 0, plane, at.pixel, tile->nothing);
          }
      }
      expect_few(found);
    }
}

// One node, or one over the other, with one and with four samples a pixel.
TEST_F(ShadeNodesTest, nodes_over_each_other_are_what_the_slow_drawing_shows) {
  Random random(6);
  for (const int samples : {1, 4})
    for (const std::size_t count : {std::size_t(1), std::size_t(3)}) {
      SCOPED_TRACE(std::to_string(samples) + " samples, nodes: " + std::to_string(count));
      Differences found;
      for (int i = 0; i < 6; ++i) {
        const Camera frame = random_camera(random);
        const NodeDrawOptions options{.merge = NodeMerge::layering, .skin = i % 2 == 0};
        const SlowNodes slow(frame, first(count), options);
        const auto tile = drawn(frame, count, options, samples, Output::color);
        for (int y = 0; y < frame.height; ++y)
          for (int x = 0; x < frame.width; ++x)
            for (int s = 0; s < samples; ++s) {
              const TilePixel at(*tile, x, y);
              if (s > 0 && !tile->expanded[at.block]) continue;
              // A block has in all samples what its first one shows until it expands.
              double slope = 0;
              const std::vector<SlowPixel> first = looks(slow, count, x, y, 0, samples);
              std::vector<SlowPixel> expected = looks(slow, count, x, y, s, samples);
              if (s > 0) slope = std::abs(first[0].inverse_z - expected[0].inverse_z);
              compare(found, expected, slope, tile->plane(at.block, s), at.pixel, tile->nothing);
            }
      }
      expect_few(found);
    }
}

TEST_F(ShadeNodesTest, identifiers_are_those_of_the_node_that_counts_most) {
  Random random(7);
  for (const NodeMerge merge : {NodeMerge::layering, NodeMerge::binary, NodeMerge::weighted,
                                NodeMerge::positional, NodeMerge::first}) {
    SCOPED_TRACE(int(merge));
    int shown = 0, other = 0;
    for (int i = 0; i < 6; ++i) {
      const Camera frame = random_camera(random);
      const std::size_t count = i % 2 ? 3 : 1;
      const NodeDrawOptions options{.merge = merge, .skin = i % 3 == 0};
      // A node alone is not merged.
      const SlowNodes slow(
          frame, first(count),
          {.merge = count == 1 ? NodeMerge::layering : merge, .skin = options.skin});
      const auto tile = drawn(frame, count, options, 1, Output::object_id);
      for (int y = 0; y < frame.height; ++y)
        for (int x = 0; x < frame.width; ++x) {
          const bool over = count == 1 || merge == NodeMerge::layering;
          const SlowPixel pixel = over ? looks(slow, count, x, y, 0, 1)[0]
                                       : slow.merged({x + 0.5, frame.height - y - 0.5});
          const TilePixel at(*tile, x, y);
          shown += pixel.object != 0;
          other += tile->first[at.block].content[at.pixel] != pixel.object;
        }
    }
    EXPECT_GT(shown, 5000);
    // At edges, as above, halfway between texels, and where two nodes count alike.
    EXPECT_LE(other, shown / 100);
  }
}

}  // namespace
}  // namespace rilievo
