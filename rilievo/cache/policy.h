// What is each part of this frame drawn from, and which pictures are captured now? (S1.5, S1.7)
//
// A pure decision: from the hierarchy of static objects, the moving objects, the pictures at hand
// and the camera follows a Plan, which pictures to capture, to forget and to draw, and what to draw
// as polygons. No OpenGL. Once a frame:
//
//   plan_frame(hierarchy, moving, state, view, options, scratch, plan);
//   free the textures of plan.evictions; make those of plan.captures, in this order, and say
//   what they turned out to be: refuse_capture, narrow_capture
//   draw plan.pictures, plan.polygons, plan.moving_polygons, plan.alternatives in any order
//   commit(plan, state);
//
// Every picture drawn has bound_total_px <= CacheOptions::error_px, and if memory is short so much
// more as its texels are too coarse (Picture::coarse_px), and bound_gap_px <= gap_limit_px. What
// was baked before, of any kind, stands for its object where its ErrorModel allows it and it costs
// less: for what turns so fast that no flat picture lasts, above all. World space, metres; time in
// frames. The same plan for the same input. Steady state does not allocate.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "rilievo/cache/hierarchy.h"
#include "rilievo/core/camera.h"
#include "rilievo/kind/drawable.h"
#include "rilievo/nailboard/error.h"
#include "rilievo/nailboard/gap_table.h"

