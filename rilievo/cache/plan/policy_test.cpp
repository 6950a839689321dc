#include "rilievo/cache/plan/policy.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <random>
#include <set>

#include "rilievo/cache/plan/eye_motion.h"
#include "rilievo/cache/plan/forest_test_helpers.h"

namespace rilievo {
namespace {

using namespace test_forest;

// Off by a share of the box's size, at any distance.
double share_of_size_px(const ErrorModel& model, const glm::dmat4&, const Camera& frame) {
  const double distance = glm::length(glm::dvec3(model.bounds.center()) - frame.position());
  return model.texel / distance * frame.width / (frame.window.right - frame.window.left);
}

Alternative alternative_of(const Box& box, std::uint32_t object) {
  Alternative alternative;
  alternative.error.bound = share_of_size_px;
  alternative.error.bounds = box;
  alternative.error.texel = 0.03 * double(box.radius());
  alternative.cost = {500, 0.1};  // worth it for trees
  alternative.object = object;
  return alternative;
}

// Of every third tree, and of the cars, which pass for heavy.
Alternatives bake_some(const PlanObjects& forest, std::span<const MovingObject> moving) {
  Alternatives alternatives;
  const auto trees = std::uint32_t(forest.boxes.size());
  const std::size_t nodes = forest.tree.nodes.size();
  alternatives.of_entity.assign(nodes + moving.size(), {});
  std::vector<Entity> leaf_of(trees);
  for (Entity e = 0; e < nodes; ++e)
    if (forest.tree.nodes[e].leaf()) leaf_of[forest.tree.order[forest.tree.nodes[e].first]] = e;
  for (std::uint32_t i = 0; i < trees + moving.size(); i += 3) {
    const Entity entity = i < trees ? leaf_of[i] : Entity(nodes + i - trees);
    alternatives.of_entity[entity] = {std::uint32_t(alternatives.list.size())};
    alternatives.list.push_back(
        alternative_of(i < trees ? forest.boxes[i] : moving[i - trees].box, i));
  }
  return alternatives;
}

TEST(Policy, every_object_in_view_is_drawn_once_within_the_bound_and_the_budgets) {
  const PlanObjects forest = plant(700);
  for (const std::uint64_t memory_mb : {64, 2}) {
    CacheOptions options;
    options.memory_bytes = memory_mb << 20;
    options.capture_triangles = 60'000;
    Loop run;
    EyeMotion motion;
    bool degraded = false;
    std::size_t alternatives_drawn = 0;
    for (int f = 0; f < 300; ++f) {
      // One walk as the frames tell, one with foresight.
      const FrameView view = memory_mb == 64 ? follow(motion, stroll(f).camera) : stroll(f);
      const std::vector<MovingObject> moving = cars(f);
      const Alternatives alternatives = bake_some(forest, moving);
      ASSERT_NO_FATAL_FAILURE(run.frame(forest.tree, moving, view, options, alternatives));
      std::vector<Shares> still_shares(forest.boxes.size()), moving_shares(moving.size());
      ASSERT_NO_FATAL_FAILURE(
          add_shares(run, forest.tree, still_shares, moving_shares, alternatives));
      for (std::size_t i = 0; i < forest.boxes.size(); ++i)
        if (surely_sees(view.camera, forest.boxes[i])) {
          ASSERT_TRUE(complete(still_shares[i])) << f << " " << i;
        }
      for (std::size_t i = 0; i < moving.size(); ++i)
        if (surely_sees(view.camera, moving[i].box)) {
          ASSERT_TRUE(complete(moving_shares[i])) << f << " " << i;
        }

      double worst = 0;
      for (const DrawnPicture& drawn : run.plan.pictures) {
        const Picture& picture = run.state.slots[drawn.slot];
        RigidMotion motion;
        if (picture.entity >= forest.tree.nodes.size()) {
          const MovingObject& car = moving[picture.entity - forest.tree.nodes.size()];
          ASSERT_FALSE(car.polygons_only);
          motion.now_from_then = car.world_from_object * glm::inverse(picture.world_from_object);
        }
        const double bound = bound_error(picture.geometry, view.camera, motion).total_px;
        ASSERT_LE(bound, limit_px(picture, options));
        ASSERT_NEAR(bound, double(drawn.bound_px), 1e-4 + 1e-6 * bound);  // stored as a float
        if (memory_mb == 64) {
          ASSERT_EQ(picture.coarse_px, 0);
        }
        degraded |= picture.coarse_px > 0;
        worst = std::max(worst, bound);
      }
      for (const DrawnAlternative& drawn : run.plan.alternatives) {
        const Alternative& alternative = alternatives.list[drawn.alternative];
        const double bound =
            alternative.error.bound_px(alternative.world_from_capture, view.camera);
        ASSERT_LE(bound, options.error_px);
        ASSERT_NEAR(bound, double(drawn.bound_px), 1e-6);
        worst = std::max(worst, bound);
        ++alternatives_drawn;
      }
      EXPECT_NEAR(run.plan.bound_px, worst, 1e-4 + 1e-6 * worst);

      std::uint64_t bytes = 0;
      for (const Picture& picture : run.state.slots) bytes += picture.held ? picture.bytes : 0;
      ASSERT_EQ(bytes, run.state.bytes);
      ASSERT_EQ(bytes, run.plan.bytes);
      ASSERT_LE(bytes, options.memory_bytes);
      for (const Capture& capture : run.plan.captures) {
        ASSERT_LE(capture.geometry.capture.width, options.max_texels);
        ASSERT_LE(capture.geometry.capture.height, options.max_texels);
        ASSERT_TRUE(validate(capture.geometry.capture).ok());
      }
    }
    EXPECT_EQ(degraded, memory_mb == 2);
    EXPECT_GT(alternatives_drawn, 100u);
    EXPECT_GT(run.plan.pictures.size(), 20u);
    EXPECT_GT(run.plan.hierarchy, 5);
    // It has stood still for 60 frames.
    EXPECT_TRUE(memory_mb == 2 || run.plan.captures.size() <= 4u);  // the cars go on
  }
}

TEST(Policy, the_picture_holds_what_it_shows) {
  // Every corner of every object below a captured node is in the capture camera's frustum.
  const PlanObjects forest = plant(400);
  Loop run;
  int corners = 0;
  for (int f = 0; f < 60; ++f) {
    ASSERT_NO_FATAL_FAILURE(run.frame(forest.tree, {}, stroll(f), {}));
    for (const Capture& capture : run.plan.captures) {
      const Camera& camera = capture.geometry.capture;
      const HierarchyNode& node = forest.tree.nodes[capture.entity];
      for (std::uint32_t k = 0; k < node.count; ++k)
        for (const glm::vec3& corner : forest.boxes[forest.tree.order[node.first + k]].corners()) {
          const glm::dvec3 at = raster_from_world(camera, corner);
          // 1e-9 of a texel: rounding of doubles.
          ASSERT_TRUE(at.x > -1e-9 && at.x < camera.width + 1e-9);
          ASSERT_TRUE(at.y > -1e-9 && at.y < camera.height + 1e-9);
          ASSERT_TRUE(at.z >= camera.z_near && at.z <= camera.z_far);
          ++corners;
        }
    }
  }
  EXPECT_GT(corners, 3000);
}

TEST(Policy, the_same_input_makes_the_same_plan) {
  const PlanObjects forest = plant(300);
  Loop a, b;
  for (int f = 0; f < 80; ++f) {
    const std::vector<MovingObject> moving = cars(f);
    ASSERT_NO_FATAL_FAILURE(a.frame(forest.tree, moving, stroll(f), {}));
    b.scratch = {};  // what scratch holds must not matter
    ASSERT_NO_FATAL_FAILURE(b.frame(forest.tree, moving, stroll(f), {}));
    ASSERT_EQ(a.plan.pictures.size(), b.plan.pictures.size());
    for (std::size_t i = 0; i < a.plan.pictures.size(); ++i) {
      ASSERT_EQ(a.plan.pictures[i].slot, b.plan.pictures[i].slot);
      ASSERT_EQ(a.plan.pictures[i].to, b.plan.pictures[i].to);
    }
    ASSERT_EQ(a.plan.captures.size(), b.plan.captures.size());
    ASSERT_EQ(a.plan.polygon_triangles, b.plan.polygon_triangles);
  }
}

TEST(Policy, a_refresh_is_faded_and_need_not_be) {
  const PlanObjects forest = plant(300);
  for (const int fade_frames : {6, 1}) {
    CacheOptions options;
    options.fade_frames = fade_frames;
    Loop run;
    int faded = 0, refreshed = 0;
    for (int f = 0; f < 200; ++f) {
      ASSERT_NO_FATAL_FAILURE(run.frame(forest.tree, {}, walk(1, f), options));
      std::map<Entity, int> slots;
      for (const DrawnPicture& drawn : run.plan.pictures)
        ++slots[run.state.slots[drawn.slot].entity];
      for (const auto& [entity, n] : slots) {
        ASSERT_LE(n, 2);
        faded += n == 2;
      }
      for (const Capture& capture : run.plan.captures)
        refreshed += f > 0 && run.state.previous[capture.entity] != 0;
    }
    EXPECT_GT(refreshed, 20);
    if (fade_frames == 1) {
      EXPECT_EQ(faded, 0);
    } else {
      EXPECT_GT(faded, refreshed);
    }
  }
}

TEST(Policy, what_is_refused_is_drawn_by_other_means) {
  const PlanObjects forest = plant(300);
  Loop run;
  std::mt19937 rng(1);
  run.maker.shows = [&](const Capture&) { return MadeCapture{.made = rng() % 2 > 0}; };
  for (int f = 0; f < 100; ++f) {
    const std::vector<MovingObject> moving = cars(f);
    const FrameView view = walk(1, f);
    ASSERT_NO_FATAL_FAILURE(run.frame(forest.tree, moving, view, {}));
    std::vector<Shares> still_shares(forest.boxes.size()), moving_shares(moving.size());
    ASSERT_NO_FATAL_FAILURE(add_shares(run, forest.tree, still_shares, moving_shares));
    for (std::size_t i = 0; i < forest.boxes.size(); ++i)
      if (surely_sees(view.camera, forest.boxes[i])) {
        ASSERT_TRUE(complete(still_shares[i])) << f << " " << i;
      }
    ASSERT_EQ(run.plan.bytes, run.state.bytes);
  }
  EXPECT_GT(run.textures.size(), 10u);
}

TEST(Policy, a_capture_is_good_only_if_the_frame_sees_no_wider_gap_than_is_allowed) {
  const PlanObjects forest = plant(300);
  CacheOptions options;
  options.gap_px = 0.2;  // far below what pictures from an eye ahead may have
  Loop run;
  // Each shows its whole box and, in half of the cases, hides whatever it can.
  FrameView view;
  std::size_t wide = 0;
  bool hides = false;
  run.maker.shows = [&](const Capture& capture) {
    MadeCapture made{.made = true, .range = DeltaRange{}};
    hides = !hides;
    if (!hides) return made;
    made.gaps = unknown_gaps(capture.geometry.capture);
    wide += bound_gap_px(capture.geometry, made.gaps, view.camera) > gap_limit_px(options);
    return made;
  };
  for (int f = 0; f < 40; ++f) {
    view = walk(1, f);
    ASSERT_NO_FATAL_FAILURE(run.frame(forest.tree, {}, view, options));
    EXPECT_EQ(run.maker.refused, wide);
    EXPECT_LE(run.plan.gap_px, gap_limit_px(options));
  }
  EXPECT_GT(run.maker.asked, 20u);
  EXPECT_GT(wide, 5u);
}

TEST(Policy, pictures_that_show_less_than_their_box_live_longer_within_the_same_bound) {
  const PlanObjects forest = plant(500);
  const CacheOptions options;
  std::size_t captures[2] = {0, 0}, refused = 0;
  for (const bool narrow : {false, true}) {
    Loop run;
    std::mt19937 rng(3);
    run.maker.shows = [&](const Capture&) {
      const double nearest = 0.1 + 0.1 * double(rng() % 3);
      // Now and then one is deeper than those before.
      const double farthest = rng() % 20 ? nearest + 0.3 : 1.0;
      MadeCapture made{.made = true};
      if (narrow) made.range = {nearest, farthest};
      return made;
    };
    for (int f = 0; f < 200; ++f) {
      const FrameView view = walk(1, f);
      ASSERT_NO_FATAL_FAILURE(run.frame(forest.tree, {}, view, options));
      ASSERT_LE(run.plan.bound_px, options.error_px) << f;
      for (const DrawnPicture& drawn : run.plan.pictures)
        ASSERT_LE(drawn.bound_px, run.plan.bound_px);
      for (const DrawnPicture& drawn : run.plan.pictures) {
        const Picture& picture = run.state.slots[drawn.slot];
        ASSERT_LE(bound_total_px(picture.geometry, view.camera), options.error_px) << f;
      }
      std::vector<Shares> shares(forest.boxes.size()), none;
      ASSERT_NO_FATAL_FAILURE(add_shares(run, forest.tree, shares, none));
      for (std::size_t i = 0; i < forest.boxes.size(); ++i)
        if (surely_sees(view.camera, forest.boxes[i])) {
          ASSERT_TRUE(complete(shares[i])) << f << " " << i;
        }
    }
    captures[narrow] = run.maker.asked, refused = run.maker.refused;
  }
  EXPECT_LT(captures[1], captures[0] * 3 / 4);
  EXPECT_GT(refused, 0u);
  EXPECT_LT(refused, captures[1] / 10);
}

TEST(Policy, invalidated_pictures_are_not_drawn) {
  const PlanObjects forest = plant(300);
  Loop run;
  for (int f = 0; f < 20; ++f) ASSERT_NO_FATAL_FAILURE(run.frame(forest.tree, {}, walk(1, f), {}));
  // One object: the pictures of its ancestors go, no others.
  const std::uint32_t object = 137;
  const std::set<std::uint32_t> before = run.textures;
  std::vector<std::uint32_t> evicted;
  invalidate(forest.tree, object, run.state, evicted);
  for (std::uint32_t slot : before) {
    const HierarchyNode& node = forest.tree.nodes[run.state.slots[slot].entity];
    const auto begin = forest.tree.order.begin() + node.first;
    const bool shows = std::find(begin, begin + node.count, object) != begin + node.count;
    EXPECT_EQ(shows, std::find(evicted.begin(), evicted.end(), slot) != evicted.end());
  }
  for (std::uint32_t slot : evicted) run.textures.erase(slot);
  ASSERT_NO_FATAL_FAILURE(run.frame(forest.tree, {}, walk(1, 20), {}));
  // The light: all of them.
  evicted.clear();
  invalidate(run.state, evicted);
  EXPECT_EQ(std::set<std::uint32_t>(evicted.begin(), evicted.end()), run.textures);
  EXPECT_EQ(run.state.bytes, 0u);
  run.textures.clear();
  ASSERT_NO_FATAL_FAILURE(run.frame(forest.tree, {}, walk(1, 21), {}));
  for (const DrawnPicture& drawn : run.plan.pictures)
    EXPECT_EQ(run.state.slots[drawn.slot].fade_start, 21u);
}

TEST(Policy, an_empty_scene_is_an_empty_plan) {
  Loop run;
  ASSERT_NO_FATAL_FAILURE(run.frame({}, {}, walk(0, 0), {}));
  EXPECT_TRUE(run.plan.pictures.empty() && run.plan.polygons.empty() && run.plan.captures.empty());
}

}  // namespace
}  // namespace rilievo
