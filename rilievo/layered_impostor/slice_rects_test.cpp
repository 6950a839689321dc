#include "rilievo/layered_impostor/slice_rects.h"

#include <gtest/gtest.h>

#include "rilievo/layered_impostor/jug_test_helpers.h"

namespace rilievo {
namespace {

// Two pictures of a floor that recedes from the camera, as a room's does.
LayeredImpostor floor_impostor(int size, int layers) {
  std::vector<DepthImage> pictures;
  for (const double x : {-0.5, 0.5}) {
    DepthImage picture;
    picture.camera = look_at({x, 1, 2}, {0, 0, -2}, {0, 1, 0}, 0.8, size, size, 0.5, 30);
    picture.color = ColorImage(size, size, glm::vec4(1));
    picture.depth = Image<float>(size, size, kNoDepth);
    for (int v = 0; v < size; ++v)
      for (int u = 0; u < size; ++u) {
        const glm::dvec3 eye = picture.camera.position();
        const glm::dvec3 ray = world_from_raster(picture.camera, {u + 0.5, v + 0.5}, 1.0) - eye;
        if (ray.y < -0.05) picture.depth(u, v) = float(-eye.y / ray.y);
      }
    pictures.push_back(std::move(picture));
  }
  Result<LayeredImpostor> impostor = make_layered_impostor(std::move(pictures), {.layers = layers});
  return std::move(*impostor);
}

bool inside(const TexelRect& r, int x, int y) {
  return x >= r.x0 && x < r.x1 && y >= r.y0 && y < r.y1;
}

void expect_covered(const LayeredImpostor& impostor) {
  for (int v = 0; v < int(impostor.pictures.size()); ++v) {
    const std::vector<std::vector<TexelRect>> rects = slice_rects(impostor, v);
    const std::vector<Slice>& slices = impostor.slices[std::size_t(v)];
    ASSERT_EQ(rects.size(), slices.size());
    const Image<SurfaceTexel>& texels = impostor.surfaces[std::size_t(v)].texels;
    int wrong = 0;
    for (std::size_t s = 0; s < slices.size(); ++s)
      for (int y = 0; y < texels.height(); ++y)
        for (int x = 0; x < texels.width(); ++x) {
          const SurfaceTexel& texel = texels(x, y);
          const bool shown =
              texel.q != 0 && shows(slices[s], sliced_interval(texel, impostor.slicing));
          int times = 0;
          for (const TexelRect& rect : rects[s]) times += inside(rect, x, y);
          wrong += times > 1 || (shown && times == 0) || (times && !inside(slices[s].rect, x, y));
        }
    EXPECT_EQ(wrong, 0);
  }
}

TEST(SliceRects, every_texel_that_a_slice_shows_is_in_one_of_its_rectangles) {
  // 150: no multiple of a tile.
  expect_covered(floor_impostor(150, 24));
  expect_covered(test_shapes::jug_impostor(80, {.layers = 16, .overlap = 0.5f}));
}

TEST(SliceRects, a_slanted_surface_is_drawn_in_narrow_bands) {
  const LayeredImpostor impostor = floor_impostor(384, 64);
  std::size_t covered = 0, whole = 0, drawn = 0, quads = 0;
  for (const DepthImage& picture : impostor.pictures)
    for (const float d : picture.depth.texels()) covered += d != kNoDepth;
  for (int v = 0; v < 2; ++v) {
    for (const Slice& slice : impostor.slices[std::size_t(v)]) whole += slice.rect.area();
    for (const auto& rects : slice_rects(impostor, v)) {
      quads += rects.size();
      for (const TexelRect& rect : rects) drawn += rect.area();
    }
  }
  EXPECT_LE(drawn, whole);
  // A row of tiles holds the texels of as many slices as it is high, in the worst case.
  EXPECT_LT(double(drawn), 8.0 * double(covered));
  EXPECT_LT(quads, 64u * 2 * 12);
}

}  // namespace
}  // namespace rilievo
