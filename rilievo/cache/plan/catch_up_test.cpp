// Frames after others that were drawn without pictures (SpikePolicy::catch_up).
#include <gtest/gtest.h>

#include <algorithm>

#include "rilievo/cache/plan/forest_test_helpers.h"

namespace rilievo {
namespace {

using namespace test_forest;

constexpr int kBefore = 80, kCatchUp = 8;

// The most that a frame costs, captures included, over what one cost before, of those that catch up
// and of those after them; and the largest bound.
struct Catching {
  double frame = 0, later = 0, bound_px = 0;
};

Catching pause(const PlanObjects& forest, int frames, bool catches_up) {
  CacheOptions options;
  options.capture_share = 1;
  Loop run;
  Catching most;
  double usual = 0;
  const int resumed = kBefore + frames;
  for (int frame = 0; frame < resumed + 3 * kCatchUp; ++frame) {
    if (frame >= kBefore && frame < resumed) continue;  // something else draws it
    const bool first = frame >= resumed && frame < resumed + kCatchUp;
    options.spikes.catch_up =
        catches_up && first ? double(resumed + kCatchUp - frame) / kCatchUp : 0;
    run.frame(forest.tree, {}, walk(1, frame), options);
    std::vector<Shares> still(forest.boxes.size()), moving;
    add_shares(run, forest.tree, still, moving);
    for (std::size_t i = 0; i < still.size(); ++i)
      if (surely_sees(walk(1, frame).camera, forest.boxes[i])) {
        EXPECT_TRUE(complete(still[i])) << i << " in frame " << frame;
      }
    double captures = 0;
    for (const Capture& capture : run.plan.captures) captures += capture.cost;
    if (frame >= kBefore - 40 && frame < kBefore) usual += (run.plan.cost + captures) / 40;
    EXPECT_LE(run.plan.bound_px, 1 + options.spikes.catch_up * (options.spikes.late - 1) + 1e-6)
        << frame;
    if (frame < resumed) continue;
    double& of = first ? most.frame : most.later;
    of = std::max(of, (run.plan.cost + captures) / usual);
    most.bound_px = std::max(most.bound_px, run.plan.bound_px);
  }
  return most;
}

TEST(CatchUp, what_has_become_due_is_not_captured_in_the_first_frame) {
  for (const int trees : {120, 400}) {
    const PlanObjects forest = plant(trees);
    for (const int frames : {3, 11, 20}) {
      const Catching at_once = pause(forest, frames, false), later = pause(forest, frames, true);
      EXPECT_LT(later.frame, 0.8 * at_once.frame) << trees << ", " << frames;
      // What is put off is not made all at once when they have caught up.
      EXPECT_LT(later.later, 1.25 * at_once.later) << trees << ", " << frames;
      EXPECT_GT(later.bound_px, 1.2);
      EXPECT_LE(at_once.bound_px, 1 + 1e-6);
    }
  }
}

}  // namespace
}  // namespace rilievo
