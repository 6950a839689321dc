#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "rilievo/cache/plan/capture_cost.h"
#include "rilievo/cache/plan/fallback.h"
#include "rilievo/cache/plan/plan_test_helpers.h"
#include "rilievo/cache/prices/cost_clock.h"

namespace rilievo {
namespace {

// Blocks on a grid around the origin, of 20 000 triangles each.
PlanObjects blocks_on_a_grid(int side) {
  PlanObjects blocks;
  for (int j = 0; j < side; ++j)
    for (int i = 0; i < side; ++i) {
      const float x = 4 * (float(i) - 0.5f * float(side)), z = 4 * (float(j) - 0.5f * float(side));
      Box box;
      box.add({x - 1, 0, z - 1}), box.add({x + 1, 3, z + 1});
      blocks.add(box, 20'000);
    }
  blocks.build();
  return blocks;
}

FrameView jumping(std::mt19937& rng) {
  std::uniform_real_distribution<double> u(-40, 40);
  // In braces, so that each compiler draws the numbers in this order.
  const glm::dvec3 eye{u(rng), 4 + 0.1 * (u(rng) + 40), u(rng)};
  const glm::dvec3 to{0.2 * u(rng), 1, 0.2 * u(rng)};
  return {look_at(eye, to, {0, 1, 0}, 1.0, 640, 360, 0.1, 400),
          {rng() % 2 ? 30 : -30, 0, 10 + u(rng)}};
}

// Is each block that may be in view drawn at all pixels, once?
void expect_complete(const Loop& run, const PlanObjects& blocks, const FrameView& view) {
  std::vector<Shares> still(blocks.boxes.size()), moving;
  add_shares(run, blocks.tree, still, moving);
  const ViewAxes axes = view_axes(view, 0);
  for (std::size_t i = 0; i < still.size(); ++i)
    EXPECT_TRUE(complete(still[i]) || !may_see(axes.now, blocks.boxes[i])) << i;
}

TEST(BudgetTest, an_eye_too_fast_for_any_picture_to_last_sees_pictures_of_single_frames) {
  const PlanObjects blocks = blocks_on_a_grid(16);
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
    expect_complete(run, blocks, view);
    // Only what is around the eye is left to polygons.
    near += int(run.plan.polygons.size());
    pictures += int(run.plan.pictures.size());
  }
  EXPECT_GT(pictures, 400);
  EXPECT_GT(once, pictures / 2);
  EXPECT_LT(near, pictures / 5);
}

TEST(BudgetTest, where_captures_cost_more_than_polygons_a_fast_eye_sees_polygons) {
  const PlanObjects blocks = blocks_on_a_grid(8);
  Loop run;
  std::mt19937 rng(4);
  std::size_t captures = 0, polygons = 0;
  for (int frame = 0; frame < 40; ++frame) {
    ASSERT_NO_FATAL_FAILURE(run.frame(blocks.tree, {}, jumping(rng), CacheOptions{}));
    for (const Capture& capture : run.plan.captures) EXPECT_FALSE(capture.once);
    captures += run.plan.captures.size(), polygons += run.plan.polygons.size();
  }
  // What is far may last even so.
  EXPECT_LT(captures, polygons / 50);
  EXPECT_GT(polygons, 500u);
}

// The price of a frame's captures, by definition.
double price_of(const Plan& plan, const CacheOptions& options) {
  double price = 0;
  for (const Capture& capture : plan.captures) {
    const Camera& eye = capture.geometry.capture;
    price += options.cost.capture + options.cost.capture_triangle * double(capture.triangles) +
             options.cost.capture_texel * eye.width * eye.height;
  }
  return price;
}

// An eye that stands, jumps after each 60 frames, and stands again.
FrameView standing(int frame, double step = 0) {
  const int jump = frame / 60;
  const glm::dvec3 eye(60 * std::cos(2.0 * jump), 6, 60 * std::sin(2.0 * jump));
  const glm::dvec3 aside = step * (frame % 60) * glm::dvec3(0, 0, 1);
  return {look_at(eye + aside, {0, 1, 0}, {0, 1, 0}, 1.0, 640, 360, 0.1, 400),
          frame % 60 == 0 ? glm::dvec3(0) : step * glm::dvec3(0, 0, 1)};
}

TEST(BudgetTest, after_a_cut_what_is_missing_is_in_the_fallback_until_time_allows) {
  const PlanObjects blocks = blocks_on_a_grid(16);
  CacheOptions options = rasterized_cache_options();
  options.picture_triangles = 100'000;
  options.capture_cost = options.fallback_cost = 60'000;
  Loop run;
  std::size_t in_fallback = 0, polygons = 0;
  for (int frame = 0; frame < 180; ++frame) {
    const FrameView view = standing(frame);
    ASSERT_NO_FATAL_FAILURE(run.frame(blocks.tree, {}, view, options));
    expect_complete(run, blocks, view);
    in_fallback += run.plan.fallback.objects.size(), polygons += run.plan.polygons.size();
    // Texels of two pixels at most.
    EXPECT_LE(run.plan.bound_px, options.error_px + std::sqrt(0.5) + 1e-9);
    // Whole texels cost a little more than was estimated.
    EXPECT_LE(price_of(run.plan, options), 1.1 * options.capture_cost);
    if (frame % 60 == 59) {
      EXPECT_TRUE(run.plan.fallback.objects.empty());
      EXPECT_LE(run.plan.bound_px, options.error_px) << frame;
    }
  }
  EXPECT_GT(in_fallback, 100u);
  // What covers few pixels at the frame's edge costs less than their rays would.
  EXPECT_LT(polygons, in_fallback / 20);
}

TEST(BudgetTest, a_budget_that_suffices_for_nothing_still_shows_everything) {
  const PlanObjects blocks = blocks_on_a_grid(16);
  CacheOptions options = rasterized_cache_options();
  options.capture_cost = options.fallback_cost = 1;
  Loop run;
  for (int frame = 0; frame < 120; ++frame) {
    const FrameView view = standing(frame, 0.02);
    ASSERT_NO_FATAL_FAILURE(run.frame(blocks.tree, {}, view, options));
    expect_complete(run, blocks, view);
    EXPECT_LE(run.plan.bound_px, options.spikes.late * options.error_px + 1e-9);
    EXPECT_LE(run.plan.captures.size(), 1u);
  }
}

// A capture that would take long to pay is not missed: its objects are polygons as before.
TEST(BudgetTest, only_what_is_due_is_in_the_fallback) {
  PlanObjects blocks = blocks_on_a_grid(16);
  for (std::size_t i = 0; i < blocks.triangles.size(); ++i)
    blocks.triangles[i] = i % 2 ? 20'000 : 500;
  blocks.build();
  CacheOptions options;             // captures are dear
  options.picture_triangles = 600;  // no pictures of several blocks
  options.capture_cost = options.fallback_cost = 1;
  Loop run;
  std::size_t waiting = 0, in_fallback = 0;
  for (int frame = 0; frame < 60; ++frame) {
    const FrameView view = standing(frame, 0.3);
    ASSERT_NO_FATAL_FAILURE(run.frame(blocks.tree, {}, view, options));
    std::vector<std::uint8_t> due(blocks.boxes.size(), 0);
    for (const auto& request : run.scratch.requests) {
      waiting += !request.due;
      const HierarchyNode& node = blocks.tree.nodes[request.entity];
      for (std::uint32_t k = 0; k < node.count && request.due; ++k)
        due[blocks.tree.order[node.first + k]] = 1;
    }
    for (const std::uint32_t object : run.plan.fallback.objects) EXPECT_TRUE(due[object]);
    in_fallback += run.plan.fallback.objects.size();
  }
  EXPECT_GT(in_fallback, 100u);
  EXPECT_GT(waiting, 100u);
}

// An eye that moves on while the budget suffices for one block in some frames.
TEST(BudgetTest, a_picture_is_late_rather_than_missing_and_the_latest_is_captured_first) {
  const PlanObjects blocks = blocks_on_a_grid(8);
  CacheOptions options = rasterized_cache_options();
  options.picture_triangles = 20'000;  // pictures of single blocks
  Loop run;
  int late = 0, compared = 0;
  for (int frame = 0; frame < 200; ++frame) {
    const glm::dvec3 eye(0.2 * frame - 20, 5, 25);
    const FrameView view{
        look_at(eye, eye - glm::dvec3(0, 4, 25), {0, 1, 0}, 1.0, 640, 360, 0.1, 400),
        glm::dvec3(0.2, 0, 0)};
    if (frame == 60) options.capture_cost = options.fallback_cost = 4'000;
    ASSERT_NO_FATAL_FAILURE(run.frame(blocks.tree, {}, view, options));
    expect_complete(run, blocks, view);
    const bool limited = frame >= 60;
    EXPECT_LE(run.plan.bound_px, (limited ? options.spikes.late : 1) * options.error_px + 1e-9);
    if (!limited) continue;
    EXPECT_TRUE(run.plan.polygons.empty());
    double latest = 0;
    for (const DrawnPicture& drawn : run.plan.pictures) {
      const Picture& picture = run.state.slots[drawn.slot];
      latest = std::max(latest, double(drawn.bound_px) / limit_px(picture, options));
      late += drawn.bound_px > limit_px(picture, options);
    }
    for (const Capture& capture : run.plan.captures) {
      const std::uint32_t old = run.state.current[capture.entity];
      if (old == 0 || latest <= 1) continue;
      ++compared;
      const double bound_px = bound_total_px(run.state.slots[old - 1].geometry, view.camera);
      EXPECT_GE(bound_px / limit_px(run.state.slots[old - 1], options),
                latest - 1e-6);  // floats are ordered
    }
  }
  EXPECT_GT(late, 50);
  EXPECT_GT(compared, 20);
}

TEST(FallbackTest, its_texels_are_as_fine_as_the_budget_and_the_frame_allow) {
  const FrameView view = standing(0);
  const ViewAxes axes = view_axes(view, 0);
  CacheOptions options = rasterized_cache_options();
  options.cost.fallback_texel = 2;
  EXPECT_EQ(fallback_scale(axes, 10'000, 1e9, 0.5, options), 1);
  for (const double coarsest : {0.5, 0.3})
    for (const double none : {0, -5})
      EXPECT_EQ(fallback_scale(axes, 10'000, none, coarsest, options), coarsest);
  const double scale = fallback_scale(axes, 10'000, 11'000, 0.5, options);
  EXPECT_NEAR(2 * 10'000 * scale * scale, 11'000, 1e-6);
  // Never more than the frame.
  EXPECT_EQ(fallback_scale(axes, 1e9, 2 * 640 * 360, 0.5, options), 1);
  options.max_texels = 160;
  EXPECT_EQ(fallback_scale(axes, 10'000, 1e9, 0.5, options), 0.25);
}

TEST(FallbackTest, its_camera_sees_what_the_frame_sees_of_the_boxes) {
  std::mt19937 rng(9);
  std::uniform_real_distribution<double> u(-1, 1);
  Box everything;
  everything.add(glm::vec3(-99)), everything.add(glm::vec3(99));
  int seen = 0, texels = 0, whole_texels = 0;
  for (int i = 0; i < 1000; ++i) {
    const glm::dvec3 eye{u(rng), u(rng), u(rng)}, to{9 * u(rng), 3 * u(rng), -20 + 9 * u(rng)};
    const FrameView view{look_at(eye, to, {0, 1, 0}, 0.8, 63, 41, 0.1, 50), {}};
    std::vector<Box> boxes(3);
    for (Box& box : boxes)
      for (int corner = 0; corner < 2; ++corner) {
        const glm::dvec3 p{9 * u(rng), 9 * u(rng), -15 + 15 * u(rng)};
        box.add(glm::vec3(p));
      }
    const double texel_scale = 0.5 + 0.25 * (u(rng) + 1);
    const PictureGeometry geometry = fallback_geometry(view_axes(view, 0), boxes, texel_scale, {});
    ASSERT_TRUE(validate(geometry.capture).ok());
    EXPECT_LE(bound_total_px(geometry, view.camera), std::sqrt(0.5) * 1.1);
    for (int k = 0; k < 30; ++k) {
      const Box& box = boxes[std::size_t(k % 3)];
      const glm::dvec3 share{0.5 + 0.5 * u(rng), 0.5 + 0.5 * u(rng), 0.5 + 0.5 * u(rng)};
      const glm::dvec4 p(glm::dvec3(box.min) + share * glm::dvec3(box.extent()), 1);
      const double z = -(glm::inverse(view.camera.world_from_eye) * p).z;
      if (z < view.camera.z_near) continue;
      EXPECT_LE(geometry.capture.z_near, z);
      EXPECT_GE(geometry.capture.z_far, z);
      const glm::dvec4 at = glm::inverse(view.camera.world_from_eye) * p;
      const auto shows = [&](const ImageWindow& w) {
        return at.x >= z * w.left && at.x <= z * w.right && at.y >= z * w.bottom &&
               at.y <= z * w.top;
      };
      seen += shows(view.camera.window);
      EXPECT_TRUE(!shows(view.camera.window) || shows(geometry.capture.window));
    }
    // Its texels are some of those of the whole frame.
    const PictureGeometry whole =
        fallback_geometry(view_axes(view, 0), std::vector<Box>{everything}, texel_scale, {});
    EXPECT_EQ(whole.capture.width, std::ceil(texel_scale * 63));
    const ImageWindow &w = geometry.capture.window, &all = view.camera.window;
    const double texel = (all.right - all.left) / whole.capture.width;
    EXPECT_NEAR((w.right - w.left) / geometry.capture.width, texel, 1e-12);
    EXPECT_NEAR(std::remainder(w.left - all.left, texel), 0, 1e-12);
    texels += geometry.capture.width * geometry.capture.height;
    whole_texels += whole.capture.width * whole.capture.height;
  }
  EXPECT_GT(seen, 1000);
  EXPECT_LT(texels, 0.9 * whole_texels);  // no more than is needed
}

// A clipped picture is drawn only where it shows all that the frame does.
TEST(BudgetTest, clipped_pictures_stand_only_for_frames_that_they_show_all_of) {
  std::mt19937 rng(7);
  std::uniform_real_distribution<double> u(-1, 1);
  int shown = 0;
  for (int i = 0; i < 20'000; ++i) {
    const glm::dvec3 eye(u(rng), u(rng), u(rng)), to(10 * u(rng), 3 * u(rng), -30);
    const Camera capture = look_at(eye, to, {0, 1, 0}, 0.8, 64, 64, 0.1, 400);
    const Camera frame =
        look_at(eye + 0.2 * glm::dvec3(u(rng), u(rng), u(rng)),
                to + glm::dvec3(2 * u(rng), 2 * u(rng), 0), {0, 1, 0}, 0.7, 64, 64, 0.1, 400);
    Box box;
    const glm::vec3 middle(glm::dvec3(6 * u(rng), 6 * u(rng), -15 + 10 * u(rng)));
    box.add(middle - 3.0f), box.add(middle + 3.0f);
    if (!shows_frame(capture, frame, box)) continue;
    ++shown;
    // By points of the box that the frame sees.
    const glm::dmat4 frame_eye = glm::inverse(frame.world_from_eye),
                     capture_eye = glm::inverse(capture.world_from_eye);
    for (int k = 0; k < 30; ++k) {
      const glm::dvec4 p(glm::dvec3(middle) + 3.0 * glm::dvec3(u(rng), u(rng), u(rng)), 1);
      const auto inside = [&](const glm::dmat4& eye_from_world, const Camera& camera) {
        const glm::dvec4 q = eye_from_world * p;
        const ImageWindow& w = camera.window;
        return q.z < 0 && q.x <= -q.z * w.right && q.x >= -q.z * w.left && q.y <= -q.z * w.top &&
               q.y >= -q.z * w.bottom;
      };
      EXPECT_TRUE(!inside(frame_eye, frame) || -(frame_eye * p).z < frame.z_near ||
                  inside(capture_eye, capture));
    }
  }
  EXPECT_GT(shown, 500);
}

TEST(BudgetTest, without_a_budget_of_time_nothing_is_late_and_there_is_no_fallback) {
  const PlanObjects blocks = blocks_on_a_grid(16);
  const CacheOptions options = rasterized_cache_options();
  Loop run;
  for (int frame = 0; frame < 120; ++frame) {
    ASSERT_NO_FATAL_FAILURE(run.frame(blocks.tree, {}, standing(frame, 0.02), options));
    EXPECT_LE(run.plan.bound_px, options.error_px);
    EXPECT_TRUE(run.plan.fallback.objects.empty());
  }
}

TEST(MeasuredPriceTest, rises_fast_and_falls_slowly) {
  MeasuredPrice price{1};
  price.learn(10, 30);  // 3 a cost
  EXPECT_DOUBLE_EQ(price.ms_per_cost, 2);
  price.learn(10, 10);
  EXPECT_DOUBLE_EQ(price.ms_per_cost, 1.9);
  price.learn(0, 10), price.learn(0.01, 5), price.learn(10, 0);  // say nothing
  EXPECT_DOUBLE_EQ(price.ms_per_cost, 1.9);
}

TEST(CostClockTest, turns_milliseconds_into_costs) {
  const CacheOptions original = rasterized_cache_options();
  CacheOptions options = original;
  CostClock clock(2e-4);
  clock.drawing = {5e-4}, clock.capture = {1e-3}, clock.fallback = {3e-3};
  clock.set_budget(8, original, options);
  EXPECT_NEAR(options.capture_cost, 8000, 1e-6);
  EXPECT_NEAR(options.fallback_cost, 16000, 1e-6);
  // A texel takes as many milliseconds as before, by the fallback's own price.
  EXPECT_NEAR(options.cost.fallback_texel * 5e-4, original.cost.fallback_texel * 3e-3, 1e-12);
  // The first frame after a jump takes what it took where drawing took 2e-4.
  EXPECT_NEAR(options.spikes.jump_share * 5e-4, original.spikes.jump_share * 2e-4, 1e-12);
  // Half of the budget for the triangles of a picture of several objects.
  EXPECT_NEAR(double(options.picture_triangles) * options.cost.capture_triangle, 4000, 1);
  clock.set_budget(1e9, original, options);
  EXPECT_EQ(options.picture_triangles, original.picture_triangles);
  // A machine that draws faster than the model says does not do more.
  clock.drawing = {1e-4};
  clock.set_budget(8, original, options);
  EXPECT_EQ(options.spikes.jump_share, original.spikes.jump_share);
}

}  // namespace
}  // namespace rilievo
