// Against the slow drawing (layered_impostor/warp.h); against OpenGL's in
// cache/gl/software_kinds_test.cpp.
#include "rilievo/layered_impostor/software/layered_tiles.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <random>
#include <span>
#include <vector>

#include "rilievo/core/random.h"
#include "rilievo/layered_impostor/jug_test_helpers.h"
#include "rilievo/layered_impostor/lawn_test_helpers.h"
#include "rilievo/layered_impostor/picture_textures.h"
#include "rilievo/layered_impostor/warp.h"
#include "rilievo/render/software/software_target.h"

namespace rilievo {
namespace {

// No whole number of blocks.
constexpr int kMarchedWidth = 90, kMarchedHeight = 75;

// The same from eyes in these directions, nearer and nearer to the bounds and within.
void expect_same_surfaces(LayeredImpostor impostor, std::span<const glm::dvec3> directions) {
  const LayeredOptions options;
  const auto drawable = make_layered_tiles(impostor, options);
  // The slow drawing mixes colours as they are: encoded ones, as tiles do.
  for (DepthImage& picture : impostor.pictures) {
    const Image<glm::u8vec4> encoded = encoded_colors(picture.color);
    std::transform(encoded.texels().begin(), encoded.texels().end(), picture.color.texels().begin(),
                   [](const glm::u8vec4& c) { return glm::vec4(c) / 255.0f; });
  }
  const glm::dvec3 center(impostor.bounds.center());
  const double radius = double(impostor.bounds.radius());
  int pixels = 0, coverage = 0, object = 0, depth = 0, color = 0;
  for (std::size_t i = 0; i < directions.size(); ++i) {
    // The nearest eyes stand in the bounds.
    const double distance = 0.8 + 0.2 * double(i);
    const Camera camera = look_at(center + distance * radius * directions[i], center, {0.1, 1, 0},
                                  std::min(1.4, 2.2 / distance), kMarchedWidth, kMarchedHeight,
                                  0.02 * radius, 8 * radius);
    const DepthImage expected = warp_surfaces(
        impostor, camera, {.max_views = options.max_views, .handover = options.handover});
    SoftwareTarget target(kMarchedWidth, kMarchedHeight, 1);
    const TileDrawer* drawers[] = {drawable->tiles()};
    const Instance instance{glm::dmat4(1.0), 0, kNoObject};
    drawable->draw(camera, {&instance, 1}, Output::object_id);
    target.draw_objects(camera.z_far, drawers);
    drawable->draw(camera, {&instance, 1}, Output::color);
    target.draw(camera.z_far, drawers);
    const Image<float> eye_z = target.eye_z();
    for (int v = 0; v < kMarchedHeight; ++v)
      for (int u = 0; u < kMarchedWidth; ++u) {
        const bool covered = target.objects()(u, v) != kNoObject;
        pixels += expected.covered(u, v);
        coverage += covered != expected.covered(u, v);
        if (!covered || !expected.covered(u, v)) continue;
        object += target.objects()(u, v) != expected.object(u, v);
        depth += std::abs(eye_z(u, v) - expected.depth(u, v)) > 1e-3f * expected.depth(u, v);
        const glm::vec3 off =
            255.0f * glm::vec3(expected.color(u, v)) - glm::vec3(target.color()(u, v));
        color += glm::length(off) > 2;  // rounded
      }
  }
  EXPECT_GT(pixels, 10000);
  // At edges, where rays pass by within what single precision tells.
  EXPECT_LE(coverage, pixels / 1000);
  EXPECT_LE(object, pixels / 1000);
  EXPECT_LE(depth, pixels / 1000);
  EXPECT_LE(color, pixels / 1000);
}

TEST(LayeredTiles, surfaces_are_what_the_slow_drawing_shows) {
  Random random(9);
  std::vector<glm::dvec3> directions;
  for (int i = 0; i < 16; ++i) {
    const float x = random.between(-1, 1), y = random.between(-1, 1), z = random.between(-1, 1);
    directions.push_back(glm::normalize(glm::dvec3(x, y, z)));
  }
  expect_same_surfaces(test_shapes::jug_impostor(64), directions);
}

// Each picture lost a square elsewhere, of which it knows that it knows nothing; rays ask others.
TEST(LayeredTiles, holes_in_pictures_are_looked_through_as_by_the_slow_drawing) {
  std::vector<DepthImage> views =
      test_shapes::cast_views(test_shapes::jug(), make_view_set({}), {.size = 64});
  for (std::size_t v = 0; v < views.size(); ++v)
    for (int y = 0; y < 24; ++y)
      for (int x = 0; x < 24; ++x)
        views[v].depth(8 + int(v) % 3 * 12 + x, 8 + int(v) / 3 % 3 * 12 + y) = kNoDepth;
  Result<LayeredImpostor> impostor = make_layered_impostor(std::move(views), {});
  ASSERT_TRUE(impostor.ok()) << impostor.error().message();
  Random random(11);
  std::vector<glm::dvec3> directions;
  for (int i = 0; i < 12; ++i) {
    const float x = random.between(-1, 1), y = random.between(-1, 1), z = random.between(-1, 1);
    directions.push_back(glm::normalize(glm::dvec3(x, y, z)));
  }
  expect_same_surfaces(std::move(*impostor), directions);
}

// Seen from a little above, and from below, where it is not.
TEST(LayeredTiles, a_one_sided_lawn_is_what_the_slow_drawing_shows) {
  std::mt19937 rng(9);
  std::vector<glm::dvec3> directions;
  for (int i = 0; i < 16; ++i) directions.push_back(test_shapes::grazing_direction(rng, i % 4 < 3));
  expect_same_surfaces(test_shapes::impostor_of_scene(test_shapes::lawn(false), 96), directions);
}

// A tile of a frame that shows nothing yet.
std::unique_ptr<FrameTile> empty_tile(const Camera& camera, int x, int y) {
  auto tile = std::make_unique<FrameTile>();
  tile->x = x, tile->y = y, tile->width = camera.width, tile->height = camera.height;
  tile->samples = 4;
  tile->nothing = float(1 / camera.z_far);
  tile->clear(0);
  return tile;
}

std::uint32_t content_at(FrameTile& tile, int x, int y, int sample) {
  const TilePixel at(tile, x, y);
  return tile.plane(at.block, tile.expanded[at.block] ? sample : 0).content[at.pixel];
}

// The impostor's bounds begin before all of these samples, so that it is marched.
TEST(LayeredTiles, blocks_that_show_as_near_a_surface_already_stay_as_they_are) {
  constexpr int kBlocks = FrameTile::kBlockCount;
  const LayeredImpostor impostor = test_shapes::jug_impostor(64);
  const auto drawable = make_layered_tiles(impostor, {});
  const glm::dvec3 center(impostor.bounds.center());
  const double radius = double(impostor.bounds.radius());
  const Camera camera = look_at(center + 3 * radius * glm::dvec3(0, 0, 1), center, {0.1, 1, 0}, 0.7,
                                FrameTile::kSize, FrameTile::kSize, 0.02 * radius, 8 * radius);
  const Instance instance{glm::dmat4(1.0), 0, kNoObject};
  drawable->draw(camera, {&instance, 1}, Output::color);
  const auto tile = empty_tile(camera, 0, 0);
  drawable->tiles()->draw_tile(*tile);
  EXPECT_GT(std::count(tile->changed, tile->changed + kBlocks, true), 10);
  EXPECT_GT(std::count(tile->expanded, tile->expanded + kBlocks, true), 10);

  // What each block shows nearest, at all samples of it.
  for (int block = 0; block < kBlocks; ++block) {
    float nearest = 0;
    for (int s = 0; s < tile->planes(block); ++s)
      for (const float z : tile->plane(block, s).inverse_z) nearest = std::max(nearest, z);
    std::fill_n(tile->first[block].inverse_z, FrameTile::kBlockPixels, nearest);
    tile->expanded[block] = tile->changed[block] = false;
    tile->farthest[block] = nearest;
  }
  drawable->tiles()->draw_tile(*tile);
  EXPECT_EQ(std::count(tile->changed, tile->changed + kBlocks, true), 0);
  EXPECT_EQ(std::count(tile->expanded, tile->expanded + kBlocks, true), 0);
}

// The borders of four tiles pass through the middle of a fifth one.
TEST(LayeredTiles, silhouettes_along_the_borders_of_tiles_are_as_elsewhere) {
  constexpr int kSide = FrameTile::kSize, kHalf = kSide / 2;
  const LayeredImpostor impostor = test_shapes::jug_impostor(64);
  const auto drawable = make_layered_tiles(impostor, {});
  const glm::dvec3 center(impostor.bounds.center());
  const double radius = double(impostor.bounds.radius());
  Random random(3);
  int mixed = 0, along_borders = 0, other = 0;
  for (int i = 0; i < 24; ++i) {
    const auto in = [&](double reach) { return reach * double(random.between(-1, 1)); };
    const glm::dvec3 eye =
        center + 3 * radius * glm::normalize(glm::dvec3(in(1), in(1), in(1)) + 1e-6);
    const glm::dvec3 aim = center + radius * glm::dvec3(in(0.7), in(0.7), in(0.7));
    const Camera camera =
        look_at(eye, aim, {0.1, 1, 0}, 0.8, 2 * kSide, 2 * kSide, 0.02 * radius, 8 * radius);
    const Instance instance{glm::dmat4(1.0), 0, kNoObject};
    drawable->draw(camera, {&instance, 1}, Output::color);
    const auto middle = empty_tile(camera, kHalf, kHalf);
    drawable->tiles()->draw_tile(*middle);
    for (int quarter = 0; quarter < 4; ++quarter) {
      const auto tile = empty_tile(camera, quarter % 2 * kSide, quarter / 2 * kSide);
      drawable->tiles()->draw_tile(*tile);
      // Not the border of the fifth one itself.
      for (int v = std::max(tile->y, kHalf + 1); v < std::min(tile->y, kHalf - 1) + kSide; ++v)
        for (int u = std::max(tile->x, kHalf + 1); u < std::min(tile->x, kHalf - 1) + kSide; ++u) {
          const bool at_border = u == kSide - 1 || u == kSide || v == kSide - 1 || v == kSide;
          bool differs = false, mixes = false;
          for (int s = 0; s < 4; ++s) {
            const std::uint32_t here = content_at(*tile, u, v, s);
            differs |= here != content_at(*middle, u, v, s);
            mixes |= (here == 0) != (content_at(*tile, u, v, 0) == 0);
          }
          other += differs;
          mixed += mixes, along_borders += mixes && at_border;
        }
    }
  }
  RecordProperty("other", other);
  EXPECT_GT(mixed, 1000);
  EXPECT_GT(along_borders, 50);
  EXPECT_EQ(other, 0);
}

}  // namespace
}  // namespace rilievo
