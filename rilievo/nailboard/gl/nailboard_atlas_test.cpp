#include "rilievo/nailboard/gl/nailboard_atlas.h"

#include <gtest/gtest.h>

#include <cstdlib>
#include <random>

#include "rilievo/gl/context_test_helpers.h"
#include "rilievo/nailboard/gl/board_test_helpers.h"
#include "rilievo/nailboard/gl/nailboard_capture.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo {
namespace {

class NailboardAtlasTest : public gl::ContextTest {};

TEST_F(NailboardAtlasTest, gives_back_what_was_written) {
  std::mt19937 rng(3);
  for (int bits : {2, 8, 16}) {
    auto atlas = NailboardAtlas::create({64u << 20, bits, 4});
    ASSERT_TRUE(atlas.ok());
    EXPECT_LE(atlas->bytes(), 64u << 20);
    const Nailboard a = random_board(rng, bits), b = random_board(rng, bits);
    const auto slot_a = atlas->allocate(40, 33), slot_b = atlas->allocate(40, 33);
    atlas->write(*slot_a, a);
    atlas->write(*slot_b, b);
    EXPECT_EQ(atlas->read(*slot_a, a.geometry).delta, a.delta);
    EXPECT_EQ(atlas->read(*slot_b, b.geometry).color, b.color);
  }
}

TEST_F(NailboardAtlasTest, sums_blocks_up) {
  std::mt19937 rng(5);
  for (int bits : {2, 8, 16}) {
    auto atlas = NailboardAtlas::create({64u << 20, bits, 4});
    ASSERT_TRUE(atlas.ok());
    for (int i = 0; i < 5; ++i) ASSERT_TRUE(atlas->allocate(33, 40));
    Nailboard board = random_board(rng, bits);
    for (int y = 8; y < 24; ++y)  // some blocks without holes
      for (int x = 8; x < 24; ++x) {
        if (board.delta(x, y) == delta_transparent(bits)) board.delta(x, y) = 1;
        board.color(x, y).a = 255;
      }
    board.color(9, 9).a = 254;
    const auto slot = atlas->allocate(40, 33);
    atlas->write(*slot, board);
    const OcclusionTilesView blocks = atlas->blocks(*slot);
    ASSERT_EQ(blocks.width, 40);
    ASSERT_EQ(blocks.height, 33);
    int opaque = 0;
    for (int by = 0; by < 9; ++by)
      for (int bx = 0; bx < 10; ++bx) {
        double nearest = 2, farthest = 0;
        unsigned covered_texels = 0, opaque_texels = 0;
        for (int i = 0; i < 16; ++i) {
          const int x = 4 * bx + i % 4, y = 32 - (4 * by + i / 4);  // rows run upwards
          const bool covered = y >= 0 && board.delta(x, y) != delta_transparent(bits);
          if (!covered) continue;
          covered_texels |= 1u << i;
          if (board.color(x, y).a == 255) opaque_texels |= 1u << i;
          nearest = std::min(nearest, double(decode_delta(board.delta(x, y), bits)));
          farthest = std::max(farthest, double(decode_delta(board.delta(x, y), bits)));
        }
        const OcclusionTile& block = blocks.block(bx, by);
        ASSERT_EQ(block.empty(), nearest > 1) << bx << " " << by;
        ASSERT_EQ(block.covered, covered_texels);
        ASSERT_EQ(block.opaque, opaque_texels);
        opaque += opaque_texels == 0xFFFF;
        if (block.empty()) continue;
        // Outwards by less than a step; 1e-6 for the float that decode_delta gives.
        EXPECT_LE(block.nearest_delta(), nearest + 1e-6);
        EXPECT_GT(block.nearest_delta(), nearest - 1.0 / 254 + 1e-6);
        EXPECT_GE(block.farthest_delta(), farthest - 1e-6);
        EXPECT_LT(block.farthest_delta(), farthest + 1.0 / 254 - 1e-6);
      }
    EXPECT_GT(opaque, 4);
  }
}

TEST_F(NailboardAtlasTest, refuses_a_budget_that_holds_no_picture) {
  const auto atlas = NailboardAtlas::create({1u << 20, 8, 4});
  ASSERT_FALSE(atlas.ok());
  EXPECT_NE(atlas.error().message().find("too small"), std::string::npos);
}

// The GPU against the processor: the same pictures, but for rounding.
TEST_F(NailboardAtlasTest, captures_alike_by_opengl_and_by_the_rasterizer) {
  for (const char* name : {"builtin:teapots", "builtin:bridge?triangles=100000",
                           "builtin:forest?triangles=20000", "lights"}) {
    Result<BuiltinScene> made =
        make_builtin(name == std::string("lights") ? "builtin:teapots" : name);
    ASSERT_TRUE(made.ok()) << made.error().message();
    Scene& scene = made->scene;
    if (name == std::string("lights")) {
      const glm::vec3 middle = world_bounds(scene).center();
      Light point, spot;
      point.kind = Light::Kind::point, spot.kind = Light::Kind::spot;
      point.position = middle + glm::vec3(0, 3, 2), spot.position = middle + glm::vec3(1, 4, 0);
      point.intensity = {9, 6, 3}, spot.intensity = {0, 0, 40};
      point.range = 12, spot.inner_cone = 0.2f;
      scene.lights.insert(scene.lights.end(), {point, spot});
      scene.materials[0].metallic = 0.7f;
      scene.materials[0].emissive = {0.1f, 0, 0};
    }
    auto renderer = SceneRenderer::create(scene);
    ASSERT_TRUE(renderer.ok()) << renderer.error().message();
    for (const int bits : {8, 16})
      for (const int samples : {1, 4}) {
        AtlasOptions options{64u << 20, bits, samples};
        auto by_opengl = NailboardAtlas::create(options);
        options.capture_bytes = &PlacedRaster::bytes;
        auto by_rasterizer = NailboardAtlas::create(options);
        PlacedRaster source(renderer->placed());
        ASSERT_TRUE(by_opengl.ok() && by_rasterizer.ok());
        EXPECT_LE(by_rasterizer->bytes(), 64u << 20);
        int texels = 0, covered = 0, other_coverage = 0, other_color = 0, other_depth = 0,
            beside = 0;
        for (std::uint32_t object = 0; object < scene.objects.size() && covered < 60'000;
             ++object) {
          const Box& box = renderer->object_bounds(object);
          auto camera = tight_camera(
              Projection::perspective,
              glm::dvec3(box.center()) + 3.0 * glm::dvec3(0.3, 0.6, 1) * double(box.radius()),
              {0, 1, 0}, box);
          ASSERT_TRUE(camera.ok());
          camera->width = 150, camera->height = 131;
          const auto slot_a = by_opengl->allocate(150, 131);
          const auto slot_b = by_rasterizer->allocate(150, 131);
          ASSERT_TRUE(slot_a && slot_b);
          by_opengl->capture(*renderer, *camera, {&object, 1}, *slot_a);
          by_rasterizer->write(*slot_b, source.draw(*camera, {&object, 1}, samples));
          const Nailboard a = by_opengl->read(*slot_a, picture_geometry(*camera));
          const Nailboard b = by_rasterizer->read(*slot_b, picture_geometry(*camera));
          for (std::size_t i = 0; i < a.color.texels().size(); ++i) {
            ++texels;
            const glm::ivec4 ca(a.color.texels()[i]), cb(b.color.texels()[i]);
            if (ca.a != cb.a) {
              ++other_coverage;
              continue;
            }
            if (ca.a == 0) {
              ASSERT_EQ(cb, glm::ivec4(0));
              beside += a.delta.texels()[i] != delta_transparent(bits);
              other_depth += std::abs(a.delta.texels()[i] - b.delta.texels()[i]) > 16;
              continue;
            }
            ++covered;
            // A step of Delta; in 16 bits, floats of steep slopes.
            const int step = bits > 8 ? 16 : 1;
            other_depth += std::abs(a.delta.texels()[i] - b.delta.texels()[i]) > step;
            const glm::ivec4 difference = glm::abs(ca - cb);
            other_color += std::max({difference.r, difference.g, difference.b}) > 8;
          }
          // Blocks, as the GPU makes them of the same picture.
          const auto again = by_rasterizer->allocate(150, 131);
          ASSERT_TRUE(again);
          by_rasterizer->write(*again, b);
          const OcclusionTilesView expected = by_rasterizer->blocks(*again);
          const OcclusionTilesView blocks = by_rasterizer->blocks(*slot_b);
          for (int y = 0; y < blocks_across(131); ++y)
            for (int x = 0; x < blocks_across(150); ++x)
              ASSERT_EQ(blocks.block(x, y), expected.block(x, y)) << x << " " << y;
          by_opengl->free(*slot_a), by_rasterizer->free(*slot_b), by_rasterizer->free(*again);
        }
        EXPECT_GT(covered, 20'000);
        EXPECT_GT(beside, 500);
        // A sample at an edge goes to either side. Where a triangle does not reach the middle of a
        // texel, OpenGL goes on as the triangle does, the rasterizer stays on it: a shine differs.
        EXPECT_LE(other_coverage, texels / 1000) << name << " " << samples;
        EXPECT_LE(other_depth, covered / 500) << name << " " << samples;
        EXPECT_LE(other_color, covered / 50) << name << " " << samples;
      }
  }
}

// A slot that was written to, freed and captured into keeps the capture's blocks.
TEST_F(NailboardAtlasTest, forgets_what_was_written_before_a_capture) {
  Result<BuiltinScene> made = make_builtin("builtin:teapot");
  ASSERT_TRUE(made.ok());
  auto renderer = SceneRenderer::create(made->scene);
  ASSERT_TRUE(renderer.ok());
  AtlasOptions options{64u << 20, 8, 4};
  options.capture_bytes = &PlacedRaster::bytes;
  auto atlas = NailboardAtlas::create(options);
  PlacedRaster source(renderer->placed());
  ASSERT_TRUE(atlas.ok());
  std::mt19937 rng(2);
  const Nailboard noise = random_board(rng, 8);
  const auto slot = atlas->allocate(40, 33);
  atlas->write(*slot, noise);
  auto camera =
      tight_camera(Projection::perspective, {0, 1, 9}, {0, 1, 0}, renderer->object_bounds(0));
  ASSERT_TRUE(camera.ok());
  camera->width = 40, camera->height = 33;
  const std::uint32_t object = 0;
  atlas->write(*slot, source.draw(*camera, {&object, 1}, 4));
  const Nailboard board = atlas->read(*slot, picture_geometry(*camera));
  const OcclusionTilesView blocks = atlas->blocks(*slot);
  for (int y = 0; y < 33; ++y)
    for (int x = 0; x < 40; ++x) {
      const OcclusionTile& block = blocks.block(x / 4, y / 4);
      const bool covered = board.delta(x, 32 - y) != delta_transparent(8);
      ASSERT_EQ((block.covered >> (x % 4 + 4 * (y % 4))) & 1, covered) << x << " " << y;
    }
}

TEST_F(NailboardAtlasTest, rasterizes_only_what_it_can) {
  EXPECT_FALSE(rasterizes(CaptureBy::opengl, 4));
  EXPECT_TRUE(rasterizes(CaptureBy::rasterizer, 4));
  EXPECT_FALSE(rasterizes(CaptureBy::rasterizer, 8));
  EXPECT_EQ(rasterizes(CaptureBy::automatic, 1), gl::is_software());
  // Textures and masks, too.
  Scene scene = std::move(make_builtin("builtin:teapot")->scene);
  scene.images.emplace_back(2, 2, glm::u8vec4(255));
  scene.textures.emplace_back();
  scene.materials[0].base_color_texture.texture = 0;
  scene.materials[0].alpha_mode = AlphaMode::mask;
  auto renderer = SceneRenderer::create(scene);
  ASSERT_TRUE(renderer.ok());
  for (const CaptureBy by : {CaptureBy::opengl, CaptureBy::rasterizer}) {
    auto capture = NailboardCapture::create(*renderer, by, {64u << 20, 8, 4}, DepthMode::exact);
    ASSERT_TRUE(capture.ok()) << capture.error().message();
    EXPECT_EQ(capture->rasterizer() != nullptr, by == CaptureBy::rasterizer);
  }
}

}  // namespace
}  // namespace rilievo
