// Plans carried out without OpenGL, and which object is drawn from what.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <functional>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <utility>
#include <vector>

#include "rilievo/cache/plan/policy.h"

namespace rilievo {

// Objects that stand still, and their hierarchy.
struct PlanObjects {
  std::vector<Box> boxes;
  std::vector<std::uint64_t> triangles;
  Hierarchy tree;  // by build()

  void add(const Box& box, std::uint64_t count) {
    boxes.push_back(box);
    triangles.push_back(count);
  }
  void build() { tree = build_hierarchy(boxes, triangles); }
};

// Makes whatever a plan asks for, in no time.
class PlanMaker : public CaptureMaker {
 public:
  std::set<std::uint32_t> textures;                            // slots whose pictures exist
  std::size_t room = std::numeric_limits<std::size_t>::max();  // captures that a frame has room for
  // What a capture shows; empty: nobody asks.
  std::function<MadeCapture(const Capture&)> shows;
  std::size_t asked = 0, refused = 0;

  void make(std::span<const std::uint32_t> evictions, std::span<const Capture> captures,
            std::span<MadeCapture> made) override {
    for (const std::uint32_t slot : evictions) EXPECT_EQ(textures.erase(slot), 1u);
    for (std::size_t i = 0; i < captures.size(); ++i) {
      made[i] = shows ? shows(captures[i]) : MadeCapture{.made = i < room};
      ++asked, refused += !made[i].made;
      if (made[i].made) {
        EXPECT_TRUE(textures.insert(captures[i].slot).second);
      }
    }
  }
  void drop(std::uint32_t slot) override {
    ++refused;
    EXPECT_EQ(textures.erase(slot), 1u);
  }
  MadeCapture make(const Fallback&) override { return {.made = coarse}; }

  bool coarse = true;  // is there room for coarse pictures?
};

struct Loop {
  PlanMaker maker;
  std::set<std::uint32_t>& textures = maker.textures;
  CacheState state;
  PlanScratch scratch;
  Plan plan;
  std::vector<Capture> orders;  // made beside the last frame

  // Enters one that is done. Is it good?
  bool adopt(Capture capture, const Hierarchy& tree, std::span<const MovingObject> moving,
             const FrameView& view, const CacheOptions& options,
             const std::optional<DeltaRange>& range) {
    std::vector<std::uint32_t> gone;
    const bool good =
        adopt_capture(capture, view.camera, tree, moving, range, {}, options, state, gone);
    for (const std::uint32_t slot : gone) EXPECT_EQ(textures.erase(slot), 1u);
    if (good) {
      EXPECT_TRUE(textures.insert(capture.slot).second);
      EXPECT_EQ(state.current[capture.entity], capture.slot + 1);
    }
    return good;
  }

  // What is ordered comes in the next frame.
  void frame(const Hierarchy& tree, std::span<const MovingObject> moving, const FrameView& view,
             const CacheOptions& options, const Alternatives& alternatives = {},
             const LevelTable& levels = {}) {
    for (const Capture& capture : orders)
      (void)adopt(capture, tree, moving, view, options, DeltaRange{});
    orders.clear();
    plan_frame({tree, moving, alternatives, levels}, state, view, options, maker, scratch, plan);
    if (captures_beside(options)) {
      for (const std::uint32_t slot : plan.evictions) ASSERT_EQ(textures.erase(slot), 1u);
      orders = plan.captures;
    }
    commit(plan, state);
  }
};

using Shares = std::vector<std::pair<float, float>>;

// From which parts of the pixels each object is drawn. An alternative is named by its object,
// after the static ones if it moves.
inline void add_shares(const Loop& run, const Hierarchy& tree, std::vector<Shares>& still,
                       std::vector<Shares>& moving, const Alternatives& alternatives = {}) {
  for (const DrawnAlternative& drawn : run.plan.alternatives) {
    const std::uint32_t object = alternatives.list[drawn.alternative].object;
    (object < still.size() ? still[object] : moving[object - still.size()]).emplace_back(0, 1);
  }
  for (const DrawnPicture& drawn : run.plan.pictures) {
    ASSERT_TRUE(run.textures.count(drawn.slot));
    const Entity e = run.state.slots[drawn.slot].entity;
    if (e >= tree.nodes.size()) {
      moving[e - tree.nodes.size()].emplace_back(drawn.from, drawn.to);
      continue;
    }
    for (std::uint32_t k = 0; k < tree.nodes[e].count; ++k)
      still[tree.order[tree.nodes[e].first + k]].emplace_back(drawn.from, drawn.to);
  }
  for (const std::uint32_t object : run.plan.fallback.objects) still[object].emplace_back(0, 1);
  for (const DrawnObject& drawn : run.plan.polygons)
    still[drawn.object].emplace_back(drawn.from, drawn.to);
  for (const DrawnObject& drawn : run.plan.moving_polygons)
    moving[drawn.object].emplace_back(drawn.from, drawn.to);
}

// Do the shares put [0, 1) together, each part once?
inline bool complete(Shares shares) {
  std::sort(shares.begin(), shares.end());
  float reached = 0;
  for (const auto& [from, to] : shares) {
    if (from != reached) return false;
    reached = to;
  }
  return reached == 1;
}

}  // namespace rilievo
