// When do layered impostors stand for their objects? The rule of policy.h, without OpenGL.
#include <gtest/gtest.h>

#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <random>

#include "rilievo/cache/estimate.h"
#include "rilievo/cache/policy.h"

namespace rilievo {
namespace {

// A ball-like object at the origin that turns by `spin` radians a frame.
MovingObject top(int frame, double spin, std::uint64_t triangles) {
  MovingObject object;
  const auto pose = [&](int f) { return glm::rotate(glm::dmat4(1), spin * f, {0.3, 1, 0.2}); };
  Box box;
  box.add({-1, -1, -1}), box.add({1, 1, 1});
  object.world_from_object = pose(frame);
  object.now_from_last = pose(frame) * glm::inverse(pose(frame - 1));
  object.box = transformed(glm::mat4(object.world_from_object), box);
  object.triangles = triangles;
  return object;
}

BakedObjects baked_top(const MovingObject& object, double texel, double slice, int slices,
                       double raggedness = 0) {
  BakedObjects baked;
  BakedObject one;
  one.error = {slice, 0.2, texel};
  one.raggedness = raggedness;
  one.slices = slices;
  one.bounds.add({-1, -1, -1}), one.bounds.add({1, 1, 1});
  one.world_from_impostor = object.world_from_object;
  baked.objects.push_back(one);
  baked.of_moving.push_back(1);
  return baked;
}

FrameView eye_at(double distance) {
  return {look_at({0.3 * distance, 0.2 * distance, distance}, {0, 0, 0}, {0, 1, 0}, 1.0472, 1280,
                  720, 0.1, 5000)};
}

struct Loop {
  CacheState state;
  PlanScratch scratch;
  Plan plan;
  void frame(const MovingObject& object, const BakedObjects& baked, const FrameView& view,
             const CacheOptions& options = {}) {
    plan_frame({}, {&object, 1}, state, view, options, scratch, plan, baked);
    commit(plan, state);
  }
};

TEST(PolicyBaked, an_impostor_is_drawn_where_it_is_within_the_bound_and_cheaper) {
  std::mt19937 rng(5);
  std::uniform_real_distribution<double> u(0, 1);
  int drawn = 0, too_far_off = 0, too_dear = 0;
  for (int i = 0; i < 3000; ++i) {
    MovingObject object = top(0, 0, std::uint64_t(1000 * std::pow(1000, u(rng))));
    object.deforms = true;  // no pictures: polygons or the impostor
    const bool sliced = i % 2;
    const BakedObjects baked = baked_top(object, 0.002 + 0.02 * u(rng), 0.03 * u(rng),
                                         sliced ? 8 + int(rng() % 100) : 0, u(rng));
    CacheOptions options;
    options.error_px = 0.25 * std::pow(16, u(rng));
    const FrameView view = eye_at(1.8 * std::pow(100, u(rng)));
    Loop run;
    run.frame(object, baked, view, options);

    const LayeredError error =
        bound_layered_error(baked.objects[0].error, sliced, baked.objects[0].bounds,
                            object.world_from_object, view.camera);
    const double pixels = covered_pixels(view_axes(view, 0), object.box);
    const double a_pixel = sliced ? baked.objects[0].slices * options.cost.slice_pixel
                                  : options.cost.walked_pixel +
                                        baked.objects[0].raggedness * options.cost.ragged_pixel;
    const bool within = error.total_px <= options.error_px;
    const bool cheaper =
        options.cost.baked + pixels * a_pixel <
        options.cost.object + double(object.triangles) + pixels * options.cost.polygon_pixel;
    ASSERT_EQ(run.plan.baked.size(), within && cheaper ? 1u : 0u) << i;
    ASSERT_EQ(run.plan.moving_polygons.size(), within && cheaper ? 0u : 1u) << i;
    ASSERT_NEAR(run.plan.bound_px, within && cheaper ? error.total_px : 0, 1e-6);
    drawn += within && cheaper, too_far_off += !within && cheaper, too_dear += within && !cheaper;
  }
  EXPECT_GT(drawn, 100);
  EXPECT_GT(too_far_off, 100);
  EXPECT_GT(too_dear, 100);
}

TEST(PolicyBaked, what_spins_is_drawn_from_its_impostor_and_what_rests_from_a_picture) {
  for (const double spin : {0.3, 0.0}) {
    Loop run;
    std::uint64_t captured = 0, polygons = 0;
    std::size_t baked_drawn = 0, pictures = 0;
    for (int f = 0; f < 40; ++f) {
      const MovingObject object = top(f, spin, 200'000);
      run.frame(object, baked_top(object, 0.003, 0.005, 48), eye_at(14));
      if (f < 20) continue;  // a capture that pays late waits for up to 16 frames
      captured += run.plan.captured_triangles, polygons += run.plan.polygon_triangles;
      baked_drawn += run.plan.baked.size(), pictures += run.plan.pictures.size();
    }
    EXPECT_EQ(captured, 0u) << spin;
    EXPECT_EQ(polygons, 0u) << spin;
    EXPECT_EQ(baked_drawn, spin > 0 ? 20u : 0u);
    EXPECT_EQ(pictures, spin > 0 ? 0u : 20u);
  }
}

TEST(PolicyBaked, an_eye_too_near_to_be_served_sees_polygons) {
  MovingObject object = top(0, 0, 10'000'000);
  object.deforms = true;
  CacheOptions options;
  options.error_px = 1e9;
  // 1.2 radii of the ball around the bounds, sqrt(3), from the centre.
  for (const double distance : {1.9, 2.2}) {
    Loop run;
    FrameView view = eye_at(1);
    view.camera = look_at({0, 0, distance}, {0, 0, 0}, {0, 1, 0}, 1.0472, 1280, 720, 0.1, 5000);
    run.frame(object, baked_top(object, 1e-6, 0, 0), view, options);
    EXPECT_EQ(run.plan.baked.size(), distance > 2 ? 1u : 0u);
  }
}

}  // namespace
}  // namespace rilievo
