#include "rilievo/method/frame_load.h"

#include <gtest/gtest.h>

#include "rilievo/method/auto_decision.h"

namespace rilievo {
namespace {

TEST(FrameLoad, keyframes_are_expected_to_take_less_where_the_sky_is_seen) {
  FrameLoad load{.triangles = 600'000, .pixels = 1280 * 720, .threads = 2};
  load.covered = 10 * load.pixels;  // many objects, one behind the other
  const double all = load.keyframes_ms();
  load.covered = load.pixels;
  EXPECT_EQ(load.keyframes_ms(), all);
  load.covered = 0.03 * load.pixels;
  // bench/results/auto.md: scan-orbit.
  EXPECT_NEAR(load.keyframes_ms() / all, 0.63, 0.01);
}

TEST(FrameLoad, each_model_grows_with_what_it_depends_on_alone) {
  const FrameLoad load{.triangles = 1e5, .pixels = 1e6, .level_triangles = 2e4, .threads = 2};
  FrameLoad more = load;
  more.triangles *= 2;
  EXPECT_NEAR(more.direct_ms() - load.direct_ms(), load.direct_ms() - load.pixels_ms(), 1e-12);
  EXPECT_EQ(more.rays_ms(), load.rays_ms());
  EXPECT_EQ(more.levels_ms(), load.levels_ms());
  EXPECT_LT(load.levels_ms(), load.direct_ms());
  more = load, more.masked = true;
  EXPECT_GT(more.rays_ms(), load.rays_ms());
  EXPECT_EQ(more.direct_ms(), load.direct_ms());
  // Twice the threads take half the time.
  more = load, more.threads = 4;
  for (double (FrameLoad::*ms)() const : {&FrameLoad::direct_ms, &FrameLoad::levels_ms,
                                          &FrameLoad::rays_ms, &FrameLoad::keyframes_ms})
    EXPECT_NEAR((more.*ms)(), (load.*ms)() / 2, 1e-12);
}

TEST(FrameLoad, few_triangles_for_the_pixels_fit) {
  FrameLoad load{.triangles = 20'000, .pixels = 1e6};
  EXPECT_TRUE(load.fits() && load.few());
  load.triangles = 250'000;
  EXPECT_TRUE(!load.fits() && load.few());
  load.triangles = 250'001;
  EXPECT_FALSE(load.fits() || load.few());
}

// As in hall-inside: by counts of the first frame polygons take three times what their model says.
// When half of that was forgotten they were tried, for a frame of twice the time.
TEST(FrameLoad, what_was_counted_is_not_tried_to_find_out) {
  for (const bool counted : {false, true}) {
    const AutoCandidate candidates[] = {{"direct", 0}, {"cache", 1, 12}};
    AutoDecision decision(candidates, 1);
    double off = 3;
    int tried = 0;
    for (int frame = 0; frame < 240; ++frame) {
      off = remembered_off(off, counted);
      const AutoOutlook outlook[] = {{.ready = true, .guess_ms = 50 * off}, {.ready = true}};
      const AutoChoice choice = decision.next(outlook);
      tried += choice.draws == 0;
      decision.add(choice.draws == 0 ? 150 : 75);
    }
    EXPECT_EQ(tried > 0, !counted);
  }
  EXPECT_EQ(remembered_off(0.5, false), 0.5);
  EXPECT_EQ(remembered_off(1, true), 1);
}

}  // namespace
}  // namespace rilievo
