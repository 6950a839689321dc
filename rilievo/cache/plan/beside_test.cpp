// Captures that come some frames after they were ordered (CacheOptions::capture_cost).
#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <random>

#include "rilievo/cache/plan/capture_cost.h"
#include "rilievo/cache/plan/forest_test_helpers.h"

namespace rilievo {
namespace {

using namespace test_forest;

// Plans carried out by somebody who takes a random number of frames for each capture.
struct BesideLoop {
  Loop run;
  std::mt19937 rng{5};
  int fastest = 1, slowest = 4;  // frames
  struct OnItsWay {
    Capture capture;
    int frames;  // until it is done
  };
  std::deque<OnItsWay> orders;  // the eldest first
  int ordered = 0, adopted = 0, refused = 0, cancelled = 0, none = 0;

  void adopt(const PlanObjects& scene, std::span<const MovingObject> moving, const FrameView& view,
             const CacheOptions& options) {
    for (OnItsWay& one : orders) --one.frames;
    while (!orders.empty() && orders.front().frames <= 0) {
      Capture capture = orders.front().capture;
      orders.pop_front();
      const bool wanted = is_wanted(capture, run.state);
      const std::optional<DeltaRange> range =
          rng() % 20 ? std::optional(DeltaRange{0.1, 0.9}) : std::nullopt;
      none += !range;
      const bool good = run.adopt(capture, scene.tree, moving, view, options, range);
      EXPECT_TRUE(wanted || !good);
      EXPECT_FALSE(is_wanted(capture, run.state));
      ++(good ? adopted : wanted ? refused : cancelled);
    }
  }

  void frame(const PlanObjects& scene, std::span<const MovingObject> moving, const FrameView& view,
             const CacheOptions& options) {
    adopt(scene, moving, view, options);
    const CacheState before = run.state;
    ASSERT_NO_FATAL_FAILURE(run.frame(scene.tree, moving, view, options));
    double cost = before.ordered_cost;
    std::uint32_t number = before.orders;
    for (const Capture& capture : run.orders) {
      // Never two of the same at a time, none for one frame alone, and each with a slot of its own.
      EXPECT_FALSE(capture.entity < before.ordered.size() &&
                   before.ordered[capture.entity].number != 0);
      EXPECT_FALSE(capture.once);
      EXPECT_EQ(capture.order, ++number);
      EXPECT_FALSE(run.textures.count(capture.slot));
      for (const OnItsWay& other : orders)
        EXPECT_TRUE(other.capture.slot != capture.slot || !is_wanted(other.capture, run.state));
      cost += capture.cost;
      orders.push_back({capture, fastest + int(rng() % std::uint32_t(slowest - fastest + 1))});
      ++ordered;
    }
    EXPECT_EQ(run.orders.size(), run.plan.captures.size());
    EXPECT_TRUE(cost <= options.capture_cost || run.orders.empty() ||
                (before.ordered_cost == 0 && run.orders.size() == 1));
    run.orders.clear();
  }

