// Walks with cuts past blocks, and what their frames cost.
#pragma once

#include <cmath>
#include <random>

#include "rilievo/cache/plan/capture_cost.h"
#include "rilievo/cache/plan/eye_motion.h"
#include "rilievo/cache/plan/plan_test_helpers.h"

namespace rilievo {

inline constexpr int kWidth = 640, kHeight = 360;

// Blocks of 200 to 60 000 triangles, 4 m apart.
inline PlanObjects blocks_of_all_sizes(std::mt19937& rng) {
  PlanObjects blocks;
  for (int j = -8; j < 8; ++j)
    for (int i = -8; i < 8; ++i) {
      Box box;
      box.add({4 * i - 1, 0, 4 * j - 1}), box.add({4 * i + 1, 3, 4 * j + 1});
      blocks.add(box, 200 + rng() % 60'000);
    }
  blocks.build();
  return blocks;
}

// Walks along an edge of the blocks for 20 frames, and jumps to another place.
inline Camera walking(int frame, double step) {
  const int jump = frame / 20;
  const glm::dvec3 eye(60 * std::cos(2.0 * jump), 6, 60 * std::sin(2.0 * jump));
  const glm::dvec3 aside = step * (frame % 20) * glm::dvec3(0, 0, 1);
  return look_at(eye + aside, glm::dvec3(0, 1, 0) + aside, {0, 1, 0}, 1.0, kWidth, kHeight, 0.1,
                 400);
}

inline EyeMotion walking_elsewhere() {
  EyeMotion motion;
  for (const int frame : {58, 59}) (void)follow(motion, walking(frame, 0.01));
  return motion;
}

inline double polygon_cost(const PlanObjects& blocks, std::size_t i, const ViewAxes& axes,
                           const CacheOptions& options) {
  return options.cost.object + double(blocks.triangles[i]) +
         options.cost.polygon_pixel * covered_pixels(axes, blocks.boxes[i]);
}

// By definition: what the plan draws and captures, and a coarse picture of the frame's size.
inline double cost_of(const Loop& run, const PlanObjects& blocks, const FrameView& view,
                      const CacheOptions& options) {
  const ViewAxes axes = view_axes(view, 0);
  const CostModel& model = options.cost;
  double cost = 0;
  for (const DrawnPicture& drawn : run.plan.pictures) cost += run.state.slots[drawn.slot].draw_cost;
  for (const DrawnObject& drawn : run.plan.polygons)
    cost += polygon_cost(blocks, drawn.object, axes, options);
  for (const Capture& capture : run.plan.captures) cost += capture.cost;
  if (!run.plan.fallback.objects.empty()) {
    const Camera& eye = run.plan.fallback.geometry.capture;
    cost += model.fallback_texel * eye.width * eye.height;
  }
  return cost;
}

inline CacheOptions limited_options() {
  CacheOptions options = rasterized_cache_options();
  options.spikes.max_spike = 2;
  options.spikes.floor = 180'000;
  options.picture_triangles = 200'000;
  options.capture_triangles = 2'000'000;
  return options;
}

}  // namespace rilievo
