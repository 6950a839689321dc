#include "rilievo/warp/surface_pyramid.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "rilievo/capture/shapes_test_helpers.h"

namespace rilievo {
namespace {

using test_shapes::random_direction;

// A wall before the camera, slanted, with `holes` squares of 3 x 3 texels lost.
DepthImage wall(Projection projection, int size, int holes, std::mt19937& rng) {
  DepthImage picture;
  picture.camera = look_at({0, 0, 5}, {0, 0, 0}, {0, 1, 0}, 0.8, size, size, 1, 20);
  picture.camera.projection = projection;
  picture.color = ColorImage(size, size, glm::vec4(1));
  picture.depth = Image<float>(size, size, kNoDepth);
  for (int y = 0; y < size; ++y)
    for (int x = 0; x < size; ++x)
      picture.depth(x, y) = 4.0f + 2.0f * float(x) / float(size) + 1.0f * float(y) / float(size);
  std::uniform_int_distribution<int> place(0, size - 4);
  for (int i = 0; i < holes; ++i) {
    const int u = place(rng), v = place(rng);
    for (int y = 0; y < 3; ++y)
      for (int x = 0; x < 3; ++x) picture.depth(u + x, v + y) = kNoDepth;
  }
  return picture;
}

// Depths as sensors give them: steps everywhere, a tenth of all texels lost.
DepthImage noisy(Projection projection, int size, std::mt19937& rng) {
  DepthImage picture = wall(projection, size, 0, rng);
  std::uniform_real_distribution<float> u(0, 1);
  for (float& d : picture.depth.texels()) d = u(rng) < 0.1f ? kNoDepth : d + 0.2f * u(rng);
  return picture;
}

DepthImage jug_picture(Projection projection, int size, std::mt19937& rng) {
  const Scene scene = test_shapes::jug();
  const Result<RayScene> rays = RayScene::create(scene);
  return cast_picture(*rays, *view_camera(world_bounds(scene), random_direction(rng),
                                          {.projection = projection, .size = size}));
}

// Of a ray that was lost behind an outline nobody asks where.
bool walks_agree(const SurfaceHit& slow, const SurfaceHit& fast) {
  if (fast.hit != slow.hit || fast.passed_behind != slow.passed_behind ||
      fast.passed_outline != slow.passed_outline)
    return false;
  if (!slow.hit && (!slow.passed_behind || slow.passed_outline)) return true;
  // 1e-9: rounding of doubles along the segment.
  return fast.texel == slow.texel && std::abs(fast.t - slow.t) < 1e-9;
}

TEST(SurfacePyramid, a_walk_over_cells_meets_what_the_walk_over_texels_meets) {
  std::mt19937 rng(1);
  int hits = 0, lost = 0, outlines = 0, wrong = 0;
  for (int i = 0; i < 12; ++i) {
    const Projection kind = i % 2 ? Projection::perspective : Projection::back_perspective;
    // Larger than the coarsest cell, and no multiple of any.
    const DepthImage picture = i % 6 < 2   ? jug_picture(kind, 200, rng)
                               : i % 6 < 4 ? wall(kind, 203, 60, rng)
                                           : noisy(kind, 150, rng);
    const TexelSurface surface = make_texel_surface(picture);
    const SurfacePyramid pyramid = make_surface_pyramid(surface);
    for (int k = 0; k < 3000; ++k) {
      const glm::dvec3 eye = 6.0 * random_direction(rng), to = 1.2 * random_direction(rng);
      const std::optional<DisparitySegment> segment =
          disparity_segment(picture.camera, eye, eye + 2.0 * (to - eye));
      if (!segment) continue;
      const SurfaceHit slow = intersect(surface, *segment);
      const SurfaceHit fast = intersect(surface, pyramid, *segment);
      hits += slow.hit, lost += slow.passed_behind && !slow.hit, outlines += slow.passed_outline;
      wrong += !walks_agree(slow, fast);
    }
  }
  EXPECT_GT(hits, 3000);
  EXPECT_GT(lost, 3000);
  EXPECT_GT(outlines, 3000);
  // A segment through a texel's very corner may be told either way.
  EXPECT_LE(wrong, 2);
}

// Where the size is no multiple of a cell's, the last cells reach beyond the picture.
TEST(SurfacePyramid, a_walk_along_a_border_meets_what_the_walk_over_texels_meets) {
  std::mt19937 rng(4);
  std::uniform_real_distribution<double> u(0, 1);
  int hits = 0, lost = 0;
  for (int i = 0; i < 60; ++i) {
    const int size = 5 + int(rng() % 40);
    const Projection kind = i % 2 ? Projection::perspective : Projection::back_perspective;
    const TexelSurface surface =
        make_texel_surface(i % 4 < 2 ? wall(kind, size, 2, rng) : noisy(kind, size, rng));
    const SurfacePyramid pyramid = make_surface_pyramid(surface);
    for (int k = 0; k < 100; ++k) {
      const int across = k % 2;
      const bool last = k % 4 < 2;
      const auto end = [&] {
        glm::dvec3 p{size * u(rng), size * u(rng), 0.12 + 0.18 * u(rng)};
        const double away = std::array{0.0, 1e-9, 1e-3, 0.4}[rng() % 4];
        p[across] = last ? size - away : away;
        return p;
      };
      const DisparitySegment segment{end(), end()};
      const SurfaceHit slow = intersect(surface, segment);
      EXPECT_TRUE(walks_agree(slow, intersect(surface, pyramid, segment))) << i << " " << k;
      hits += slow.hit, lost += slow.passed_behind && !slow.hit;
    }
  }
  EXPECT_GT(hits, 500);
  EXPECT_GT(lost, 1000);
}

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

TEST(SurfacePyramid, a_ray_far_from_the_surface_costs_cells_and_not_texels) {
  std::mt19937 rng(3);
  constexpr int kSize = 512;
  for (Projection kind : {Projection::perspective, Projection::back_perspective}) {
    const DepthImage picture = wall(kind, kSize, 200, rng);
    const TexelSurface surface = make_texel_surface(picture);
    const SurfacePyramid pyramid = make_surface_pyramid(surface);
    std::uniform_real_distribution<double> u(0, kSize);
    WalkCost cost;
    int rays = 0, behind = 0;
    // From edge to edge of the picture, half a metre and more before the wall or behind it.
    for (int i = 0; i < 400; ++i) {
      const double offset = i % 2 ? 0.6 : -0.6;
      const auto beside = [&](const glm::dvec2& at) {
        const double z = 4 + 2 * at.x / kSize + 1 * at.y / kSize;
        return glm::dvec3(at, 1 / (z + offset));
      };
      const DisparitySegment segment{beside({0, u(rng)}), beside({kSize, u(rng)})};
      const SurfaceHit march = intersect(surface, pyramid, segment, &cost);
      EXPECT_FALSE(march.hit);
      behind += march.passed_behind;
      ++rays;
    }
    EXPECT_EQ(behind, rays / 2);
    // 512 texels lie under each at least. A few cells a level, and for the rays behind the wall the
    // texels of those cells that lead to the first hole.
    EXPECT_LT(double(cost.cells) / rays, 60);
    EXPECT_LT(double(cost.texels) / rays, 60);
  }
}

}  // namespace
}  // namespace rilievo
