// The plan of a frame: what each part is drawn from, and the pictures captured now (S1.5, S1.7).
//
// A pure decision. The input is the hierarchy of static objects, the moving objects, the pictures
// in the cache and the camera. The output is a Plan: which pictures to capture, to evict and to
// draw, and what to draw as polygons. No OpenGL. For each frame:
//
//   plan_frame(scene, state, view, options, maker, scratch, plan);
//       asks `maker` for the pictures of plan.captures, and for the coarse one of plan.fallback,
//       and plans with what came of them; nothing changes the plan afterwards
//   draw plan.pictures, plan.polygons, plan.moving_polygons, plan.alternatives in any order
//   commit(plan, state);
//
// Each picture drawn has bound_total_px <= CacheOptions::error_px, plus Picture::coarse_px if
// memory was short and its texels are coarser, and bound_gap_px <= gap_limit_px; under a budget of
// time it may be late, and Plan::bound_px says by how much. A baked representation of any kind
// stands for its object where its ErrorModel allows it and it costs less, above all for objects
// that turn so fast that no flat picture lasts. World space, metres; time in frames. The same input
// gives the same plan. A steady state does not allocate.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "rilievo/cache/plan/hierarchy.h"
#include "rilievo/cache/plan/spike_policy.h"
#include "rilievo/core/camera.h"
#include "rilievo/kind/drawable.h"
#include "rilievo/nailboard/error.h"
#include "rilievo/nailboard/gap_table.h"

