// The image cache: draws a scene from pictures within an error in pixels (S1.5, S1.7).
//
// Static objects are in a spatial hierarchy, whose nodes keep pictures of everything below them.
// Each moving object is a nailboard or polygons, depending on its cost and its picture's expected
// life. Baked representations of any kind can stand for objects too. policy.h decides; this class
// keeps what is decided, and has a NailboardStore make the pictures. A chooser: it draws nothing
// itself, and knows its backend by its store only.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "rilievo/cache/captures_beside.h"
#include "rilievo/cache/plan/eye_motion.h"
#include "rilievo/cache/plan/policy.h"
#include "rilievo/cache/prices/cost_clock.h"
#include "rilievo/cache/prices/machine_costs.h"
#include "rilievo/capture/capture_by.h"
#include "rilievo/capture/coarse_capture.h"
#include "rilievo/core/stopwatch.h"
#include "rilievo/frame/frame_chooser.h"
#include "rilievo/frame/leveled_backend.h"
#include "rilievo/kind/kind.h"
#include "rilievo/nailboard/nailboard_store.h"
#include "rilievo/representation/object_drawable.h"

namespace rilievo {

// The error, the memory and the time that the cache may use.
struct ImageCacheOptions {
  double error_px = 1;  // the largest error bound of a picture that is drawn
  double gap_px = 0;    // as CacheOptions::gap_px
  std::size_t max_bytes = std::size_t(256) << 20;  // of pictures
  // Time for captures per frame, milliseconds. The rasteriser captures beside the frames, which do
  // not wait for it; the captures that are not done take at most so long together. A picture whose
  // successor is not done is drawn later than its bound allows, and an object without a picture is
  // in a coarse picture by rays (policy.h, Fallback). OpenGL captures within the frame. 0: captures
  // are part of the frame, and CacheOptions::capture_triangles limits them, so that runs are
  // reproducible.
  double capture_ms = 0;
  // With capture_ms and the rasteriser, a picture whose successor is not done stays until its
  // bounds reach their limits times this factor. 1, the least: no picture exceeds its limits.
  double late = SpikePolicy{}.late;
  // How late pictures may be in the first frames after some that were drawn without the cache, as
  // SpikePolicy::catch_up. 0: not at all.
  double catch_up = 0;
  // A frame that would cost more than so many times what the last ones did, and more than 100 ms,
  // by the costs that the planner compares, shows what costs most, after a cut for instance, in a
  // coarse picture by rays; bounds say so. Where the rasteriser captures. 0: no such limit.
  double max_spike = 0;
  int fade_frames = CacheOptions{}.fade_frames;  // 1: a new picture replaces the old one at once
  int delta_bits = 8;
  DepthMode depth_mode = DepthMode::exact;
  int samples = 4;  // of the frame that is drawn into
  CaptureBy capture_by = CaptureBy::automatic;
  bool outlines = false;
  bool sky = true;  // draw the scene's sky behind everything
  // Draw and capture objects that stand still by levels of detail where their error is bounded and
  // it costs less; the pictures' limit is stricter by it. Without OpenGL only.
  bool levels = false;
  // Price polygons by what those of the last frames took, and by how much of pictures was seen; by
  // counts and not by the clock: an object that others hide costs little to draw, and is not worth
  // a picture. Without OpenGL only.
  bool learn = true;
  // The costs that the planner compares; none: those built in (policy.h), so that frames are the
  // same on all machines, as they are with the same costs of any one machine.
  std::optional<MachineCosts> machine = {};
};

// The options of a store for these options.
[[nodiscard]] NailboardStoreOptions store_options(const ImageCacheOptions& options);

// Chooses a scene's frames, and captures for them.
class SceneCache final : public FrameChooser, private CaptureMaker {
 public:
  // A cache of `backend`'s scene. make_cached_frames() makes its frames, too. Fails where the store
  // cannot be made, and where options.machine was measured without this backend.
  [[nodiscard]] static Result<std::unique_ptr<SceneCache>> create(Backend& backend,
                                                                  const ImageCacheOptions& options);
  // `placed` must outlive the cache, and be what choose() gets. `store` is empty and made with
  // store_options(). `levels`: of the scene `finest`, which must outlive the cache; `placed` places
  // theirs.
  SceneCache(const PlacedScene& placed, std::unique_ptr<NailboardStore> store,
             const ImageCacheOptions& options, std::unique_ptr<LeveledBackend> levels = nullptr,
             const Scene* finest = nullptr);

  // Adds baked representations. The cache draws them where they stay within error_px and cost less
  // than polygons and pictures. They use memory beyond max_bytes, count in picture_bytes, and are
  // dropped by invalidate(). Can be called several times.
  void add_alternatives(std::vector<ObjectDrawable> drawables,
                        std::unique_ptr<DrawableFactory> factory);
  // Adds an alternative that stands for all these objects at once where its bound allows it: the
  // surroundings of the eyes, or a thing of many parts. The objects stand still, have opaque parts,
  // and were baked where they are; ascending. Before the first frame, once.
  void add_surroundings(std::unique_ptr<Drawable> drawable,
                        std::unique_ptr<DrawableFactory> factory,
                        std::vector<std::uint32_t> objects);
  // Drops all pictures and baked representations, because the light has changed.
  void invalidate();
  // Waits until no capture reads the scene (capture_ms). Call it before the light changes, and then
  // invalidate().
  void finish_captures();
  // Drops the pictures and baked representations of one object (index into Scene::objects).
  void invalidate_object(std::uint32_t object);

