// Against the march from texel to texel (warp/texel_surface.h), in double precision.
#include "rilievo/layered_impostor/software/march_rays.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <random>
#include <vector>

#include "rilievo/capture/shapes_test_helpers.h"
#include "rilievo/warp/surface_pictures_test_helpers.h"

namespace rilievo {
namespace {

using test_shapes::random_direction;
using test_surfaces::noisy;
using test_surfaces::wall;

DepthImage jug_picture(Projection projection, int size, std::mt19937& rng) {
  const Scene scene = test_shapes::jug();
  const Result<RayScene> rays = RayScene::create(scene);
  return cast_picture(*rays, *view_camera(world_bounds(scene), random_direction(rng),
                                          {.projection = projection, .size = size}));
}

// What both marches say of the same segments.
class Marches {
 public:
  void add(const TexelSurface& surface, const std::vector<DisparitySegment>& segments) {
    const MarchSurface fast = make_march_surface(surface);
    for (std::size_t first = 0; first < segments.size(); first += MarchRays::kCount) {
      MarchRays rays;
      const std::size_t count = std::min(segments.size() - first, std::size_t(MarchRays::kCount));
      // Not all of a vector are wanted.
      for (std::size_t i = 0; i < count; ++i) {
        if ((first / MarchRays::kCount + i) % 5 == 0) continue;
        rays.wanted |= 1u << i;
        for (int a = 0; a < 3; ++a) {
          rays.from[a][i] = float(segments[first + i].from[a]);
          rays.to[a][i] = float(segments[first + i].to[a]);
        }
      }
      march_rays(fast, rays);
      EXPECT_EQ((rays.hit | rays.passed_behind | rays.passed_outline) & ~rays.wanted, 0u);
      for (std::size_t i = 0; i < count; ++i) {
        if (!(rays.wanted >> i & 1)) continue;
        DisparitySegment rounded;
        for (int a = 0; a < 3; ++a)
          rounded.from[a] = double(rays.from[a][i]), rounded.to[a] = double(rays.to[a][i]);
        const SurfaceHit slow = intersect(surface, rounded);
        ++marched, hits += slow.hit, outlines += slow.passed_outline;
        lost += slow.passed_behind && !slow.hit;
        wrong += !agrees(slow, rays, i);
        late += slow.passed_behind && double(rays.behind_to[i]) > slow.behind_to + 1e-4;
      }
    }
  }
  int marched = 0, hits = 0, lost = 0, outlines = 0, wrong = 0, late = 0;

