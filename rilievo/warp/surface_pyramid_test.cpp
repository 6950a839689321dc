#include "rilievo/warp/surface_pyramid.h"

#include <gtest/gtest.h>

#include "rilievo/warp/surface_pictures_test_helpers.h"

namespace rilievo {
namespace {

using test_surfaces::noisy;

TEST(SurfacePyramid, a_cell_holds_all_pieces_in_it) {
  std::mt19937 rng(2);
  for (Projection kind : {Projection::perspective, Projection::back_perspective}) {
    const float sigma = kind == Projection::perspective ? 1.0f : -1.0f;
    const TexelSurface surface = make_texel_surface(noisy(kind, 70, rng));
    const SurfacePyramid pyramid = make_surface_pyramid(surface);
    int side = SurfacePyramid::kBlock;
    for (const Image<SurfaceCell>& level : pyramid.levels) {
      for (int y = 0; y < 70; ++y)
        for (int x = 0; x < 70; ++x) {
          const SurfaceCell& cell = level(x / side, y / side);
          const SurfaceTexel& texel = surface.texels(x, y);
          if (texel.q == 0) {
            EXPECT_TRUE(cell.holes);
            continue;
          }
          for (int corner = 0; corner < 9; ++corner) {
            const glm::dvec2 at = glm::dvec2(x, y) + 0.5 * glm::dvec2(corner % 3, corner / 3);
            const double q = double(sigma) * surface_q(texel, {x + 0.5, y + 0.5}, at);
            EXPECT_LE(q, double(cell.front));
            EXPECT_GE(q, double(cell.back));
          }
        }
      side *= SurfacePyramid::kFactor;
    }
  }
}

}  // namespace
}  // namespace rilievo