  void add_sets(FrameContent& content) override;
  // Plans a frame of the scene as it is placed now, captures, and fills `content`.
  Result<> choose(const Camera& camera, const PlacedScene& placed, FrameContent& content,
                  FrameStats& stats) override;
  // Learns from what drawing the polygons of the last choose() took, and from how much of its
  // pictures was seen (ImageCacheOptions::learn).
  void drawn(const FrameWork* work, FrameStats& stats) override;
  // The same: `seen_shares` has an entry for each instance of the set of pictures.
  void learn(std::span<const ObjectWork> work, std::span<const float> seen_shares);
  // Captures the identifiers of the last frame's pictures of several objects, where they are
  // missing.
  void prepare_objects() override;
  [[nodiscard]] std::vector<DepthImage> read_pictures(const FrameContent& content) const override;

  // error_px, gap_px, capture_ms, late, max_spike, fade_frames and outlines can be changed between
  // frames.
  [[nodiscard]] ImageCacheOptions& options() { return options_; }
  [[nodiscard]] const ImageCacheOptions& options() const { return options_; }

  // A picture that the last frame drew, for measures and for saving.
  struct Shown {
    PictureGeometry geometry;
    glm::dmat4 world_now_from_capture{1.0};
    double bound_px = 0;
    std::vector<std::uint32_t> objects;  // indices into Scene::objects
    std::uint32_t slot = 0;              // of the store
  };
  [[nodiscard]] std::vector<Shown> shown() const;
  [[nodiscard]] const NailboardStore& store() const { return *store_; }
  // The backend of levels of detail; null: there are none, and frames are the first backend's.
  [[nodiscard]] Backend* level_backend() const { return levels_ ? &levels_->backend() : nullptr; }

 private:
  // The store's slots: the fallback's, then those of the plan.
  static constexpr std::uint32_t kFallbackSlot = 0;
  static std::uint32_t stored(std::uint32_t slot) { return slot + 1; }

  struct Held {
    bool held = false;
    bool objects_captured = false;  // identifiers, for probes
    std::vector<std::uint32_t> objects;
    Camera camera;
  };

  void build();
  void build_tree(std::span<const std::uint32_t> apart);
  void build_levels();
  void show_levels(std::span<const std::uint32_t> objects, double error);
  void show_polygon_levels();
  void add_drawable(ObjectDrawable drawable);
  void retire_drawables();
  void update_moving();
  void follow_options();
  void set_budget();
  [[nodiscard]] bool may_spike() const;
  // CaptureMaker: what a plan asks for.
  void make(std::span<const std::uint32_t> evictions, std::span<const Capture> captures,
            std::span<MadeCapture> made) override;
  void drop(std::uint32_t slot) override { release(slot); }
  MadeCapture make(const Fallback& fallback) override;
  void order_captures();
  void adopt_captures(const Camera& camera, FrameStats& stats);
  void hold(const Capture& capture);
  void collect(FrameContent& content);
  void objects_of(Entity entity, std::vector<std::uint32_t>& objects) const;
  [[nodiscard]] Entity entity_of(std::uint32_t object) const;
  [[nodiscard]] glm::dmat4 motion_since_capture(const Picture& picture) const;
  void release(std::uint32_t slot);
  void index_alternatives();

  std::unique_ptr<LeveledBackend> levels_;  // null: objects are drawn as they are
  const PlacedScene& placed_;
  std::unique_ptr<NailboardStore> store_;
  const Scene& finest_;  // for rays, whose time hardly depends on the number of triangles
  ImageCacheOptions options_;

  std::vector<std::uint32_t> static_objects_,
      moving_objects_;  // the caller's and ours to the scene's
  Hierarchy hierarchy_;
  LevelTable level_table_;
  std::vector<Entity> leaf_of_;      // by static object
  std::vector<ObjectWork> work_of_;  // by object: of the last frame that drew it as polygons
  std::vector<PolygonCost> polygon_costs_;
  std::vector<MovingObject> moving_;
  std::vector<std::unique_ptr<DrawableFactory>> factories_;  // outlive the drawables
  std::vector<ObjectDrawable> drawables_;
  // Dropped by invalidate(): the last frame may be drawn from them once more.
  std::vector<std::unique_ptr<DrawableFactory>> retired_factories_;
  std::vector<ObjectDrawable> retired_;
  bool sets_changed_ = false;  // since the last frame
  Alternatives alternatives_;
  std::size_t alternative_bytes_ = 0;
  CacheOptions policy_;
  CacheState state_;
  PlanScratch scratch_;
  Plan plan_;
  std::vector<Held> held_;       // by slot of the state
  FrameStats* stats_ = nullptr;  // of the frame that is being planned

  EyeMotion motion_;
  double cost_per_ms_ = 0;  // of captures: Capture::cost, measured
  // Where captures have a budget of time:
  CostClock clock_;
  Stopwatch since_choice_;
  CacheOptions unlimited_;                  // policy_ without such a budget
  bool casts_ = false;                      // has coarse_ been asked for?
  std::unique_ptr<CoarseCapture> coarse_;   // null: not yet, or memory did not suffice
  std::unique_ptr<CapturesBeside> beside_;  // null: nothing has been ordered yet
  std::vector<std::uint32_t> ordered_objects_, gone_;
  Held fallback_;                   // of the last frame
  std::vector<float> seen_shares_;  // of the last frame's pictures
};

// Frames that a cache chooses. The cache lives as long as its frames.
struct CachedFrames {
  std::unique_ptr<FrameSource> frames;
  SceneCache* cache = nullptr;
};
// Fails as SceneCache::create() does. `backend` must outlive the frames.
[[nodiscard]] Result<CachedFrames> make_cached_frames(Backend& backend,
                                                      const ImageCacheOptions& options);

}  // namespace rilievo