namespace rilievo {

// What drawing costs, in triangles: how many triangles the renderer draws in the same time.
// Defaults measured on a software rasteriser with four samples a pixel: a triangle 280 ns, a pixel
// of a picture 5 ns, a pixel of shaded polygons 30 ns.
struct CostModel {
  double picture = 10;          // one picture drawn
  double picture_pixel = 0.02;  // one pixel of its rectangle
  double object = 20;           // one object drawn as polygons, besides its triangles
  double polygon_pixel = 0.10;  // one pixel of the rectangle around an object
  double capture = 2000;        // one capture, besides ...
  double capture_triangle = 1;  // ... one triangle of it
  double capture_texel = 0.2;   // one texel of it
};

struct CacheOptions {
  double error_px = 1;  // allowed by bound_total_px
  // Allowed by bound_gap_px: how wide a strip a picture may lack of what was hidden when it was
  // captured, pixels; 0: twice error_px; infinite: not asked. What is torn opens twice as fast as
  // it slides: at twice error_px pictures live hardly shorter, and what was hidden is still caught.
  double gap_px = 0;
  std::uint64_t memory_bytes = 256u << 20;  // never exceeded by the pictures together
  // Budget of captures a frame: what capturing so many triangles costs, texels and all, beyond
  // what the frame would else draw of the same objects (captures of what is drawn as polygons are
  // nearly free), and their number. One capture is always allowed, however large.
  std::uint64_t capture_triangles = 500'000;
  int captures = 1000;
  // Of one picture that shows several objects: what a frame can afford to capture at once.
  std::uint64_t picture_triangles = 100'000;
  int max_texels = 1024;  // a side of a picture
  int texel_cell = 32;    // pictures take up multiples of this
  int bytes_per_texel = 5;
  int delta_bits = 8;
  DepthMode depth_mode = DepthMode::linear;
  // A picture at hand is given up only for something cheaper by this share.
  double hysteresis = 0.2;
  // Pictures are captured for an eye this share of their life ahead, where the motion leads: they
  // are good on the way there and on the way beyond. 0: from the frame's own eye; below 1.
  double anticipation = 0.8;
  // A new picture replaces the old one over so many frames, a growing share of the pixels; 1: at
  // once.
  int fade_frames = 10;
  // Captures that will be needed are spread over so many frames before.
  int spread_frames = 8;
  // No picture is expected to live longer: nobody walks straight on for ever.
  double longest_life = 600;
  CostModel cost;
};

[[nodiscard]] inline double gap_limit_px(const CacheOptions& options) {
  return options.gap_px > 0 ? options.gap_px : 2 * options.error_px;
}

// Where captures are rasterised without OpenGL (render/raster/raster_picture.h): a triangle costs a
// quarter of what it costs to draw, 70 ns, and a texel 15 ns. So pictures may show more, and live
// shorter.
[[nodiscard]] inline CacheOptions rasterized_cache_options() {
  CacheOptions options;
  options.cost.capture = 200;
  options.cost.capture_triangle = 0.25;
  options.cost.capture_texel = 0.06;
  options.capture_triangles *= 4;
  options.picture_triangles = 1'000'000;
  return options;
}

// A node of the hierarchy, by index, or moving object i as hierarchy.nodes.size() + i.
using Entity = std::uint32_t;

// Something baked before that may stand for an entity instead of its polygons or a picture.
struct Alternative {
  ErrorModel error;
  CostTerms cost;
  glm::dmat4 world_from_capture{1.0};      // now
  bool present = true;                     // false: not for this frame
  std::uint32_t object = 0, drawable = 0;  // the caller's names for both
};

struct Alternatives {
  std::vector<Alternative> list;
  // By entity: the places in `list` of those that may stand for it. Empty: none has any.
  std::vector<std::vector<std::uint32_t>> of_entity;
};

struct MovingObject {
  Box box;  // world, now
  std::uint64_t triangles = 0;
  glm::dmat4 world_from_object{1.0};  // now
  glm::dmat4 now_from_last{1.0};      // what it did in world space since the last frame
  bool deforms = false;               // always polygons
};

struct FrameView {
  Camera camera;  // perspective
  // As expected for the next frames (see eye_motion.h): of the eye, metres a frame; of the gaze,
  // radians a frame about this world axis.
  glm::dvec3 velocity{0.0}, turn{0.0};
};

struct Picture {
  Entity entity = 0;
  PictureGeometry geometry;           // world space at capture
  GapTable gaps;                      // all zero where they are not asked for
  glm::dmat4 world_from_object{1.0};  // of a moving object at capture
  double coarse_px = 0;               // of its error, what coarse texels made from the start
  double draw_cost = 0, rate = 0;     // triangles a frame: to draw; captures included
  std::uint64_t bytes = 0;
  double texel_scale = 1;  // below 1: coarser than the frame, memory was short
  std::uint32_t used = 0;  // the frame that drew it last
  std::uint32_t fade_start = 0, retire_start = 0;
  std::uint16_t fade_length = 1;    // frames
  std::uint16_t retire_length = 0;  // 0: not retiring
  std::uint16_t lead = 1;           // frames before its end at which it is replaced
  bool held = false;                // is there a picture in this slot?
};

// The picture is drawn while bound_total_px is at most this. Follows error_px when it changes.
[[nodiscard]] inline double limit_px(const Picture& picture, const CacheOptions& options) {
  return options.error_px + picture.coarse_px;
}

// What one frame leaves for the next. Start with an empty one.
struct CacheState {
  std::uint32_t frame = 0;
  std::vector<Picture> slots;  // slot: the picture's name, also for textures
  std::vector<std::uint32_t> free_slots;
  std::vector<std::uint32_t> current, previous;  // by entity: slot + 1, or 0; previous: fading out
  // Of its depths, how much an entity's last picture showed, if it had any; and how much pictures
  // show on the whole: mostly their fronts.
  std::vector<std::optional<DeltaRange>> ranges;
  DeltaRange usual_range[2];  // of one object; of several
  // Of the life that its flatness allows a picture, the share that its gaps allow, likewise.
  std::vector<std::optional<float>> life_shares;
  float usual_life_share[2] = {1, 1};
  std::uint64_t bytes = 0;
  double credit = 0;  // triangles saved up for captures
};

struct Capture {
  std::uint32_t slot = 0;
  Entity entity = 0;
  PictureGeometry geometry;  // geometry.capture is the camera to capture with, its size included
  std::uint64_t triangles = 0;
  double cost = 0;                  // as CostModel prices it, triangles
  Picture picture;                  // as committed
  bool several = false;             // objects
  std::optional<DeltaRange> range;  // what it turned out to show
  std::optional<float> life_share;  // and to hide
};

// Of the pixels, those whose hash in [0, 1) falls into [from, to) are drawn from this. At every
// pixel the shares of what overlaps in a fade are complementary.
struct DrawnPicture {
  std::uint32_t slot = 0;
  float from = 0, to = 1;
  float bound_px = 0, gap_px = 0;
};
struct DrawnObject {
  std::uint32_t object = 0;  // static: the caller's index; moving: index in `moving`
  float from = 0, to = 1;
};
// All pixels.
struct DrawnAlternative {
  std::uint32_t alternative = 0;  // index into Alternatives::list
  float bound_px = 0;
};

struct Plan {
  std::vector<std::uint32_t> evictions;  // slots
  std::vector<Capture> captures;         // most urgent first
  std::vector<DrawnPicture> pictures;
  std::vector<DrawnObject> polygons, moving_polygons;
  std::vector<DrawnAlternative> alternatives;
  std::vector<std::uint32_t> retirements;  // slots that begin to fade out

