// Do OpenGL and processors draw the same frame from the same nailboards?
#include <gtest/gtest.h>

#include <algorithm>
#include <vector>

#include "rilievo/core/sanitized_test_helpers.h"
#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/measure/psnr.h"
#include "rilievo/nailboard/gl/nailboard_drawer.h"
#include "rilievo/nailboard/software/composer_test_helpers.h"
#include "rilievo/nailboard/software/nailboard_composer.h"
#include "rilievo/render/opengl/frame_target.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo {
namespace {

constexpr int kSameWidth = 480, kSameHeight = 270, kSameCount = sanitized_cases(120);

using SoftwareSameTest = gl::ContextTest;

// Notes the pixels whose samples differ.
struct PartsSpy final : TileDrawer {
  mutable Image<std::uint8_t> parts{kSameWidth, kSameHeight};  // each pixel written by one thread

  void draw_tile(FrameTile& tile) const override {
    for (int b = 0; b < FrameTile::kBlockCount; ++b)
      for (int i = 0; i < FrameTile::kBlockPixels; ++i) {
        const int x = tile.x + b % FrameTile::kBlocks * FrameTile::kBlock + i % FrameTile::kBlock,
                  y = tile.y + b / FrameTile::kBlocks * FrameTile::kBlock + i / FrameTile::kBlock;
        bool differ = false;
        for (int s = 1; s < tile.planes(b); ++s)
          differ = differ || tile.plane(b, s).inverse_z[i] != tile.first[b].inverse_z[i];
        if (x < kSameWidth && y < kSameHeight) parts(x, y) = differ;
      }
  }
};

// The share of pixels around which both show one object alone, and of those, the share in which no
// channel differs by more than 2.
struct Same {
  double inner = 0, alike = 0;
};

Same compare_inside(const Rgba8Image& a, const Rgba8Image& b, const Image<std::uint32_t>& objects,
                    const Image<std::uint32_t>& others, const Image<std::uint8_t>& parts) {
  int inner = 0, alike = 0;
  for (int y = 1; y < a.height() - 1; ++y)
    for (int x = 1; x < a.width() - 1; ++x) {
      bool edge = parts(x, y) != 0;
      for (int k = 0; k < 9; ++k) {
        const int u = x + k % 3 - 1, v = y + k / 3 - 1;
        edge = edge || objects(u, v) != objects(x, y) || others(u, v) != objects(x, y);
      }
      if (edge) continue;
      ++inner;
      int most = 0;
      for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(a(x, y)[c] - b(x, y)[c]));
      alike += most <= 2;
    }
  return {double(inner) / (a.width() * a.height()), double(alike) / inner};
}

TEST_F(SoftwareSameTest, opengl_and_processors_draw_the_same) {
  auto drawer = NailboardDrawer::create();
  auto probe = ProbeTarget::create(kSameWidth, kSameHeight);
  ASSERT_TRUE(drawer.ok() && probe.ok());
  int seed = 0;
  for (const int samples : {1, 4})
    for (const int bits : {8, 16}) {
      auto atlas = NailboardAtlas::create({std::size_t(96) << 20, bits, 1});
      auto target = FrameTarget::create(kSameWidth, kSameHeight, samples);
      ASSERT_TRUE(atlas.ok() && target.ok());
      Random random(std::uint64_t(++seed));
      const Camera frame = random_frame(random, kSameWidth, kSameHeight);
      std::vector<NailboardInstance> on_gpu;
      std::vector<SoftwareNailboard> pictures(kSameCount);
      std::vector<SoftwareNailboardInstance> in_memory;
      for (int i = 0; i < kSameCount; ++i) {
        const Nailboard board = random_picture(random, frame, bits, 200);
        const auto slot = atlas->allocate(board.color.width(), board.color.height());
        ASSERT_TRUE(slot);
        atlas->write(*slot, board);
        pictures[std::size_t(i)].assign(board);
        const auto object = std::uint32_t(i + 1);
        on_gpu.push_back({*slot, board.geometry, glm::dmat4(1), object});
        in_memory.push_back({&pictures[std::size_t(i)], board.geometry, glm::dmat4(1), object});
        if (i % 5 == 0) {
          on_gpu.back().share_to = in_memory.back().share_to = random.unit();
        }
      }
      for (const DepthMode mode : {DepthMode::exact, DepthMode::linear, DepthMode::flat}) {
        SCOPED_TRACE(::testing::Message()
                     << samples << " samples, " << bits << " bits, mode " << int(mode));
        target->begin();
        drawer->draw(*atlas, frame, mode, on_gpu);
        target->resolve();
        const Rgba8Image expected = target->read();
        probe->begin();
        drawer->draw_objects(*atlas, frame, mode, on_gpu);
        const Image<std::uint32_t> objects = probe->read_objects();

        SoftwareTarget software(kSameWidth, kSameHeight, samples);
        NailboardComposer composer;
        composer.place(frame, mode, in_memory);
        const PartsSpy spy;
        const TileDrawer* drawers[] = {&composer, &spy};
        software.draw(frame.z_far, drawers);
        software.draw_objects(frame.z_far, {drawers, 1});

        const Same same =
            compare_inside(expected, software.color(), objects, software.objects(), spy.parts);
        EXPECT_GT(same.inner, 0.3);
        EXPECT_GE(same.alike, 0.999);
        // Edges included: the same samples are covered, but for a few where rounding decides, which
        // it does differently with each compiler. A pixel of one sample is then wholly off.
        EXPECT_GT(psnr_db(expected, software.color()), samples == 1 ? 44 : 45);
        std::size_t other = 0;
        for (std::size_t i = 0; i < objects.texels().size(); ++i)
          other += objects.texels()[i] != software.objects().texels()[i];
        EXPECT_LT(double(other), 0.002 * double(objects.texels().size()));
        RecordProperty("psnr", std::to_string(psnr_db(expected, software.color())));
      }
    }
}

}  // namespace
}  // namespace rilievo
