// What do plans expect of what former frames took and showed?
#include <gtest/gtest.h>

#include <random>

#include "rilievo/cache/plan/forest_test_helpers.h"

namespace rilievo {
namespace {

using namespace test_forest;

// Objects of 20 000 triangles, side by side 40 m ahead.
PlanObjects heavy_trees(int count) {
  PlanObjects trees;
  for (int i = 0; i < count; ++i) {
    const float x = 6 * (float(i) - 0.5f * float(count - 1));
    Box box;
    box.add({x - 2, 0, -42}), box.add({x + 2, 5, -38});
    trees.add(box, 20'000);
  }
  trees.build();
  return trees;
}

// A picture costs more than such an object where others hide it, and less where it is seen.
CacheOptions dear_pictures() {
  CacheOptions options;
  options.cost.picture = 8000;
  options.picture_triangles = 30'000;  // each shows one object
  return options;
}

Entity leaf_of(const Hierarchy& tree, std::uint32_t object) {
  Entity e = 0;
  while (!tree.nodes[e].leaf() || tree.order[tree.nodes[e].first] != object) ++e;
  return e;
}

// Draws a frame, of whose pictures those of `hidden` are seen nowhere.
void draw_hiding(Loop& run, const Hierarchy& tree, const FrameView& view,
                 const CacheOptions& options, Entity hidden) {
  ASSERT_NO_FATAL_FAILURE(run.frame(tree, {}, view, options));
  std::vector<float> shares;
  for (const DrawnPicture& drawn : run.plan.pictures)
    shares.push_back(run.state.slots[drawn.slot].entity == hidden ? 0.0f : 1.0f);
  learn_seen(run.plan, shares, run.state);
}

bool captures(const Plan& plan, Entity e) {
  return std::any_of(plan.captures.begin(), plan.captures.end(),
                     [&](const Capture& capture) { return capture.entity == e; });
}

// Runs of triangles of what is hidden are looked at. Where a picture is cheaper than that it is
// replaced when it ends, else it goes.
TEST(Learning, of_what_is_hidden_a_part_of_the_cost_as_polygons_remains) {
  const PlanObjects tree = heavy_trees(1);
  for (const bool dear : {false, true}) {
    const CacheOptions options = dear ? dear_pictures() : CacheOptions{};
    Loop run;
    std::size_t captured = 0, retired = 0;
    for (int f = 0; f < 150; ++f) {
      ASSERT_NO_FATAL_FAILURE(draw_hiding(run, tree.tree, walk(1, f), options, 0));
      captured += run.plan.captures.size(), retired += run.plan.retirements.size();
    }
    EXPECT_GT(captured, 1u);
    EXPECT_EQ(retired > 0, dear);
  }
}

// It was hidden when the eye turned away, which says nothing of what it is when the eye is back.
TEST(Learning, how_much_of_a_picture_was_seen_holds_for_the_next_frame_alone) {
  const PlanObjects tree = heavy_trees(1);
  const CacheOptions options = dear_pictures();
  int replaced = 0;
  for (int turn = 2; turn < 100; ++turn) {
    Loop run;
    for (int f = 0; f < turn; ++f)
      ASSERT_NO_FATAL_FAILURE(draw_hiding(run, tree.tree, walk(1, f), options, 0));
    for (int f = turn; f < turn + 3; ++f) {
      FrameView away = walk(1, f);
      away.camera = looking(away.camera.position(), {0, -0.1, 1}, {}).camera;
      ASSERT_NO_FATAL_FAILURE(run.frame(tree.tree, {}, away, options));
    }
    const std::uint32_t picture = run.state.current[0];
    if (picture == 0 || run.state.slots[picture - 1].retire_length > 0) continue;
    ASSERT_NO_FATAL_FAILURE(run.frame(tree.tree, {}, walk(1, turn + 3), options));
    // Kept, or asked for.
    EXPECT_TRUE(run.plan.retirements.empty()) << turn;
    EXPECT_TRUE(run.plan.polygons.empty()) << turn;
    replaced += !run.scratch.requests.empty();
  }
  EXPECT_GT(replaced, 0);
}

// One picture ends, hidden; the other object has none at all in any frame.
TEST(Learning, what_hides_one_object_says_nothing_of_its_neighbour) {
  const PlanObjects trees = heavy_trees(2);
  const CacheOptions options = dear_pictures();
  for (const std::uint32_t seen : {0u, 1u}) {
    const Entity hidden = leaf_of(trees.tree, 1 - seen), other = leaf_of(trees.tree, seen);
    Loop run;
    int ended = 0;
    for (int f = 0; f < 150; ++f) {
      ASSERT_NO_FATAL_FAILURE(draw_hiding(run, trees.tree, walk(1, f), options, hidden));
      EXPECT_TRUE(captures(run.plan, other)) << f;
      ended += int(run.plan.retirements.size());
      std::vector<std::uint32_t> evictions;
      invalidate(trees.tree, seen, run.state, evictions);
      for (const std::uint32_t slot : evictions) run.textures.erase(slot);
    }
    EXPECT_GT(ended, 0);
  }
}

TEST(Learning, each_picture_keeps_the_share_that_was_seen_of_it) {
  const PlanObjects forest = plant(300);
  std::mt19937 rng(4);
  Loop run;
  int moved = 0;
  for (int f = 0; f < 100; ++f) {
    ASSERT_NO_FATAL_FAILURE(run.frame(forest.tree, {}, walk(1, f), {}));
    std::vector<float> expected, shares;  // by slot; by drawn picture
    for (const Picture& picture : run.state.slots) expected.push_back(picture.seen_share);
    for (std::size_t i = 0; i < run.plan.pictures.size(); ++i) {
      shares.push_back(float(rng() % 1000) / 1000);
      expected[run.plan.pictures[i].slot] = shares[i];
      moved += run.plan.pictures[i].slot != i;
    }
    learn_seen(run.plan, shares, run.state);
    for (std::size_t slot = 0; slot < expected.size(); ++slot)
      ASSERT_EQ(run.state.slots[slot].seen_share, expected[slot]) << f;
  }
  EXPECT_GT(moved, 100);
}

// As polygons it took more than a picture costs when all of it was seen.
TEST(Learning, what_is_hidden_costs_less_than_it_took_when_it_was_seen) {
  const PlanObjects tree = heavy_trees(1);
  for (const bool hidden : {false, true}) {
    Loop run;
    int retired = 0;
    for (int f = 0; f < 150; ++f) {
      ASSERT_NO_FATAL_FAILURE(
          draw_hiding(run, tree.tree, walk(1, f), dear_pictures(), hidden ? 0 : 1));
      const PolygonCost took{0, 20'000, 15'000};
      learn_polygons({&took, 1}, run.state);
      retired += int(run.plan.retirements.size());
    }
    EXPECT_EQ(retired > 0, hidden);
  }
}

// However long ago it was drawn for the first time.
TEST(Learning, what_is_drawn_as_polygons_in_each_frame_is_known_in_each) {
  const PlanObjects trees = heavy_trees(2);
  Loop run;
  run.state.current.assign(trees.tree.nodes.size(), 0);
  run.state.previous = run.state.current;
  run.state.frame = 1;
  const auto learn = [&] {
    std::vector<PolygonCost> took;
    for (const std::uint32_t object : {0u, 1u})
      took.push_back({leaf_of(trees.tree, object), 20'000, 20});
    learn_polygons(took, run.state);
    run.state.usual_polygon_share = 1;  // of others
  };
  learn();
  for (int f = 0; f < 500; ++f) {
    ASSERT_NO_FATAL_FAILURE(run.frame(trees.tree, {}, walk(1, f), {}));
    EXPECT_TRUE(run.plan.captures.empty()) << f;
    learn();
  }
}

TEST(Learning, the_usual_share_is_that_of_all_objects_of_a_frame_together) {
  CacheState state;
  state.current.assign(3, 0), state.frame = 1;
  const PolygonCost costs[] = {{0, 1000, 10}, {2, 3000, 1190}};
  learn_polygons(costs, state);
  EXPECT_FLOAT_EQ(state.usual_polygon_share, 1 + 0.1f * (1200.0f / 4000 - 1));
}

// Soon after, what it took says how it is drawn; long after, what is usual does.
TEST(Learning, what_an_object_took_long_ago_is_forgotten) {
  const PlanObjects tree = heavy_trees(1);
  for (const bool long_ago : {false, true}) {
    Loop run;
    run.state.current.assign(1, 0), run.state.previous.assign(1, 0);
    run.state.frame = 1;
    const PolygonCost little{0, 20'000, 20};
    learn_polygons({&little, 1}, run.state);
    run.state.frame = long_ago ? 10'000 : 30;
    ASSERT_NO_FATAL_FAILURE(run.frame(tree.tree, {}, walk(1, 0), {}));
    EXPECT_EQ(run.plan.captures.empty(), !long_ago);
    EXPECT_EQ(run.plan.polygons.empty(), long_ago);
  }
}

}  // namespace
}  // namespace rilievo
