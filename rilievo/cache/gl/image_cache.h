// A scene drawn from pictures within an error that the user sets in pixels (S1.5, S1.7).
//
// The static parts hang in a spatial hierarchy whose nodes keep pictures of everything below them;
// each moving object is a nailboard or polygons, by its cost and its picture's expected life.
// Layered impostors that were baked before may stand for objects too. What
// is done is decided by policy.h; here it is carried out with OpenGL.
//
// Draws into whichever framebuffer and viewport are bound, with the caller's camera, in the
// caller's z-buffer, and leaves the OpenGL state as it was found: it can be used inside somebody
// else's frame.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "rilievo/cache/eye_motion.h"
#include "rilievo/cache/policy.h"
#include "rilievo/frame/gl/frame_source.h"
#include "rilievo/layered_impostor/gl/layered_drawer.h"
#include "rilievo/layered_impostor/gl/object_impostors.h"
#include "rilievo/nailboard/gl/nailboard_drawer.h"
#include "rilievo/nailboard/gl/picture_atlas.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo {

struct ImageCacheOptions {
  double error_px = 1;
  std::size_t max_bytes = std::size_t(256) << 20;  // all texture memory that pictures take
  // Time for captures in a frame, by the clock; 0: by CacheOptions::capture_triangles, which makes
  // a run reproducible.
  double capture_ms = 0;
  int fade_frames = CacheOptions{}.fade_frames;  // 1: a new picture replaces the old one at once
  int delta_bits = 8;
  DepthMode depth_mode = DepthMode::exact;
  int samples = 4;  // of the framebuffer that is drawn into
  CaptureBy capture_by = CaptureBy::automatic;
  bool outlines = false;
  bool sky = true;  // draw the scene's sky where nothing else is
};

class ImageCache : public FrameSource {
 public:
  // `renderer` must outlive it.
  [[nodiscard]] static Result<ImageCache> create(SceneRenderer& renderer,
                                                 const ImageCacheOptions& options);

  // Impostors that may be drawn instead of their objects' polygons, within error_px and where they
  // cost less. They take memory besides max_bytes, count among picture_bytes, and are given up when
  // the light changes. `options.method` is the one that they were made for. Once, before the first
  // frame.
  Result<> add_baked(std::vector<ObjectImpostor> impostors, const LayeredOptions& options);

  // One frame. The motion of the eye since the last one is taken for its motion in the next ones.
  Result<> draw(const Camera& camera, double time) override;
  Result<> draw_objects() override;
  [[nodiscard]] FrameFigures figures() const override { return figures_; }
  void append_errors(int step, std::vector<float>& errors_px) const override;

  // Forgets every picture, and what is baked: the light has changed.
  void invalidate();
  // Forgets the pictures that show this object (index into Scene::objects), and what it has baked.
  void invalidate_object(std::uint32_t object);

  // May be changed between frames: error_px, capture_ms, fade_frames, outlines.
  [[nodiscard]] ImageCacheOptions& options() { return options_; }

  // What the last frame drew from pictures, for measures and for saving.
  struct Shown {
    PictureGeometry geometry;
    glm::dmat4 world_now_from_capture{1.0};
    double bound_px = 0;
    std::vector<std::uint32_t> objects;  // indices into Scene::objects
    AtlasSlot slot;
  };
  [[nodiscard]] std::vector<Shown> shown() const;
  [[nodiscard]] std::vector<DepthImage> read_pictures() const;

 private:
  struct Baked {
    ObjectImpostor impostor;
    std::vector<LayeredInstance> instances{};
  };
  struct Held {
    std::optional<AtlasSlot> slot;
    bool objects_captured = false;  // identifiers, for probes
    std::vector<std::uint32_t> objects;
    Camera camera;
  };

  ImageCache(SceneRenderer& renderer, PictureAtlas atlas, NailboardDrawer drawer)
      : renderer_(renderer), atlas_(std::move(atlas)), drawer_(std::move(drawer)) {}
  void build();
  void update_moving();
  void plan(const Camera& camera);
  void carry_out_captures();
  void collect();
  void objects_of(Entity entity, std::vector<std::uint32_t>& objects) const;
  [[nodiscard]] glm::dmat4 motion_since_capture(const Picture& picture) const;
  void release(std::uint32_t slot);
  [[nodiscard]] std::uint32_t& baked_name(std::uint32_t object);
  void name_baked();

  SceneRenderer& renderer_;
  ImageCacheOptions options_;
  PictureAtlas atlas_;
  NailboardDrawer drawer_;

  std::vector<std::uint32_t> static_objects_,
      moving_objects_;                  // the caller's and ours to the scene's
  std::vector<std::uint32_t> blended_;  // objects with blended parts
  Hierarchy hierarchy_;
  std::vector<MovingObject> moving_;
  std::vector<Baked> baked_;
  BakedObjects baked_objects_;
  std::optional<LayeredDrawer> layered_drawer_;
  LayeredOptions layered_options_;
  std::size_t baked_bytes_ = 0;
  CacheOptions policy_;
  CacheState state_;
  PlanScratch scratch_;
  Plan plan_;
  std::vector<Held> held_;  // by slot of the state

  std::vector<NailboardInstance> instances_;
  std::vector<std::uint32_t> polygons_, faded_, visible_blended_;
  std::vector<PixelShare> shares_;
  Camera camera_;
  double time_ = 0;
  EyeMotion motion_;
  double triangles_per_ms_ = 0;  // of captures, measured
  FrameFigures figures_;
};

}  // namespace rilievo