namespace rilievo {

// The cost of drawing, in triangles: as many as the renderer draws in the same time. The defaults
// were measured on a software rasteriser with four samples per pixel: a triangle takes 280 ns, a
// pixel of a picture 5 ns, a pixel of shaded polygons 30 ns. machine_costs.h has other machines'.
struct CostModel {
  double picture = 10;          // one picture drawn
  double picture_pixel = 0.02;  // one pixel of its rectangle
  double object = 20;           // one object drawn as polygons, besides its triangles
  double polygon_pixel = 0.10;  // one pixel of the rectangle around an object
  // Once it is known what drawing polygons took (learn_polygons), instead of the triangles and the
  // pixels of the rectangle: a triangle that is projected, one that is filled, a pixel that is
  // shaded.
  double projected_triangle = 0.75, filled_triangle = 2, shaded_pixel = 0.10;
  double capture = 2000;        // one capture, plus ...
  double capture_triangle = 1;  // ... each of its triangles
  double capture_texel = 0.2;   // ... and each of its texels
  double fallback_texel = 0.8;  // a texel of Plan::fallback, by rays: triangles cost nothing
};

// A picture is captured for an eye ahead on the predicted motion, by this share of its life, so
// that it is good on the way to it and beyond: it lives 1 + kAnticipation times as long as one of
// the frame's own eye. Must be below 1: the frame's own eye needs it, too.
inline constexpr double kAnticipation = 0.8;
// Captures that will be needed are distributed over this many frames, and pictures that come into
// view are looked for so far ahead: longer, and predictions err.
inline constexpr int kSpreadFrames = 8;
// The largest life that is predicted for a picture, frames: nobody walks straight on for ever.
inline constexpr double kLongestLife = 600;
// Levels of detail (LevelTable) may take this share of error_px, for which a picture has less of it
// left; and polygons, which have no other error, all of it.
inline constexpr double kLevelShare = 0.5, kPolygonLevelShare = 1;

// Limits and preferences of the planner.
struct CacheOptions {
  double error_px = 1;  // limit on bound_total_px
  // The limit on bound_gap_px, in pixels: the width of a strip that a picture is missing because it
  // was hidden at capture. 0: twice error_px; infinite: no limit. A gap opens twice as fast as
  // samples slide, so with twice error_px the life of pictures is hardly shorter, and hidden
  // surfaces are still captured in time.
  double gap_px = 0;
  std::uint64_t memory_bytes = 256u << 20;  // limit on all pictures together
  // The budget of captures per frame: their number, and their cost, texels included, expressed as
  // the cost of capturing this number of triangles. Only the cost in excess of drawing the same
  // objects counts (captures of what is drawn as polygons are nearly free). One capture is always
  // allowed, of any size.
  std::uint64_t capture_triangles = 500'000;
  int captures = 1000;
  // Or, where that is more and there is no spikes.max_spike, this share of what drawing the frame
  // would cost without captures, by the CostModel. A frame that takes long for want of pictures
  // then takes twice as long at most, and those after it need not.
  double capture_share = 0;
  // A budget of time instead, by the CostModel. A plan then orders captures, which are made beside
  // the frames and enter the cache when they are done (adopt_capture). All orders that are not done
  // cost at most this together; a dearer one is made when there is no other. Until a capture is
  // done, its entity is drawn from the picture at hand, which is then late; the latest is captured
  // first. An entity without a picture is in Plan::fallback. Nothing is captured for a single
  // frame. Infinite: there is no such budget, nothing is late, and there is no fallback.
  double capture_cost = std::numeric_limits<double>::infinity();
  // With such a budget, what the frame's fallback may cost.
  double fallback_cost = std::numeric_limits<double>::infinity();
  // The limits of a frame's cost, and of the lateness of its pictures.
  SpikePolicy spikes;
  // The largest number of triangles in a picture of several objects, which one frame must capture.
  std::uint64_t picture_triangles = 100'000;
  int max_texels = 1024;  // limit on a picture's side
  int texel_cell = 32;    // pictures occupy multiples of this
  int bytes_per_texel = 5;
  int delta_bits = 8;
  int fallback_bits = 8;  // of Delta in Plan::fallback, whose range of depths is large
  DepthMode depth_mode = DepthMode::linear;
  // The number of frames over which a new picture replaces the old one; 1: at once.
  int fade_frames = 10;
  CostModel cost;
};

// The limit on bound_gap_px; `gap_px` as in CacheOptions.
[[nodiscard]] inline double gap_limit_px(double error_px, double gap_px) {
  return gap_px > 0 ? gap_px : 2 * error_px;
}
[[nodiscard]] inline double gap_limit_px(const CacheOptions& options) {
  return gap_limit_px(options.error_px, options.gap_px);
}

// Returns whether captures are made beside the frames.
[[nodiscard]] inline bool captures_beside(const CacheOptions& options) {
  return options.capture_cost < std::numeric_limits<double>::infinity();
}
// The factor by which the bounds of a new picture may exceed their limits: it may have been ordered
// some frames ago.
[[nodiscard]] inline double late_factor(const CacheOptions& options) {
  return captures_beside(options) ? options.spikes.late : 1;
}
// The factor for a picture that is already there.
[[nodiscard]] inline double late_at_hand(const CacheOptions& options) {
  const double late = std::min(options.spikes.late, kMostLateInCatchUp);
  return std::max(late_factor(options), 1 + options.spikes.catch_up * (late - 1));
}

// Options for captures by the SIMD rasteriser (render/raster/raster_picture.h), with the pass over
// hidden surfaces. Measured on two cores where OpenGL takes 220 ns for a triangle: a capture takes
// 8 microseconds, a triangle 20 ns, a texel 65 ns. Pictures can therefore show more and live
// shorter, down to a single frame.
[[nodiscard]] inline CacheOptions rasterized_cache_options() {
  CacheOptions options;
  options.cost.capture = 40;
  options.cost.capture_triangle = 0.1;
  options.cost.capture_texel = 0.3;
  options.capture_triangles *= 10;
  options.capture_share = 1;
  options.picture_triangles = 1'000'000;
  return options;
}

// A node of the hierarchy (its index), or moving object i (hierarchy.nodes.size() + i).
using Entity = std::uint32_t;

// A baked representation that can stand for an entity instead of polygons or a picture.
struct Alternative {
  ErrorModel error;
  CostTerms cost;
  glm::dmat4 world_from_capture{1.0};      // now
  bool present = true;                     // false: not available in this frame
  std::uint32_t object = 0, drawable = 0;  // the caller's identifiers
};

// All baked representations.
struct Alternatives {
  std::vector<Alternative> list;
  // For each entity, the indices into `list` of those that can stand for it. Empty: none at all.
  std::vector<std::vector<std::uint32_t>> of_entity;
};

// How many triangles levels of detail leave of each node of the hierarchy, and with which error: no
// surface that is drawn is farther from the nearest of the true ones, nor these from it.
struct LevelTable {
  static constexpr int kSteps = 40;
  // The result of one step.
  struct Level {
    float triangles = 0;  // of all objects below
    float error = 0;  // of the levels that these are, metres, world space; at most that of the step
  };
  double first = 0;                                // of step 0, metres; step k: 2^(k/2) times
  std::vector<std::array<Level, kSteps>> of_node;  // empty: there are no levels
};

// An object that moves, at this frame.
struct MovingObject {
  Box box;  // world, now
  std::uint64_t triangles = 0;
  glm::dmat4 world_from_object{1.0};  // now
  glm::dmat4 now_from_last{1.0};      // its motion in world space since the last frame
  bool polygons_only = false;         // no pictures of it: its pose has no inverse
};

// The camera of a frame and its predicted motion.
struct FrameView {
  Camera camera;  // perspective
  // The prediction for the next frames (eye_motion.h): the eye's velocity in metres per frame, and
  // its rotation about a world axis in radians per frame.
  glm::dvec3 velocity{0.0}, turn{0.0};
  bool jumped = false;   // the step or turn is far larger than those before; not the first frame
  bool started = false;  // the eye moves for the first time: it walks off, or jumps
  double step = 0;       // from the last frame's eye, metres
};

// A picture in the cache.
struct Picture {
  Entity entity = 0;
  PictureGeometry geometry;           // world space at capture
  GapTable gaps;                      // all zero if there is no limit on gaps
  glm::dmat4 world_from_object{1.0};  // of a moving object at capture
  double level_error = 0;             // of the levels that it shows, metres
  double coarse_px = 0;            // the part of its error that coarse texels caused from the start
  double draw_cost = 0, rate = 0;  // triangles per frame: without and with captures
  std::uint64_t bytes = 0;
  double texel_scale = 1;  // below 1: coarser than the frame, because memory was short
  std::uint32_t used = 0;  // the last frame that drew it
  std::uint32_t fade_start = 0, retire_start = 0;
  std::uint16_t fade_length = 1;    // frames
  std::uint16_t retire_length = 0;  // 0: not retiring
  std::uint16_t lead = 1;           // frames before its end at which it is replaced
  float seen_share = 1;             // of its blocks in the last frame that drew it
  bool held = false;                // this slot contains a picture
  bool clipped = false;             // shows only the part near the frame that it was captured for
};

// The picture is good while bound_total_px does not exceed this limit, which follows error_px.
[[nodiscard]] inline double limit_px(const Picture& picture, const CacheOptions& options) {
  return options.error_px + picture.coarse_px;
}

// The cost of drawing an entity as polygons, as a share of its expected cost: most of its triangles
// may be hidden by others.
struct PolygonRecord {
  float share = 1;          // of the expected cost
  std::uint32_t frame = 0;  // when it was drawn so last, + 1; 0: never
};

// A capture that is being made beside the frames.
struct Order {
  std::uint32_t number = 0;  // Capture::order; 0: there is none
  std::uint32_t slot = 0;    // reserved for its picture
  std::uint32_t frame = 0;   // CacheState::frame when it was ordered
  double cost = 0;           // Capture::cost
  std::uint64_t bytes = 0;   // of its picture
};

// The planner's memory between frames. Start with an empty one.
struct CacheState {
  std::uint32_t frame = 0;
  std::vector<Picture> slots;  // the slot identifies a picture and its textures
  std::vector<std::uint32_t> free_slots;
  std::vector<std::uint32_t> current, previous;  // by entity: slot + 1, or 0; previous: fading out
  // The part of its depths that an entity's last picture showed, if there was one; and the part
  // that pictures usually show, mostly the front.
  std::vector<std::optional<DeltaRange>> ranges;
  DeltaRange usual_range[2];  // of one object; of several
  // The share of the life that flatness allows which an entity's last picture's gaps allowed, if
  // there was one; and the usual share:
  std::vector<std::optional<float>> life_shares;
  float usual_life_share[2] = {1, 1};
  std::vector<PolygonRecord> polygon_records;  // by entity; empty: nothing is known of any
  float usual_polygon_share = 1;
  std::uint64_t bytes = 0;
  std::vector<Order> ordered;  // by entity
  double ordered_cost = 0;     // of all orders that are not done
  std::uint32_t orders = 0;    // the number of orders so far
  double latency = 0;          // frames that an order takes; follows longer ones sooner
  double credit = 0;           // triangles saved up for captures
  double usual_cost = 0;       // of frames so far: Plan::cost, smoothed; 0: there was none
  double limit = 0;            // on the last frame's, if it had to be limited
};

// A picture to capture.
struct Capture {
  std::uint32_t slot = 0;
  Entity entity = 0;
  PictureGeometry geometry;  // geometry.capture is the camera to capture with, including its size
  std::uint64_t triangles = 0;
  double cost = 0;                  // by CostModel, in triangles
  double level_px = 0;              // the error of its levels in this frame
  double bound_px = 0, gap_px = 0;  // in this frame; its gaps are known only when it is made
  Picture picture;                  // as it will be committed
  bool several = false;             // shows several objects
  bool once = false;                // for this frame's eye alone: its gaps need not be known
  std::uint32_t order = 0;          // its number if it is made beside the frames; 0: in this one
  std::optional<DeltaRange> range;  // the Deltas that it was found to show
  std::optional<float> life_share;  // and how much its gaps shorten its life
};

// A picture to draw, in the cross-fade range [from, to). At each pixel, the ranges of what overlaps
// in a fade are complementary.
struct DrawnPicture {
  std::uint32_t slot = 0;
  float from = 0, to = 1;
  float bound_px = 0, gap_px = 0;
};
// An object to draw as polygons, in a cross-fade range.
struct DrawnObject {
  std::uint32_t object = 0;  // static: the caller's index; moving: index in `moving`
  float from = 0, to = 1;
  float level_error = 0;  // by levels that are at most so far off, metres
  // Its expected cost before anything was known of it (PolygonRecord), in triangles; 0: nothing was
  // expected.
  float expected_cost = 0;
};
// A baked representation to draw, at all pixels.
struct DrawnAlternative {
  std::uint32_t alternative = 0;  // index into Alternatives::list
  float bound_px = 0, gap_px = 0;
};

// One picture of static objects for which a frame has neither time nor a picture, as coarse as the
// time requires: captured for this frame's eye, by rays, and not kept.
struct Fallback {
  std::vector<std::uint32_t> objects;  // the caller's indices; empty: there is none
  PictureGeometry geometry;            // geometry.capture is the camera to capture with
  double texel_px = 1;                 // the width of its texels, in pixels of the frame
  double bound_px = 0, gap_px = 0;     // gap_px: of what lies between its rays
};

// The decisions for one frame.
struct Plan {
  std::vector<std::uint32_t> evictions;  // slots
  std::vector<Capture> captures;         // most urgent first
  std::vector<DrawnPicture> pictures;
  std::vector<DrawnObject> polygons, moving_polygons;
  std::vector<DrawnAlternative> alternatives;
  std::vector<std::uint32_t> retirements;  // slots that begin to fade out
  Fallback fallback;

