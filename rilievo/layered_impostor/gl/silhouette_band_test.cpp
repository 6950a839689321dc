#include "rilievo/layered_impostor/gl/silhouette_band.h"

#include <gtest/gtest.h>

#include <algorithm>

#include "rilievo/warp/surface_pictures_test_helpers.h"

namespace rilievo {
namespace {

// Calls visit(u, v) for the texels around one, and itself.
template <class Visit>
void for_texels_around(const Image<SurfaceTexel>& texels, int x, int y, const Visit& visit) {
  for (int i = 0; i < 9; ++i) {
    const int u = x + i % 3 - 1, v = y + i / 3 - 1;
    if (u >= 0 && v >= 0 && u < texels.width() && v < texels.height()) visit(u, v);
  }
}

TEST(SilhouetteBand, is_a_texel_before_the_covered_ones_around_empty_ones) {
  std::mt19937 rng(5);
  for (Projection kind : {Projection::perspective, Projection::back_perspective}) {
    const double sigma = kind == Projection::perspective ? 1.0 : -1.0;
    const TexelSurface surface = make_texel_surface(test_surfaces::noisy(kind, 40, rng));
    const Image<float> band = silhouette_band(surface);
    int beside = 0;
    for (int y = 0; y < 40; ++y)
      for (int x = 0; x < 40; ++x) {
        // The front of a patch is at one of its corners or at its centre lines' ends.
        double front = -1e30;
        for_texels_around(surface.texels, x, y, [&](int u, int v) {
          if (surface.texels(u, v).q == 0) return;
          for (int corner = 0; corner < 9; ++corner) {
            const glm::dvec2 at = glm::dvec2(u, v) + 0.5 * glm::dvec2(corner % 3, corner / 3);
            front =
                std::max(front, sigma * surface_q(surface.texels(u, v), {u + 0.5, v + 0.5}, at));
          }
        });
        if (surface.texels(x, y).q != 0 || front == -1e30) {
          EXPECT_EQ(band(x, y), 0.0f);
          continue;
        }
        ++beside;
        front += std::abs(front) * patch_gap_per_q(surface.camera) / kPatchGap;
        EXPECT_NEAR(-sigma * double(band(x, y)), front, 1e-5 * std::abs(front));
      }
    EXPECT_GT(beside, 100);
  }
}

TEST(SilhouetteBand, no_ray_is_in_front_of_a_cell_and_not_of_the_band_in_it) {
  std::mt19937 rng(6);
  for (Projection kind : {Projection::perspective, Projection::back_perspective}) {
    const float sigma = kind == Projection::perspective ? 1.0f : -1.0f;
    const TexelSurface surface = make_texel_surface(test_surfaces::noisy(kind, 70, rng));
    const Image<float> band = silhouette_band(surface);
    const CellTexture layout = cell_texture(70, 70);
    const Image<glm::vec2> patches = pyramid_cells(surface, layout);
    Image<glm::vec2> cells = patches;
    add_band(band, surface, layout, cells);
    int side = SurfacePyramid::kBlock;
    for (const int first : layout.level_at) {
      for (int y = 0; y < (70 + side - 1) / side; ++y)
        for (int x = 0; x < (70 + side - 1) / side; ++x) {
          float front = patches(first + x, y).x;
          for (int v = y * side; v < std::min(70, (y + 1) * side); ++v)
            for (int u = x * side; u < std::min(70, (x + 1) * side); ++u)
              if (band(u, v) != 0) front = std::max(front, -sigma * band(u, v));
          EXPECT_EQ(cells(first + x, y).x, front);
          EXPECT_EQ(cells(first + x, y).y, patches(first + x, y).y);
        }
      side *= SurfacePyramid::kFactor;
    }
  }
}

}  // namespace
}  // namespace rilievo
