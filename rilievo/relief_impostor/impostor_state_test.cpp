#include "rilievo/relief_impostor/impostor_state.h"

#include <gtest/gtest.h>

#include <array>

namespace rilievo {
namespace {

constexpr double kNever = std::numeric_limits<double>::infinity();
using Shown = ImpostorShown;

struct StateRow {
  const char* when;
  ImpostorSituation now;
  ImpostorStep step;  // shown, order_warp, order_render, cancel_render
};

TEST(ImpostorState, the_table_says_what_is_shown_and_what_is_ordered) {
  const std::array rows{
      StateRow{"nothing yet", {}, {Shown::object, false, true, false}},
      StateRow{
          "nothing yet, no triangles", {.drawable = false}, {Shown::nothing, false, true, false}},
      StateRow{"the first is being rendered",
               {.rendering = true, .rendered_stretch = 1},
               {Shown::object, false, false, false}},
      StateRow{"the first is for an eye left behind",
               {.rendering = true, .rendered_stretch = 2},
               {Shown::object, false, true, true}},
      StateRow{"a picture, no warp",
               {.picture = true, .final = true, .stretch = 1},
               {Shown::object, true, false, false}},
      StateRow{"being warped",
               {.picture = true, .final = true, .stretch = 1, .warping = true},
               {Shown::object, false, false, false}},
      StateRow{"nothing moved: zero warps",
               {.picture = true, .final = true, .stretch = 1, .warped = true, .moved_px = 0.4},
               {Shown::fresh, false, false, false}},
      StateRow{"moved a little",
               {.picture = true, .final = true, .stretch = 1.1, .warped = true, .moved_px = 2},
               {Shown::stale, true, false, false}},
      StateRow{"moved a little, being warped",
               {.picture = true,
                .final = true,
                .stretch = 1.1,
                .warped = true,
                .moved_px = 2,
                .warping = true},
               {Shown::stale, false, false, false}},
      StateRow{"moved far",
               {.picture = true, .final = true, .stretch = 1.1, .warped = true, .moved_px = 20},
               {Shown::object, true, false, false}},
      StateRow{"moved far, no triangles",
               {.drawable = false,
                .picture = true,
                .final = true,
                .stretch = 1.1,
                .warped = true,
                .moved_px = 20},
               {Shown::stale, true, false, false}},
      StateRow{"coarse: shown, and refined",
               {.picture = true, .stretch = 1, .warped = true},
               {Shown::fresh, false, true, false}},
      StateRow{
          "coarse, being refined",
          {.picture = true, .stretch = 1, .warped = true, .rendering = true, .rendered_stretch = 1},
          {Shown::fresh, false, false, false}},
      StateRow{"stretched: still shown, a new one ordered",
               {.picture = true, .final = true, .stretch = 1.6, .warped = true, .moved_px = 1},
               {Shown::stale, true, true, false}},
      StateRow{"stretched, a better one is on its way",
               {.picture = true,
                .final = true,
                .stretch = 1.6,
                .warped = true,
                .rendering = true,
                .rendered_stretch = 1.4},
               {Shown::fresh, false, false, false}},
      StateRow{"stretched, a worse one is on its way",
               {.picture = true,
                .final = true,
                .stretch = 1.6,
                .warped = true,
                .rendering = true,
                .rendered_stretch = 2},
               {Shown::fresh, false, true, true}},
      StateRow{"torn: the object itself",
               {.picture = true, .final = true, .stretch = 4, .warped = true},
               {Shown::object, false, true, false}},
      StateRow{"torn, no triangles",
               {.drawable = false, .picture = true, .final = true, .stretch = 4, .warped = true},
               {Shown::fresh, false, true, false}},
      StateRow{"the eye is behind the picture",
               {.picture = true, .final = true, .stretch = kNever, .warped = true},
               {Shown::object, false, true, false}},
      StateRow{
          "the eye is behind the picture, no triangles",
          {.drawable = false, .picture = true, .final = true, .stretch = kNever, .warped = true},
          {Shown::stale, false, true, false}},
      StateRow{"the first shows nothing", {.empty = true}, {Shown::object, false, false, false}},
      StateRow{"a newer one shows nothing, no triangles",
               {.drawable = false, .picture = true, .stretch = 2, .warped = true, .empty = true},
               {Shown::nothing, false, false, false}},
  };
  for (const StateRow& row : rows) {
    const ImpostorStep step = next_step(row.now, {});
    EXPECT_EQ(int(step.shown), int(row.step.shown)) << row.when;
    EXPECT_EQ(step.order_warp, row.step.order_warp) << row.when;
    EXPECT_EQ(step.order_render, row.step.order_render) << row.when;
    EXPECT_EQ(step.cancel_render, row.step.cancel_render) << row.when;
  }
}

// Every combination: rules that hold in all of them.
TEST(ImpostorState, no_work_is_ordered_twice_and_nothing_is_warped_that_is_not_there) {
  int seen = 0;
  for (int bits = 0; bits < 64; ++bits)
    for (const double stretch : {1.0, 1.6, 4.0, kNever})
      for (const double moved : {0.0, 3.0, 30.0})
        for (const double rendered : {1.0, 2.0, kNever}) {
          const ImpostorSituation now{bool(bits & 1),  bool(bits & 2),  bool(bits & 4),
                                      stretch,         bool(bits & 8),  moved,
                                      bool(bits & 16), bool(bits & 32), rendered};
          const ImpostorStep step = next_step(now, {});
          ++seen;
          EXPECT_FALSE(step.order_warp && (now.warping || !now.picture || stretch == kNever));
          EXPECT_FALSE(step.cancel_render && !now.rendering);
          EXPECT_FALSE(step.order_render && now.rendering && !step.cancel_render);
          const bool board = step.shown == Shown::fresh || step.shown == Shown::stale;
          EXPECT_FALSE(board && !now.warped);
          EXPECT_FALSE(step.shown == Shown::object && !now.drawable);
          EXPECT_FALSE(step.shown == Shown::nothing && (now.drawable || now.warped));
          EXPECT_FALSE(step.shown == Shown::fresh && moved > 0.5);
          // Without a usable picture, one is always on its way.
          const bool on_its_way = step.order_render || (now.rendering && !step.cancel_render);
          EXPECT_TRUE(on_its_way || (now.picture && stretch != kNever));
        }
  EXPECT_EQ(seen, 64 * 36);
}

TEST(ImpostorState, the_next_picture_is_ordered_before_the_last_one_is_bad) {
  ImpostorSituation now{.picture = true, .final = true, .stretch = 1.1, .warped = true};
  EXPECT_FALSE(next_step(now, {}).order_render);
  now.later_stretch = 1.4;
  EXPECT_TRUE(next_step(now, {}).order_render);
  EXPECT_EQ(next_step(now, {}).shown, Shown::fresh);
  // It is on its way, and serves.
  now.rendering = true, now.rendered_stretch = 1.2;
  EXPECT_FALSE(next_step(now, {}).order_render);
}

TEST(ImpostorState, what_has_no_picture_is_rendered_first_then_the_worst) {
  const ImpostorSituation none{}, nothing{.drawable = false};
  const ImpostorSituation bad{.picture = true, .final = true, .stretch = 3},
      good{.picture = true, .final = true, .stretch = 1.1}, coarse{.picture = true, .stretch = 1.1};
  EXPECT_GT(render_priority(nothing), render_priority(none));
  EXPECT_GT(render_priority(none), render_priority(bad));
  EXPECT_GT(render_priority(bad), render_priority(coarse));
  EXPECT_GT(render_priority(coarse), render_priority(good));
}

}  // namespace
}  // namespace rilievo