  // What the state counts is what there is.
  void expect_consistent() const {
    std::uint64_t bytes = 0;
    double cost = 0;
    std::set<std::uint32_t> taken(run.state.free_slots.begin(), run.state.free_slots.end());
    EXPECT_EQ(taken.size(), run.state.free_slots.size());
    for (std::uint32_t slot = 0; slot < run.state.slots.size(); ++slot)
      if (run.state.slots[slot].held) {
        bytes += run.state.slots[slot].bytes;
        EXPECT_TRUE(taken.insert(slot).second);
      }
    for (const OnItsWay& one : orders)
      if (is_wanted(one.capture, run.state)) {
        bytes += one.capture.picture.bytes, cost += one.capture.cost;
        EXPECT_TRUE(taken.insert(one.capture.slot).second);
      }
    EXPECT_EQ(bytes, run.state.bytes);
    EXPECT_NEAR(cost, run.state.ordered_cost, 1e-6 * (1 + cost));
    EXPECT_EQ(taken.size(), run.state.slots.size());  // each slot is held, ordered or free
  }
};

TEST(Beside, whatever_comes_late_each_object_is_drawn_once_within_the_bound) {
  const PlanObjects forest = plant(700);
  for (const auto& [budget, allowed] :
       {std::pair(1.0, 2.0), {1.0, 1.0}, {3'000.0, 3.0}, {40'000.0, 2.0}}) {
    CacheOptions options = rasterized_cache_options();
    options.capture_cost = budget;
    options.spikes.late = allowed;
    BesideLoop loop;
    std::mt19937 rng(6);
    int late = 0;
    for (int f = 0; f < 400; ++f) {
      const FrameView view = stroll(f);
      std::vector<MovingObject> moving = cars(std::min(f, 240));
      if (f > 240)
        for (MovingObject& car : moving) car.now_from_last = glm::dmat4(1);
      std::vector<std::uint32_t> gone;
      if (f % 37 == 36) {
        const std::uint32_t object = rng() % std::uint32_t(forest.boxes.size());
        invalidate(forest.tree, object, loop.run.state, gone);
        invalidate_moving(forest.tree, f % 3u, loop.run.state, gone);
      }
      if (f == 200) invalidate(loop.run.state, gone);
      for (const std::uint32_t slot : gone) ASSERT_EQ(loop.run.textures.erase(slot), 1u);
      ASSERT_NO_FATAL_FAILURE(loop.frame(forest, moving, view, options));
      loop.expect_consistent();
      ASSERT_LE(loop.run.state.bytes, options.memory_bytes);
      std::vector<Shares> still(forest.boxes.size()), moved(moving.size());
      ASSERT_NO_FATAL_FAILURE(add_shares(loop.run, forest.tree, still, moved));
      for (std::size_t i = 0; i < still.size(); ++i)
        ASSERT_TRUE(complete(still[i]) || !surely_sees(view.camera, forest.boxes[i]))
            << f << " " << i;
      for (std::size_t i = 0; i < moved.size(); ++i)
        ASSERT_TRUE(complete(moved[i]) || !surely_sees(view.camera, moving[i].box))
            << f << " " << i;
      for (const DrawnPicture& drawn : loop.run.plan.pictures) {
        const Picture& picture = loop.run.state.slots[drawn.slot];
        const RigidMotion motion{motion_since(picture, forest.tree, moving)};
        const double bound_px = bound_total_px(picture.geometry, view.camera, motion);
        ASSERT_LE(bound_px, options.spikes.late * limit_px(picture, options));
        ASSERT_LE(bound_px, loop.run.plan.bound_px * (1 + 1e-6));
        late += bound_px > limit_px(picture, options);
      }
    }
    EXPECT_GT(loop.adopted, 50);
    EXPECT_GT(loop.none, 0);
    EXPECT_TRUE(budget > 1 || (late > 0) == (allowed > 1));
    if (budget == 40'000) {
      EXPECT_GT(loop.cancelled, 0);
      EXPECT_LT(loop.refused, loop.adopted / 4);
    }
    // All has stood still for 160 frames.
    EXPECT_TRUE(loop.run.plan.fallback.objects.empty());
    EXPECT_LE(loop.run.plan.bound_px, options.error_px) << budget;
  }
}

// What is ordered is drawn from something else until it has come, and what came is drawn.
TEST(Beside, a_picture_is_drawn_from_the_frame_on_that_takes_it) {
  const PlanObjects forest = plant(40);
  CacheOptions options = rasterized_cache_options();
  options.capture_cost = 1e6;
  options.fade_frames = 1;
  BesideLoop loop;
  loop.slowest = 1;
  const FrameView view = walk(0, 0);
  loop.frame(forest, {}, {view.camera}, options);
  EXPECT_GT(loop.ordered, 0);
  EXPECT_TRUE(loop.run.plan.pictures.empty());
  const int first = loop.ordered;
  loop.frame(forest, {}, {view.camera}, options);
  EXPECT_EQ(loop.adopted + loop.refused, first);
  EXPECT_EQ(int(loop.run.plan.pictures.size()), loop.adopted);
  EXPECT_GT(loop.adopted, first / 2);
}

// An eye that walks on finds pictures replaced in time, although each takes eight frames: they are
// ordered so much earlier.
TEST(Beside, pictures_are_ordered_as_much_earlier_as_they_take) {
  const PlanObjects forest = plant(300);
  CacheOptions options = rasterized_cache_options();
  options.capture_cost = 1e6;  // time suffices
  for (const int frames : {1, 8}) {
    BesideLoop loop;
    loop.fastest = loop.slowest = frames;
    int drawn = 0, late = 0;
    for (int f = 0; f < 600; ++f) {
      const glm::dvec3 velocity(0.006, 0, 0);
      const FrameView view =
          looking(glm::dvec3(0, 10, 0) + velocity * double(f), {0, -0.1, -1}, velocity);
      ASSERT_NO_FATAL_FAILURE(loop.frame(forest, {}, view, options));
      if (f < 300) continue;
      for (const DrawnPicture& one : loop.run.plan.pictures) {
        // Of what lives for so long that the next one can be made in time: three times as long.
        const Picture& picture = loop.run.state.slots[one.slot];
        if (picture.lead - frames < 3 * frames / 6.0) continue;
        late += double(one.bound_px) > limit_px(picture, options);
        ++drawn;
      }
    }
    EXPECT_GT(drawn, 5000);
    EXPECT_GT(loop.ordered, 300);
    EXPECT_NEAR(loop.run.state.latency, frames, 1e-6);
    EXPECT_LT(late, drawn / 1000);
  }
}

}  // namespace
}  // namespace rilievo
