// The frame planner: chooses the nodes of the hierarchy that are drawn as pictures in a frame.
//
// A cut is a set of nodes that contains each object once. The best cut costs the least per frame,
// captures included: a picture costs its pixels, plus its capture divided by the frames that it
// will live. The cost of a node is the lesser of its own picture's and the sum of its children's.
// Far away, pictures live long and whole groves share one; nearer, they live shorter and show
// single trees; nearest, a tree's triangles are cheaper than a picture's pixels.
//
// A valid picture that will last is kept without visiting its children, so that planning costs as
// much as the cut is wide, not as the scene is large. A picture that is about to expire is replaced
// before it does.
#pragma once

#include <algorithm>

#include "rilievo/cache/plan/capture_cost.h"
#include "rilievo/cache/plan/policy.h"
#include "rilievo/cache/plan/spike_policy.h"

namespace rilievo {

// Entities with at most this many triangles are drawn as polygons for a few more frames, while
// their first picture fades in.
inline constexpr std::uint64_t kFadedTriangles = 10'000;

// The number of frames over which a picture's successor fades in, at most `lead` (its last frames).
// A quarter of them is reserved for the capture.
[[nodiscard]] inline int fade_length(int lead, const CacheOptions& options) {
  return std::clamp(lead - lead / 4, 1, std::max(1, options.fade_frames));
}

// The planning of one frame.
class FramePlanner {
 public:
  // All must outlive the planner; `plan` is empty.
  FramePlanner(const PlanScene& scene, const CacheState& state, const FrameView& frame,
               const CacheOptions& options, PlanScratch& scratch, Plan& plan);

  // Chooses, has `maker` make the captures, and draws with what came of them.
  void run(CaptureMaker& maker);

  // By the level that makes its picture cheaper in all, if there is one.
  [[nodiscard]] CaptureCost estimate(Entity e) const;

 private:
  // By which level is it drawn that is off by at most this share of the limit? By itself if there
  // is none of at most half of its triangles.
  struct Level {
    std::uint64_t triangles = 0;
    double error = 0, px = 0;  // metres; in this frame
  };
  // The cheapest alternative that may stand for the entity now, if one costs less than `cost`.
  struct Standing {
    const Alternative* alternative = nullptr;
    double bound_px = 0, cost = 0;  // cost: as given if there is none
    double gap_px = 0;
  };
  struct Costs {
    double best, now;  // of the best cut; of drawing with what is at hand
  };

  // The steps, in this order.
  void evict_finished();
  void choose();
  void schedule_captures();  // schedule.cpp
  void make_captures(CaptureMaker& maker);
  // Gathers the objects of the fallback, too.
  void draw();
  void make_fallback(CaptureMaker& maker);

  // About entities.
  [[nodiscard]] std::uint32_t nodes() const { return std::uint32_t(tree_.nodes.size()); }
  [[nodiscard]] bool is_moving(Entity e) const { return e >= nodes(); }
  [[nodiscard]] bool several(Entity e) const { return !is_moving(e) && !tree_.nodes[e].leaf(); }
  [[nodiscard]] const Box& box_of(Entity e) const;
  [[nodiscard]] std::uint64_t triangles_of(Entity e) const;
  // The motion of the eye relative to the entity in a frame, world space.
  [[nodiscard]] glm::dvec3 drift_of(Entity e) const;
  [[nodiscard]] Level level_of(Entity e, double share) const;
  [[nodiscard]] CaptureCost estimate(Entity e, const Level& level) const;
  [[nodiscard]] DeltaRange expected_range(Entity e) const;
  [[nodiscard]] double expected_life_share(Entity e) const;

  // Is a picture of it on its way?
  [[nodiscard]] bool is_ordered(Entity e) const {
    return e < state_.ordered.size() && state_.ordered[e].number != 0;
  }

  // Frames from when a capture is asked for until its picture is there.
  [[nodiscard]] double latency() const {
    return captures_beside(options_) ? std::min(state_.latency, kLongestLife) : 0;
  }

  // About slots. The picture of an entity; null if it has none or it has been dropped.
  [[nodiscard]] const Picture* picture_of(const std::vector<std::uint32_t>& by_entity,
                                          Entity e) const;
  const PlanScratch::Checked& check(std::uint32_t slot);
  // Can it be drawn? It may be late.
  [[nodiscard]] bool valid(const Picture* picture);
  [[nodiscard]] bool late(const Picture* picture) {
    return valid(picture) && check(slot_of(picture)).late;
  }
  [[nodiscard]] std::uint32_t slot_of(const Picture* picture) const {
    return std::uint32_t(picture - state_.slots.data());
  }
  void drop(std::uint32_t slot);
  // Do valid pictures show everything visible below the node?
  [[nodiscard]] bool pictures_cover(Entity e);
  [[nodiscard]] bool pictures_cover_below(Entity e);
  [[nodiscard]] bool may_fade_over_below(Entity e);

  // The cost of an entity, and the picture or polygons that it is drawn from.
  [[nodiscard]] Standing stands_for(Entity e, double cost) const;
  [[nodiscard]] double polygon_cost(Entity e) const;
  [[nodiscard]] double polygon_cost(Entity e, const Level& level) const;
  // Before anything is known of it; and the share of that which it took when it was drawn so.
  [[nodiscard]] double expected_polygon_cost(Entity e, const Level& level) const;
  [[nodiscard]] double polygon_share(Entity e) const;
  void emit(const Standing& standing);
  Costs evaluate(Entity e);
  Costs evaluate_below(Entity e);
  bool request(Entity e, double deadline, bool covered);
  void enqueue(Entity e, double deadline, bool covered);
  void draw(Entity e, float from, float to);
  void draw_below(Entity e, float from, float to);

  // In schedule.cpp: the captures that are wanted, by deadline.
  [[nodiscard]] double capture_budget() const;
  bool make_room(std::uint64_t bytes, Entity e);
  [[nodiscard]] std::uint32_t new_slot() const;
  bool capture(Entity e, double cost);
  [[nodiscard]] double fitting_scale() const;
  [[nodiscard]] double even_pace() const;
  void schedule_in_time(double credit);

  // In frame_limit.cpp: what the frame may cost (spike_policy.h), and what is coarse in it.
  [[nodiscard]] FrameCosts frame_costs() const;
  [[nodiscard]] bool falls_back(Entity e, float from, float to) const;
  void limit_cost();
  void finish_fallback();
  void emit(std::uint32_t slot, Entity e, const PlanScratch::Checked& checked, float from,
            float to);

  const Hierarchy& tree_;
  std::span<const MovingObject> moving_;
  const Alternatives& alternatives_;
  const LevelTable& levels_;
  const CacheState& state_;
  const FrameView& frame_;
  const CacheOptions& options_;
  PlanScratch& scratch_;
  Plan& plan_;
  ViewAxes view_;
  FrameLimit limit_;
  std::uint64_t faded_triangles_ = 0;  // of polygons behind pictures that fade in
  double full_bytes_ = 0;      // of all pictures kept or requested, if they were at full density
  double fallback_scale_ = 1;  // of the fallback's texels, 1: a pixel
  double cost_at_hand_ = 0;    // of drawing the frame from what is at hand, without captures
  int fallback_depth_ = 0;     // of draw(): entities above that are in the fallback
  double seen_share_ = 1;      // of evaluate(): of the picture at hand, of the entity or one above
};

}  // namespace rilievo
