#include "rilievo/render/raster/blended_triangle.h"

#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <glm/glm.hpp>
#include <random>

#include "rilievo/render/software/frame_tile.h"

namespace rilievo {
namespace {

constexpr int kWidth = 40, kHeight = 24;

// Triangles in and around a frame, a third of them long and thin, of both directions.
std::vector<BlendedTriangle> random_triangles(std::mt19937& rng, int count) {
  std::uniform_real_distribution<float> u(-1, 1);
  Camera camera;
  camera.width = kWidth, camera.height = kHeight;
  std::vector<BlendedTriangle> placed;
  for (int i = 0; i < count; ++i) {
    const float size = std::pow(10.0f, 1 + u(rng));
    glm::vec3 corner[3];
    for (glm::vec3& c : corner)
      c = {20 + size * 2 * u(rng), 12 + size * 2 * u(rng), 1.5f + 0.5f * u(rng)};
    if (i % 3 == 2) corner[2] = glm::mix(corner[0], corner[1], u(rng)) + 0.02f * size * u(rng);
    // Rows that give x w, y w and w of a corner (x, y, w).
    RasterInstance in;
    for (glm::vec3& c : corner) c = {c.x * c.z, c.y * c.z, c.z};
    in.positions = corner;
    in.row_x = {1, 0, 0, 0}, in.row_y = {0, 1, 0, 0}, in.row_w = {0, 0, 1, 0};
    in.front = in.back = true;
    constexpr std::uint32_t kCorners[] = {0, 1, 2};
    place_blended(camera, 4, in, std::uint32_t(i), kCorners, placed);
  }
  return placed;
}

glm::dvec2 place_of(int x, int y, int s) {
  return {x + double(FrameTile::kSampleX[s]), y + double(FrameTile::kSampleY[s])};
}

// By definition: on the inner side of all edges. None of these samples lies on one.
bool covers(const BlendedTriangle& t, const glm::dvec2& at) {
  for (int a = 0; a < 3; ++a) {
    const int b = (a + 1) % 3;
    const glm::dvec2 from(t.x[a], t.y[a]), along = glm::dvec2(t.x[b], t.y[b]) - from;
    const glm::dvec2 to = double(BlendedTriangle::kUnit) * at - from;
    if (along.x * to.y - along.y * to.x >= 0) return false;
  }
  return true;
}

TEST(BlendedTriangle, covers_the_samples_within_its_edges) {
  std::mt19937 rng(7);
  int covered = 0, in_part = 0;
  for (const BlendedTriangle& t : random_triangles(rng, 600)) {
    const TriangleEdges edges(t);
    for (int y = t.y0; y < t.y1; ++y)
      for (int x = t.x0; x < t.x1; ++x) {
        unsigned expected = 0;
        for (int s = 0; s < 4; ++s) expected |= covers(t, place_of(x, y, s)) ? 1u << s : 0;
        const unsigned found = edges.samples_in(x, y, 4);
        // An edge through a sample is the triangle's or its neighbour's: not asked here.
        ASSERT_EQ(found & expected, expected) << t.number << ": " << x << " " << y;
        ASSERT_LE(std::popcount(found ^ expected), 1);
        covered += expected != 0, in_part += expected != 0 && expected != 15;
      }
  }
  EXPECT_GT(covered, 20'000);
  EXPECT_GT(in_part, 2'000);
}

TEST(BlendedTriangle, knows_blocks_beside_it_and_how_near_it_comes) {
  std::mt19937 rng(8);
  int beside = 0, none = 0;
  for (const BlendedTriangle& t : random_triangles(rng, 600)) {
    const TriangleEdges edges(t);
    for (int by = 0; by < kHeight; by += FrameTile::kBlock)
      for (int bx = 0; bx < kWidth; bx += FrameTile::kBlock) {
        const PixelRange range{bx, by, bx + FrameTile::kBlock, by + FrameTile::kBlock};
        const float nearest = nearest_in(t, range);
        float most = -HUGE_VALF;
        for (const int i : {0, 1, 2, 3})
          most = std::max(most, float(t.inverse_z + (i % 2 ? range.x1 : range.x0) * t.per_x +
                                      (i / 2 ? range.y1 : range.y0) * t.per_y));
        ASSERT_LE(nearest, most + 1e-5f * std::abs(most));
        bool any = false;
        for (int y = range.y0; y < range.y1; ++y)
          for (int x = range.x0; x < range.x1; ++x)
            for (int s = 0; s < 4; ++s) {
              const glm::dvec2 at = place_of(x, y, s);
              any = any || (edges.samples_in(x, y, 4) >> s & 1);
              ASSERT_LE(float(t.inverse_z + at.x * t.per_x + at.y * t.per_y), nearest);
            }
        const bool is_beside = edges.beside(range);
        ASSERT_FALSE(is_beside && any) << t.number << ": " << bx << " " << by;
        beside += is_beside, none += !any;
      }
  }
  // What is beside no single edge may be empty, too.
  EXPECT_GT(beside, none * 6 / 10);
}

}  // namespace
}  // namespace rilievo
