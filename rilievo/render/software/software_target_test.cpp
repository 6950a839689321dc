#include "rilievo/render/software/software_target.h"

#include <gtest/gtest.h>

#include "rilievo/core/depth.h"
#include "rilievo/core/random.h"
#include "rilievo/render/shading/simd_test_helpers.h"

namespace rilievo {
namespace {

// Writes a value of its own into each sample of each pixel of some blocks.
struct NoiseDrawer final : TileDrawer {
  static std::uint32_t color(int x, int y, int sample) {
    return std::uint32_t(combine(std::uint64_t(x), std::uint64_t(y), std::uint64_t(sample)));
  }
  static bool in_parts(int x, int y) { return (x / FrameTile::kBlock + y / FrameTile::kBlock) % 2; }
  void draw_tile(FrameTile& tile) const override {
    for (int b = 0; b < FrameTile::kBlockCount; ++b) {
      const int x0 = tile.x + b % FrameTile::kBlocks * FrameTile::kBlock,
                y0 = tile.y + b / FrameTile::kBlocks * FrameTile::kBlock;
      if (tile.samples == 4 && in_parts(x0, y0)) tile.expand(b);
      for (int s = 0; s < tile.planes(b); ++s)
        for (int i = 0; i < FrameTile::kBlockPixels; ++i) {
          const int x = x0 + i % FrameTile::kBlock, y = y0 + i / FrameTile::kBlock;
          tile.plane(b, s).content[i] = color(x, y, s);
          tile.plane(b, s).inverse_z[i] = 0.25f + float(x % 3);
        }
    }
  }
};

TEST(SoftwareTarget, averages_the_samples_of_each_pixel) {
  for_each_instruction_set([&](const char* name) {
    SCOPED_TRACE(name);
    for (const int samples : {1, 4})
      for (const glm::ivec2 size : {glm::ivec2(1, 1), {64, 64}, {75, 130}, {200, 13}}) {
        SoftwareTarget target(size.x, size.y, samples);
        const NoiseDrawer noise;
        const TileDrawer* drawers[] = {&noise};
        target.draw(100, drawers);
        const Image<float> eye_z = target.eye_z();
        for (int y = 0; y < size.y; ++y)
          for (int x = 0; x < size.x; ++x) {
            const int planes = samples == 4 && NoiseDrawer::in_parts(x, y) ? 4 : 1;
            for (int k = 0; k < 4; ++k) {
              unsigned sum = 0;
              for (int s = 0; s < planes; ++s) sum += NoiseDrawer::color(x, y, s) >> (8 * k) & 255u;
              ASSERT_EQ(target.color()(x, y)[k], (sum + planes / 2) / planes) << x << " " << y;
            }
            ASSERT_EQ(eye_z(x, y), 1 / (0.25f + float(x % 3)));
          }
      }
  });
}

TEST(SoftwareTarget, is_empty_where_nothing_is_drawn) {
  SoftwareTarget target(70, 65, 4);
  target.draw(50, {}, {1, 2, 3, 4});
  for (const glm::u8vec4& texel : target.color().texels())
    EXPECT_EQ(texel, glm::u8vec4(1, 2, 3, 4));
  const Image<float> eye_z = target.eye_z();
  for (const float z : eye_z.texels()) EXPECT_EQ(z, kNoDepth);
  EXPECT_TRUE(target.objects().empty());
  target.draw_objects(50, {});
  for (const std::uint32_t object : target.objects().texels()) EXPECT_EQ(object, 0u);
}

}  // namespace
}  // namespace rilievo