 private:
  static bool agrees(const SurfaceHit& slow, const MarchRays& rays, std::size_t i) {
    if (bool(rays.hit >> i & 1) != slow.hit ||
        bool(rays.passed_behind >> i & 1) != slow.passed_behind ||
        bool(rays.passed_outline >> i & 1) != slow.passed_outline)
      return false;
    // Along a segment of some hundred texels. Cells behind are stepped over as a whole, so that a
    // ray may come out later.
    if (slow.passed_behind && (std::abs(double(rays.behind_from[i]) - slow.behind_from) > 1e-4 ||
                               double(rays.behind_to[i]) < slow.behind_to - 1e-4))
      return false;
    // Of a ray that was lost behind an outline nobody asks where.
    if (!slow.hit && (!slow.passed_behind || slow.passed_outline)) return true;
    return rays.x[i] == slow.texel.x && rays.y[i] == slow.texel.y &&
           std::abs(double(rays.t[i]) - slow.t) < 1e-4;
  }
};

TEST(MarchRays, rays_meet_what_the_march_from_texel_to_texel_meets) {
  std::mt19937 rng(1);
  Marches smooth, steps;
  for (int i = 0; i < 12; ++i) {
    const Projection kind = i % 2 ? Projection::perspective : Projection::back_perspective;
    // Larger than the coarsest cell, and no multiple of any.
    const DepthImage picture = i % 6 < 2   ? jug_picture(kind, 200, rng)
                               : i % 6 < 4 ? wall(kind, 203, 60, rng)
                                           : noisy(kind, 150, rng);
    std::vector<DisparitySegment> segments;
    for (int k = 0; k < 3000; ++k) {
      const glm::dvec3 eye = 6.0 * random_direction(rng), to = 1.2 * random_direction(rng);
      const std::optional<DisparitySegment> segment =
          disparity_segment(picture.camera, eye, eye + 2.0 * (to - eye));
      if (segment) segments.push_back(*segment);
    }
    (i % 6 < 4 ? smooth : steps).add(make_texel_surface(picture), segments);
  }
  EXPECT_GT(smooth.hits + steps.hits, 2400);
  EXPECT_GT(smooth.lost + steps.lost, 2400);
  EXPECT_GT(smooth.outlines + steps.outlines, 2400);
  RecordProperty("smooth_wrong", smooth.wrong);
  RecordProperty("smooth_late", smooth.late);
  RecordProperty("steps_late", steps.late);
  RecordProperty("steps_wrong", steps.wrong);
  // Rounded to single precision, what passes an edge within a thousandth of a texel may be told
  // either way; where all is edges, more often.
  EXPECT_LE(smooth.wrong, smooth.marched / 5000);
  EXPECT_LE(steps.wrong, steps.marched / 1000);
}

// Where the size is no multiple of a cell's, the last cells reach beyond the picture.
TEST(MarchRays, rays_along_a_border_meet_what_the_march_from_texel_to_texel_meets) {
  std::mt19937 rng(4);
  std::uniform_real_distribution<double> u(0, 1);
  Marches marches;
  for (int i = 0; i < 60; ++i) {
    const int size = 5 + int(rng() % 40);
    const Projection kind = i % 2 ? Projection::perspective : Projection::back_perspective;
    const TexelSurface surface =
        make_texel_surface(i % 4 < 2 ? wall(kind, size, 2, rng) : noisy(kind, size, rng));
    std::vector<DisparitySegment> segments;
    for (int k = 0; k < 100; ++k) {
      const int across = k % 2;
      const bool last = k % 4 < 2;
      const auto end = [&] {
        const double x = size * u(rng), y = size * u(rng), q = 0.12 + 0.18 * u(rng);
        glm::dvec3 p{x, y, q};
        const double away = std::array{0.0, 1e-9, 1e-3, 0.4}[rng() % 4];
        p[across] = last ? size - away : away;
        return p;
      };
      const glm::dvec3 from = end(), to = end();
      segments.push_back({from, to});
    }
    marches.add(surface, segments);
  }
  EXPECT_GT(marches.hits, 400);
  EXPECT_GT(marches.lost, 800);
  RecordProperty("wrong", marches.wrong);
  EXPECT_LE(marches.wrong, marches.marched / 1000);
}

TEST(MarchRays, rays_far_from_the_surface_cost_cells_and_not_texels) {
  std::mt19937 rng(3);
  constexpr int kSize = 512;
  for (Projection kind : {Projection::perspective, Projection::back_perspective}) {
    const MarchSurface surface =
        make_march_surface(make_texel_surface(wall(kind, kSize, 200, rng)));
    std::uniform_real_distribution<double> u(0, kSize);
    int marches = 0, cells = 0, texels = 0;
    // From edge to edge of the picture, half a metre and more before the wall or behind it.
    for (int i = 0; i < 400; ++i) {
      const double offset = i % 2 ? 0.6 : -0.6;
      const auto beside = [&](double x, double y) {
        const double z = 4 + 2 * x / kSize + 1 * y / kSize;
        return glm::dvec3(x, y, 1 / (z + offset));
      };
      const double y0 = u(rng), y1 = u(rng);
      const glm::dvec3 from = beside(0, y0), to = beside(kSize, y1);
      MarchRays rays;
      rays.wanted = 1;
      for (int a = 0; a < 3; ++a) rays.from[a][0] = float(from[a]), rays.to[a][0] = float(to[a]);
      march_rays(surface, rays);
      EXPECT_EQ(rays.hit, 0u);
      const bool behind = (offset > 0) == (kind == Projection::perspective);
      EXPECT_EQ(rays.passed_behind, behind ? 1u : 0u) << i;
      ++marches, cells += rays.cell_steps, texels += rays.texel_steps;
    }
    // 512 texels lie under each at least. A few cells a level, and for the rays behind the wall the
    // texels of those cells that lead to the first hole.
    EXPECT_LT(double(cells) / marches, 60);
    EXPECT_LT(double(texels) / marches, 60);
  }
}

}  // namespace
}  // namespace rilievo
