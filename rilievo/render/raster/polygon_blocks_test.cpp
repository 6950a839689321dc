#include "rilievo/render/raster/polygon_blocks.h"

#include <gtest/gtest.h>

#include <memory>
#include <random>

#include "rilievo/render/shading/simd_test_helpers.h"

namespace rilievo {
namespace {

constexpr int kBlock = FrameTile::kBlock;
constexpr TileDepth kTileDepth{0.01f, 9.0f};

// Few triangles and few depths, so that samples are alike, or hidden, in all ways.
SampleBuffer random_samples(std::mt19937& rng, int width, int height, int samples) {
  SampleBuffer in;
  in.begin(width, height, samples);
  const unsigned share = 1 + rng() % 4;  // of what is covered
  std::uint32_t triangle = 0;
  for (std::size_t i = 0; i < in.stride * std::size_t(height); ++i) {
    if (rng() % 3 == 0) triangle = std::uint32_t(rng() % 3);
    in.triangle[i] = triangle;
    in.depth[i] = rng() % 4 < share ? float(rng() % 4) / 4.0f : 1.0f;
  }
  return in;
}

// By definition, sample by sample.
struct SlowBlock {
  const SampleBuffer& in;
  int x, y;

  [[nodiscard]] bool within(int column, int row) const {
    return x + column < in.width && y + row < in.height;
  }
  [[nodiscard]] std::size_t at(int column, int row, int s) const {
    return in.row(in.height - 1 - y - row) + std::size_t((x + column) * in.samples + s);
  }
  [[nodiscard]] bool covered(int column, int row, int s) const {
    return within(column, row) && in.depth[at(column, row, s)] < 1;
  }
  [[nodiscard]] bool whole(int column, int row) const {
    for (int s = 0; s < in.samples; ++s)
      if (!covered(column, row, s) ||
          in.triangle[at(column, row, s)] != in.triangle[at(column, row, 0)])
        return false;
    return true;
  }
  [[nodiscard]] float inverse_z(int column, int row, int s) const {
    return kTileDepth(in.depth[at(column, row, s)]);
  }
};

TEST(PolygonBlocks, are_what_each_sample_says_by_itself) {
  for_each_instruction_set([](const char* name) {
    std::mt19937 rng(3);
    const auto tile = std::make_unique<FrameTile>();
    int partial = 0, hidden = 0;
    for (int round = 0; round < 300; ++round) {
      const int samples = round % 2 ? 4 : 1, width = 1 + int(rng() % 17), height = 9;
      const SampleBuffer in = random_samples(rng, width, height, samples);
      const int block = int(rng() % FrameTile::kBlockCount);
      const SlowBlock slow{in, int(rng() % unsigned((width + 7) / 8)) * kBlock,
                           int(rng() % 2) * kBlock};
      const BlockSamples fast(in, slow.x, slow.y);
      bool any = false, in_part = false;
      for (int row = 0; row < kBlock; ++row)
        for (int column = 0; column < kBlock; ++column) {
          bool covered = false;
          for (int s = 0; s < samples; ++s) covered |= slow.covered(column, row, s);
          any |= covered, in_part |= covered && !slow.whole(column, row);
        }
      const BlockCoverage coverage = find_coverage(fast);
      ASSERT_EQ(coverage.any, any) << name;
      ASSERT_EQ(coverage.partial, in_part) << name;
      partial += in_part;

      tile->samples = samples;
      tile->expanded[block] = samples == 4 && in_part;
      const int planes = samples == 4 ? tile->planes(block) : 1;
      for (int s = 0; s < planes; ++s)
        for (int i = 0; i < FrameTile::kBlockPixels; ++i) {
          tile->plane(block, s).inverse_z[i] = kTileDepth(float(rng() % 5) / 4.0f);
          tile->plane(block, s).content[i] = 7;
        }
      const auto before = std::make_unique<FrameTile>(*tile);
      draw_depths(fast, kTileDepth, 9, *tile, block);
      for (int s = 0; s < planes; ++s)
        for (int i = 0; i < FrameTile::kBlockPixels; ++i) {
          const int column = i % kBlock, row = i / kBlock;
          const float old = before->plane(block, s).inverse_z[i];
          const bool nearer = slow.covered(column, row, s) && slow.inverse_z(column, row, s) > old;
          ASSERT_EQ(tile->plane(block, s).inverse_z[i],
                    nearer ? slow.inverse_z(column, row, s) : old);
          ASSERT_EQ(tile->plane(block, s).content[i], nearer ? 9u : 7u);
        }

      // Something is drawn over it, or the block is expanded only now.
      if (samples == 4 && round % 4 == 1) tile->expand(block);
      for (int i = 0; i < FrameTile::kBlockPixels; ++i)
        if (rng() % 4 == 0) tile->first[block].inverse_z[i] = 9.5f;
      for (int row = 0; row < std::min(kBlock, height - slow.y); ++row) {
        const VisibleRow seen = find_visible(fast, kTileDepth, *tile, block, row);
        for (int column = 0; column < kBlock; ++column) {
          const bool whole = slow.whole(column, row);
          ASSERT_EQ(seen.whole >> column & 1, int(whole)) << name;
          for (int s = 0; s < samples; ++s) {
            const int of = tile->expanded[block] && samples == 4 ? s : 0;
            const float now = tile->plane(block, of).inverse_z[row * kBlock + column];
            const bool shown =
                slow.covered(column, row, s) && (now == slow.inverse_z(column, row, s) ||
                                                 (whole && now == slow.inverse_z(column, row, 0)));
            ASSERT_EQ(seen.visible[s] >> column & 1, int(shown)) << name;
            hidden += slow.covered(column, row, s) && !shown;
          }
        }
      }
    }
    EXPECT_GT(partial, 50);
    EXPECT_GT(hidden, 1000);
  });
}

}  // namespace
}  // namespace rilievo
