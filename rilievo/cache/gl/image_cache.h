// How is a scene drawn from pictures within an error that the user sets in pixels? (S1.5, S1.7)
//
// Static objects are in a spatial hierarchy, whose nodes keep pictures of everything below them.
// Each moving object is a nailboard or polygons, depending on its cost and its picture's expected
// life. Baked representations of any kind can stand for objects too. policy.h decides; this class
// carries the decisions out with OpenGL, within another program's frame if necessary
// (scene_frames.h).
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "rilievo/cache/eye_motion.h"
#include "rilievo/cache/policy.h"
#include "rilievo/capture/gl/capture_by.h"
#include "rilievo/frame/gl/scene_frames.h"
#include "rilievo/nailboard/gl/nailboard_set.h"
#include "rilievo/representation/gl/object_drawables.h"

namespace rilievo {

// The error, the memory and the time that the cache may use.
struct ImageCacheOptions {
  double error_px = 1;  // the largest error bound of a picture that is drawn
  double gap_px = 0;    // as CacheOptions::gap_px
  std::size_t max_bytes = std::size_t(256) << 20;  // of textures of pictures
  // Time for captures per frame, by the clock. 0: limited by CacheOptions::capture_triangles, which
  // makes runs reproducible.
  double capture_ms = 0;
  int fade_frames = CacheOptions{}.fade_frames;  // 1: a new picture replaces the old one at once
  int delta_bits = 8;
  DepthMode depth_mode = DepthMode::exact;
  int samples = 4;  // of the framebuffer that is drawn into
  CaptureBy capture_by = CaptureBy::automatic;
  bool outlines = false;
  bool sky = true;  // draw the scene's sky behind everything
};

// A frame source that captures pictures and reuses them.
class ImageCache final : public SceneFrames {
 public:
  // `renderer` must outlive the cache. Fails where the atlas cannot be allocated.
  [[nodiscard]] static Result<ImageCache> create(SceneRenderer& renderer,
                                                 const ImageCacheOptions& options);

  // Adds baked representations. The cache draws them where they stay within error_px and cost less
  // than polygons and pictures. They use memory beyond max_bytes, count in picture_bytes, and are
  // dropped by invalidate(). Can be called several times.
  void add_alternatives(std::vector<ObjectDrawable> drawables,
                        std::unique_ptr<DrawableFactory> factory);

  // Adds an alternative that stands for all these objects at once where its bound allows it: the
  // surroundings of the eyes. The objects stand still, have opaque parts, and were baked where they
  // are; ascending. Before the first frame, once.
  void add_surroundings(std::unique_ptr<Drawable> drawable,
                        std::unique_ptr<DrawableFactory> factory,
                        std::vector<std::uint32_t> objects);

  // Drops all pictures and baked representations, because the light has changed.
  void invalidate();
  // Drops the pictures and baked representations of one object (index into Scene::objects).
  void invalidate_object(std::uint32_t object);

  // error_px, gap_px, capture_ms, fade_frames and outlines can be changed between frames.
  [[nodiscard]] ImageCacheOptions& options() { return options_; }

  // A picture that the last frame drew, for measures and for saving.
  struct Shown {
    PictureGeometry geometry;
    glm::dmat4 world_now_from_capture{1.0};
    double bound_px = 0;
    std::vector<std::uint32_t> objects;  // indices into Scene::objects
    AtlasSlot slot;
  };
  [[nodiscard]] std::vector<Shown> shown() const;
  [[nodiscard]] std::vector<DepthImage> read_pictures() const override;

 private:
  struct Held {
    std::optional<AtlasSlot> slot;
    bool objects_captured = false;  // identifiers, for probes
    std::vector<std::uint32_t> objects;
    Camera camera;
  };

  ImageCache(SceneRenderer& renderer, std::unique_ptr<CaptureWithoutOpenGL> capturer,
             std::unique_ptr<NailboardSet> pictures, const ImageCacheOptions& options);
  Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) override;
  void prepare_objects() override;
  void build();
  void build_tree(std::span<const std::uint32_t> apart);
  void add_drawable(ObjectDrawable drawable);
  void update_moving();
  void plan(const Camera& camera);
  void carry_out_captures(const Camera& camera, FrameStats& stats);
  void collect(FrameContent& content);
  void objects_of(Entity entity, std::vector<std::uint32_t>& objects) const;
  [[nodiscard]] Entity entity_of(std::uint32_t object) const;
  [[nodiscard]] glm::dmat4 motion_since_capture(const Picture& picture) const;
  void release(std::uint32_t slot);
  void index_alternatives();

  ImageCacheOptions options_;
  std::unique_ptr<CaptureWithoutOpenGL> capturer_;  // null: OpenGL captures
  std::unique_ptr<NailboardSet> pictures_;

  std::vector<std::uint32_t> static_objects_,
      moving_objects_;  // the caller's and ours to the scene's
  Hierarchy hierarchy_;
  std::vector<Entity> leaf_of_;  // by static object
  std::vector<MovingObject> moving_;
  std::vector<std::unique_ptr<DrawableFactory>> factories_;  // outlive the drawables
  std::vector<ObjectDrawable> drawables_;
  Alternatives alternatives_;
  std::size_t alternative_bytes_ = 0;
  CacheOptions policy_;
  CacheState state_;
  PlanScratch scratch_;
  Plan plan_;
  std::vector<Held> held_;      // by slot of the state
  std::vector<GapTable> gaps_;  // by capture of the plan

  EyeMotion motion_;
  double cost_per_ms_ = 0;  // of captures: Capture::cost, measured
};

}  // namespace rilievo