  std::size_t entities = 0;  // nodes and moving objects
  std::uint64_t polygon_triangles = 0, captured_triangles = 0;
  std::uint64_t bytes = 0;        // of all pictures, after evictions and captures
  int single = 0, hierarchy = 0;  // drawn pictures of one object, of several
  double bound_px = 0;            // the largest of the pictures and alternatives drawn
  double gap_px = 0;              // by bound_gap_px, the largest of the pictures drawn
  int starved = 0;                // captures that had no room in memory
  double credit = 0, texel_scale = 1;
};

// Buffers that plan_frame uses; contents mean nothing between frames.
struct PlanScratch {
  struct Checked {
    std::uint32_t frame = 0xFFFFFFFFu;
    double now_px = 0, gap_px = 0, remaining = 0;  // now_px is infinite where gap_px is too much
  };
  struct Request {
    Entity entity = 0;
    float deadline = 0, worth = 0;
    float cost = 0;  // of the capture, as CostModel prices it
  };
  std::vector<Checked> checked;         // by slot
  std::vector<std::uint8_t> choice;     // by entity
  std::vector<float> now_cost;          // by entity
  std::vector<std::uint32_t> captured;  // by entity: capture + 1
  std::vector<Request> requests;
  std::vector<std::uint32_t> idle;
  std::vector<std::uint8_t> dropped;  // by slot
};

// Requires a perspective camera that passes validate(), and a state committed after the last plan
// for the same hierarchy and number of moving objects.
void plan_frame(const Hierarchy& hierarchy, std::span<const MovingObject> moving,
                const CacheState& state, const FrameView& view, const CacheOptions& options,
                PlanScratch& scratch, Plan& plan, const Alternatives& alternatives = {});

// Capture `index` turned out to have samples between these Deltas only, and to hide as much as
// `gaps` says. To be called before commit(). Is it good enough for this frame? If not, it was
// expected to be flatter, or less torn, than it is: to be refused.
[[nodiscard]] bool narrow_capture(Plan& plan, std::size_t index, const Camera& frame,
                                  const DeltaRange& range, const CacheOptions& options,
                                  const GapTable& gaps = {});

// The textures of capture `index` could not be made: draws its objects as polygons instead, and
// forgets the capture. To be called before commit().
void refuse_capture(Plan& plan, std::size_t index, const Hierarchy& hierarchy,
                    std::span<const MovingObject> moving);

// The plan was carried out.
void commit(const Plan& plan, CacheState& state);

// The light changed, or all objects did: forgets every picture. The slots are appended to
// `evictions`.
void invalidate(CacheState& state, std::vector<std::uint32_t>& evictions);
// One object changed: forgets every picture that shows it.
void invalidate(const Hierarchy& hierarchy, std::uint32_t object, CacheState& state,
                std::vector<std::uint32_t>& evictions);
void invalidate_moving(const Hierarchy& hierarchy, std::uint32_t object, CacheState& state,
                       std::vector<std::uint32_t>& evictions);

}  // namespace rilievo
