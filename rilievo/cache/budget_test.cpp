#include <gtest/gtest.h>

#include <random>

#include "rilievo/cache/plan_test_helpers.h"

namespace rilievo {
namespace {

// Blocks on a grid around the origin, of 20 000 triangles each.
struct Blocks {
  std::vector<Box> boxes;
  std::vector<std::uint64_t> triangles;
  Hierarchy tree;
};

Blocks blocks_on_a_grid(int side) {
  Blocks blocks;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const float x = 4 * (float(i) - 0.5f * float(side)), z = 4 * (float(j) - 0.5f * float(side));
      Box box;
      box.add({x - 1, 0, z - 1}), box.add({x + 1, 3, z + 1});
      blocks.boxes.push_back(box);
      blocks.triangles.push_back(20'000);
    }
  blocks.tree = build_hierarchy(blocks.boxes, blocks.triangles);
  return blocks;
}

FrameView jumping(std::mt19937& rng) {
  std::uniform_real_distribution<double> u(-40, 40);
  const glm::dvec3 eye(u(rng), 4 + 0.1 * (u(rng) + 40), u(rng));
  const glm::dvec3 to(0.2 * u(rng), 1, 0.2 * u(rng));
  return {look_at(eye, to, {0, 1, 0}, 1.0, 640, 360, 0.1, 400),
          {rng() % 2 ? 30 : -30, 0, 10 + u(rng)}};
}

std::vector<Shares> shares_of(const Loop& run, const Blocks& blocks) {
  std::vector<Shares> still(blocks.boxes.size()), moving;
  add_shares(run, blocks.tree, still, moving);
  return still;
}

TEST(BudgetTest, an_eye_too_fast_for_any_picture_to_last_sees_pictures_of_single_frames) {
  const Blocks blocks = blocks_on_a_grid(16);
  const CacheOptions options = rasterized_cache_options();
  Loop run;
  std::mt19937 rng(3);
  int near = 0, pictures = 0, once = 0;
  for (int frame = 0; frame < 40; ++frame) {
    const FrameView view = jumping(rng);
    ASSERT_NO_FATAL_FAILURE(run.frame(blocks.tree, {}, view, options));
    for (const Capture& capture : run.plan.captures) {
      if (!capture.once) continue;  // where the eye moves towards it
      ++once;
      EXPECT_TRUE(capture.geometry.capture.position() == view.camera.position());
    }
    EXPECT_LE(run.plan.bound_px, options.error_px);
    const std::vector<Shares> shares = shares_of(run, blocks);
    for (std::size_t i = 0; i < shares.size(); ++i)
      EXPECT_TRUE(shares[i].empty() || complete(shares[i])) << i;
    // Only what is around the eye is left to polygons.
    near += int(run.plan.polygons.size());
    pictures += int(run.plan.pictures.size());
  }
  EXPECT_GT(pictures, 400);
  EXPECT_GT(once, pictures / 2);
  EXPECT_LT(near, pictures / 5);
}

TEST(BudgetTest, where_captures_cost_more_than_polygons_a_fast_eye_sees_polygons) {
  const Blocks blocks = blocks_on_a_grid(8);
  Loop run;
  std::mt19937 rng(4);
  for (int frame = 0; frame < 10; ++frame) {
    ASSERT_NO_FATAL_FAILURE(run.frame(blocks.tree, {}, jumping(rng), CacheOptions{}));
    EXPECT_TRUE(run.plan.captures.empty());
  }
}

}  // namespace
}  // namespace rilievo
