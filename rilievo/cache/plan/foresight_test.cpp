// What the planner foresees, against what then happens.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <glm/gtc/matrix_transform.hpp>
#include <map>

#include "rilievo/cache/plan/frame_planner.h"
#include "rilievo/cache/plan/plan_test_helpers.h"

namespace rilievo {
namespace {

Box centered_box(const glm::vec3& half) {
  Box box;
  box.add(-half), box.add(half);
  return box;
}

// A car that drives in a circle, and turns as it does, about an axis that turns with it: no two
// steps are alike, and none may change places with another one.
glm::dmat4 circling(double frame) {
  glm::dmat4 m = glm::translate(glm::dmat4(1), {1, 0, -22});
  m = glm::rotate(m, 0.0011 * frame, glm::normalize(glm::dvec3(0.1, 1, 0.2)));
  return glm::rotate(glm::translate(m, {6, 0, 0}), 0.0023 * frame, {1, 0, 0});
}

MovingObject car_at(const glm::dmat4& now, const glm::dmat4& last) {
  MovingObject car;
  car.world_from_object = now;
  car.now_from_last = now * glm::inverse(last);
  car.box = transformed(glm::mat4(now), centered_box({2, 0.7f, 1}));
  car.triangles = 50000;
  return car;
}

FrameView gliding(double frame) {
  const glm::dvec3 velocity(0.01, 0, -0.004), eye = glm::dvec3(0, 3, 0) + frame * velocity;
  return {look_at(eye, eye + glm::dvec3(0, -0.1, -1), {0, 1, 0}, 1.0, 640, 360, 0.1, 500),
          velocity};
}

TEST(Foresight, the_life_foreseen_of_a_car_that_turns_is_the_one_that_trying_each_frame_finds) {
  const Hierarchy tree = build_hierarchy({}, {});
  CacheOptions options;
  Loop run;
  std::map<std::uint32_t, int> captured_at;  // by slot
  int compared = 0, cut_short = 0;
  for (int f = 0; f < 400; ++f) {
    const MovingObject car = car_at(circling(f), circling(f - 1));
    const FrameView view = gliding(f);
    const CacheState before = run.state;
    ASSERT_NO_FATAL_FAILURE(run.frame(tree, {&car, 1}, view, options));
    for (std::uint32_t slot = 0; slot < before.slots.size(); ++slot) {
      const PlanScratch::Checked& checked = run.scratch.checked[slot];
      const Picture& picture = before.slots[slot];
      if (!picture.held || checked.frame != before.frame) continue;
      const auto bound_at = [&](int ahead) {
        glm::dmat4 there = circling(f);
        for (int k = 0; k < ahead; ++k) there = car.now_from_last * there;
        const glm::dmat4 motion = there * glm::inverse(circling(captured_at[slot]));
        return bound_total_px(picture.geometry, gliding(f + ahead).camera, RigidMotion{motion});
      };
      const double limit = limit_px(picture, options), now = bound_at(0);
      // Powers of a matrix of doubles, a few hundred at most.
      if (now <= limit) {
        EXPECT_NEAR(checked.now_px, now, 1e-6);
      }
      int lives = 0;
      bool on_the_edge = std::abs(now - limit) < 1e-6;
      for (int k = 1; k <= picture.lead && now <= limit; ++k) {
        const double bound = bound_at(k);
        on_the_edge = on_the_edge || std::abs(bound - limit) < 1e-6;
        if (bound > limit) break;
        lives = k;
      }
      if (on_the_edge || now > limit) continue;
      EXPECT_EQ(int(checked.remaining), lives) << f;
      ++compared;
      cut_short += lives < picture.lead;
    }
    for (const Capture& capture : run.plan.captures) captured_at[capture.slot] = f;
  }
  EXPECT_GT(compared, 100);
  EXPECT_GT(cut_short, 10);
}

// Where a picture is captured from tells which way the eye was expected to go, seen from the car.
TEST(Foresight, a_picture_is_captured_ahead_on_the_eyes_way_relative_to_what_moves) {
  const Hierarchy tree = build_hierarchy({}, {});
  const auto offset_of = [&](const glm::dmat4& step, const glm::dvec3& velocity) {
    const glm::dmat4 now = glm::translate(glm::dmat4(1), {0, 2, -20});
    const MovingObject car = car_at(now, glm::inverse(step) * now);
    FrameView view = gliding(0);
    view.velocity = velocity;
    Loop run;
    run.frame(tree, {&car, 1}, view, {});
    EXPECT_EQ(run.plan.captures.size(), 1u);
    return run.plan.captures.empty()
               ? glm::dvec3(0)
               : run.plan.captures[0].geometry.capture.position() - view.camera.position();
  };
  const glm::dmat4 one(1);
  const glm::dvec3 right(0.02, 0, 0);
  EXPECT_GT(offset_of(one, right).x, 0.05);
  EXPECT_GT(offset_of(glm::translate(one, -2.0 * right), {}).x, 0.05);
  EXPECT_LT(offset_of(glm::translate(one, 2.0 * right), right).x, -0.05);
  // Side by side: nothing changes, from where it is.
  EXPECT_LT(glm::length(offset_of(glm::translate(one, right), right)), 1e-9);
  // It turns about itself, to the left: the eye goes round it to the right.
  const glm::dvec3 center(0, 2, -20);
  const glm::dmat4 turn = glm::translate(one, center) *
                          glm::rotate(one, 0.001, glm::dvec3(0, 1, 0)) *
                          glm::translate(one, -center);
  const glm::dvec3 eye = gliding(0).camera.position();
  const glm::dvec3 way = glm::dvec3(glm::inverse(turn) * glm::dvec4(eye, 1)) - eye;
  const glm::dvec3 offset = offset_of(turn, {});
  EXPECT_GT(glm::length(offset), 0.05);
  EXPECT_GT(glm::dot(glm::normalize(offset), glm::normalize(way)), 0.999);
}

// Boxes all around, of which the eye sees some as it turns.
Hierarchy ring_of_boxes(int count, std::uint64_t triangles = 30000) {
  std::vector<Box> boxes;
  for (int i = 0; i < count; ++i) {
    const double angle = 6.2831853 * i / count, distance = 9 + i % 4 * 5;
    Box box;
    const glm::vec3 at(distance * std::sin(angle), 1, -distance * std::cos(angle));
    box.add(at - glm::vec3(0.8f)), box.add(at + glm::vec3(0.8f));
    boxes.push_back(box);
  }
  return build_hierarchy(boxes, std::vector<std::uint64_t>(boxes.size(), triangles));
}

FrameView turning(int frame) {
  const double angle = 0.02 * frame;
  const glm::dvec3 eye(0.01 * std::sin(0.1 * frame), 1.5, 0);
  return {look_at(eye, eye + glm::dvec3(std::sin(angle), 0, -std::cos(angle)), {0, 1, 0}, 1.0, 640,
                  360, 0.1, 500),
          {}};
}

TEST(Foresight, under_tight_memory_what_was_used_longest_ago_goes_first) {
  const Hierarchy tree = ring_of_boxes(60);
  CacheOptions options;
  options.memory_bytes = 1u << 20;
  Loop run;
  int dropped = 0, compared = 0;
  for (int f = 0; f < 700; ++f) {
    const CacheState before = run.state;
    ASSERT_NO_FATAL_FAILURE(run.frame(tree, {}, turning(f), options));
    EXPECT_LE(run.plan.bytes, options.memory_bytes);
    const auto finished = [&](const Picture& picture, std::uint32_t slot) {
      return (picture.retire_length > 0 &&
              before.frame >= picture.retire_start + picture.retire_length) ||
             before.previous[picture.entity] == slot + 1;
    };
    const auto needed = [&](std::uint32_t slot) {
      const PlanScratch::Checked& checked = run.scratch.checked[slot];
      return checked.frame == before.frame &&
             checked.now_px <= limit_px(before.slots[slot], options);
    };
    std::uint32_t latest_dropped = 0, eldest_kept = 0xFFFFFFFFu;
    for (std::uint32_t slot = 0; slot < before.slots.size(); ++slot) {
      const Picture& picture = before.slots[slot];
      if (!picture.held || needed(slot) || finished(picture, slot)) continue;
      const auto& gone = run.plan.evictions;
      if (std::find(gone.begin(), gone.end(), slot) == gone.end()) {
        eldest_kept = std::min(eldest_kept, picture.used);
      } else {
        latest_dropped = std::max(latest_dropped, picture.used);
        ++dropped;
      }
    }
    if (latest_dropped == 0 || eldest_kept == 0xFFFFFFFFu) continue;
    EXPECT_LE(latest_dropped, eldest_kept) << f;
    ++compared;
  }
  EXPECT_GT(dropped, 20);
  EXPECT_GT(compared, 5);
}

// All that is wanted at full density takes full_bytes; four fifths of the memory are planned for.
TEST(Foresight, under_tight_memory_pictures_get_as_coarse_as_all_of_them_need) {
  const Hierarchy tree = ring_of_boxes(24);
  std::vector<double> scales;
  for (const std::uint64_t kilobytes : {60u, 120u, 240u, 100000u}) {
    CacheOptions options;
    options.memory_bytes = kilobytes << 10;
    Loop run;
    CacheState before;
    for (int f = 0; f < 40; ++f) {
      before = run.state;
      ASSERT_NO_FATAL_FAILURE(run.frame(tree, {}, turning(0), options));
    }
    // What is kept, as if it were fine, and what is asked for.
    constexpr std::uint8_t kKept = 1;  // of PlanScratch::choice
    double full_bytes = 0;
    for (Entity e = 0; e < tree.nodes.size(); ++e) {
      if (run.scratch.choice[e] != kKept || before.current[e] == 0) continue;
      const Picture& picture = before.slots[before.current[e] - 1];
      if (picture.held)
        full_bytes += double(picture.bytes) / (picture.texel_scale * picture.texel_scale);
    }
    PlanScratch scratch;
    Plan plan;
    const FrameView view = turning(0);
    const Alternatives alternatives;
    const LevelTable levels;
    const FramePlanner planner({tree, {}, alternatives, levels}, before, view, options, scratch,
                               plan);
    for (const PlanScratch::Request& request : run.scratch.requests)
      full_bytes += planner.estimate(request.entity).texels * options.bytes_per_texel;
    ASSERT_GT(full_bytes, 0);
    EXPECT_NEAR(run.plan.texel_scale,
                std::min(1.0, std::sqrt(0.8 * double(options.memory_bytes) / full_bytes)), 1e-9)
        << kilobytes;
    scales.push_back(run.plan.texel_scale);
    EXPECT_LE(run.plan.bytes, options.memory_bytes);
  }
  EXPECT_LT(scales[0], 0.8);
  EXPECT_LT(scales[0], scales[1]);
  EXPECT_EQ(scales[3], 1.0);
}

TEST(Foresight, a_retiring_picture_loses_an_even_share_each_frame_even_if_there_is_one) {
  for (const int fade_frames : {1, 6}) {
    const Hierarchy tree = ring_of_boxes(300, 700);
    CacheOptions options;
    options.fade_frames = fade_frames;
    Loop run;
    int seen = 0;
    for (int f = 0; f < 300; ++f) {
      // Straight through the ring: what was together comes apart.
      const glm::dvec3 velocity(0, 0, -0.05), eye = glm::dvec3(0.3, 1.5, 45) + velocity * double(f);
      const FrameView view{
          look_at(eye, eye + glm::dvec3(0, 0, -1), {0, 1, 0}, 1.0, 640, 360, 0.1, 500), velocity};
      const CacheState before = run.state;
      ASSERT_NO_FATAL_FAILURE(run.frame(tree, {}, view, options));
      for (const DrawnPicture& drawn : run.plan.pictures) {
        if (drawn.slot >= before.slots.size()) continue;
        const Picture& picture = before.slots[drawn.slot];
        if (!picture.held || picture.retire_length == 0 || drawn.from != 0) continue;
        if (before.frame < picture.fade_start + picture.fade_length) continue;
        const float step = 1 / (float(picture.retire_length) + 1);
        const float share = 1 - step * (float(before.frame - picture.retire_start) + 1);
        // Where what is below may not fade, the picture stays whole to its end.
        if (drawn.to == 1) continue;
        EXPECT_NEAR(drawn.to, share, 1e-6);
        EXPECT_GT(drawn.to, 0);
        ++seen;
      }
    }
    EXPECT_GT(seen, 0) << fade_frames;
  }
}

}  // namespace
}  // namespace rilievo