  std::size_t entities = 0;  // nodes and moving objects
  std::uint64_t polygon_triangles = 0, captured_triangles = 0;
  std::uint64_t bytes = 0;        // of all pictures, after evictions and captures
  int single = 0, hierarchy = 0;  // drawn pictures of one object, and of several
  double bound_px = 0;            // the largest of what is drawn
  double polygon_px = 0;          // of polygons, by their levels
  double gap_px = 0;              // the largest bound_gap_px of the pictures drawn, and of cracks
  int starved = 0;                // captures for which memory did not suffice
  double credit = 0, texel_scale = 1;
  double cost = 0;           // of drawing and captures, by CostModel, in triangles
  double fallback_cost = 0;  // what of it is for the fallback
  double limit = 0;          // on it, if it had to be limited
  double usual_cost = 0;     // CacheState's after it
};

// The result of a capture that a plan wants.
struct MadeCapture {
  bool made = false;                // false: there was no room for it
  std::optional<DeltaRange> range;  // the Deltas that it shows; none: it is empty
  GapTable gaps;                    // all zero if nobody asked for them
  StrokeSize strokes;               // of the points and lines in it
};

// Buffers of plan_frame; their contents are not used between frames.
struct PlanScratch {
  // A slot's error bound now and its remaining life, as of `frame`.
  struct Checked {
    std::uint32_t frame = 0xFFFFFFFFu;
    double now_px = 0, gap_px = 0,
           remaining = 0;  // now_px is infinite if the picture cannot be drawn
    bool late = false;     // it can, but a bound is above its limit
  };
  // A capture that is wanted.
  struct Request {
    Entity entity = 0;
    float deadline = 0, worth = 0;
    float cost = 0;    // of the capture, by CostModel, in triangles
    float texels = 0;  // near the frame, at full density
    bool due = false;  // in view, and nothing at hand shows it but polygons that cost more
  };
  std::vector<Checked> checked;         // by slot
  std::vector<std::uint8_t> choice;     // by entity
  std::vector<float> now_cost;          // by entity
  std::vector<std::uint32_t> captured;  // by entity: capture + 1
  // An object's, with what drawing them costs.
  struct Polygons {
    Entity entity = 0;
    float cost = 0;
    std::uint64_t triangles = 0;
  };
  std::vector<Polygons> polygons;      // of Plan::polygons
  std::vector<std::uint32_t> dearest;  // indices of those
  std::vector<Request> requests;
  std::vector<std::uint8_t> fallback;  // by entity: due, and there is no time
  std::vector<Box> boxes;              // of Plan::fallback's objects
  std::vector<std::uint32_t> idle;
  std::vector<std::uint8_t> dropped;  // by slot
  std::vector<MadeCapture> made;      // by capture
};

// The box of an entity now, world space.
[[nodiscard]] const Box& box_of(Entity entity, const Hierarchy& hierarchy,
                                std::span<const MovingObject> moving);
// The motion of what a picture shows since it was captured, world space; none if it stands still.
[[nodiscard]] glm::dmat4 motion_since(const Picture& picture, const Hierarchy& hierarchy,
                                      std::span<const MovingObject> moving);

// Makes the pictures that a plan asks for, while it is made.
class CaptureMaker {
 public:
  virtual ~CaptureMaker() = default;
  // Frees the textures of `evictions`, and makes the captures, in this order; `made` has an entry
  // for each. None of them is ordered (Capture::order).
  virtual void make(std::span<const std::uint32_t> evictions, std::span<const Capture> captures,
                    std::span<MadeCapture> made) = 0;
  // Frees the texture of a picture that was made and is not good enough for this frame: it was
  // expected to be flatter, or to hide less.
  virtual void drop(std::uint32_t slot) = 0;
  // Makes the coarse picture. If there is no room for it, its objects are drawn as polygons.
  virtual MadeCapture make(const Fallback& fallback) = 0;
};

// The scene as the planner sees it; refers to what the caller holds.
struct PlanScene {
  const Hierarchy& hierarchy;            // static objects
  std::span<const MovingObject> moving;  // as they are in this frame
  const Alternatives& alternatives;      // can be empty, as can the levels
  const LevelTable& levels;
};

// Plans a frame, and has `maker` make its pictures. Requires a perspective camera that passes
// validate(), and a state to which the last plan was committed, for the same hierarchy and number
// of moving objects.
void plan_frame(const PlanScene& scene, const CacheState& state, const FrameView& view,
                const CacheOptions& options, CaptureMaker& maker, PlanScratch& scratch, Plan& plan);

// Enters into the state a capture that an earlier plan ordered (Capture::order) and that is done.
// Call it before the frame of camera `frame` is planned. `range`: the Deltas that the picture
// shows; none if it is empty. Returns whether the picture is good enough for that frame and still
// wanted; otherwise the caller drops the picture, and the order is over, too. Appends to
// `evictions` the slot of the picture that the new one displaces, if any.
[[nodiscard]] bool adopt_capture(Capture& capture, const Camera& frame, const Hierarchy& hierarchy,
                                 std::span<const MovingObject> moving,
                                 const std::optional<DeltaRange>& range, const GapTable& gaps,
                                 const CacheOptions& options, CacheState& state,
                                 std::vector<std::uint32_t>& evictions);
// Returns whether an ordered capture is still wanted: not once one of its objects was invalidated.
[[nodiscard]] bool is_wanted(const Capture& capture, const CacheState& state);
// Forgets an ordered capture for which there is no room.
void cancel_order(const Capture& capture, CacheState& state);

// Records in the state that the plan was carried out.
void commit(const Plan& plan, CacheState& state);

// Records how much of the last plan's pictures was seen, after commit(): an entry for each of
// plan.pictures, the share of its blocks that the frame shows. Hidden objects cost little as
// polygons, and are worth no captures.
void learn_seen(const Plan& plan, std::span<const float> shares, CacheState& state);

// The cost of drawing one object as polygons, in triangles, and the expected one
// (DrawnObject::expected_cost).
struct PolygonCost {
  Entity entity = 0;  // of one object
  double expected = 0, cost = 0;
};
// Records what the last plan's polygons took, after commit(). The next plans expect the like.
void learn_polygons(std::span<const PolygonCost> costs, CacheState& state);

// Drops all pictures, because the light or all objects changed. Appends their slots to `evictions`.
void invalidate(CacheState& state, std::vector<std::uint32_t>& evictions);
// Drops the pictures that show one object (static; moving), because it changed.
void invalidate(const Hierarchy& hierarchy, std::uint32_t object, CacheState& state,
                std::vector<std::uint32_t>& evictions);
void invalidate_moving(const Hierarchy& hierarchy, std::uint32_t object, CacheState& state,
                       std::vector<std::uint32_t>& evictions);

}  // namespace rilievo
