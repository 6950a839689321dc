// How does OpenGL draw a scene from pictures within an error that the user sets in pixels?
//
// scene_cache.h says what is drawn; this class captures and draws with OpenGL, within another
// program's frame if necessary (scene_frames.h).
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "rilievo/cache/scene_cache.h"
#include "rilievo/frame/gl/scene_frames.h"
#include "rilievo/nailboard/gl/nailboard_set.h"
#include "rilievo/representation/bake_objects.h"

namespace rilievo {

// A frame source that captures pictures and reuses them.
class ImageCache final : public SceneFrames {
 public:
  ~ImageCache() override;
  ImageCache(ImageCache&&) noexcept;

  // `renderer` must outlive the cache. Fails where the atlas cannot be allocated, where
  // options.machine was measured without OpenGL, and with options.levels.
  [[nodiscard]] static Result<ImageCache> create(SceneRenderer& renderer,
                                                 const ImageCacheOptions& options);
  // Only what keeps pictures, for others who choose (cache/picture_chooser.h) or measure
  // (cache/measure_costs.h). `renderer` must outlive it. Fails where the atlas cannot be allocated.
  [[nodiscard]] static Result<std::unique_ptr<CachePictures>> make_pictures(
      SceneRenderer& renderer, const ImageCacheOptions& options);

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

  // error_px, gap_px, capture_ms, fade_frames and outlines can be changed between frames.
  [[nodiscard]] ImageCacheOptions& options();

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
  class Store;
  [[nodiscard]] static Result<std::unique_ptr<Store>> make_store(SceneRenderer& renderer,
                                                                 const ImageCacheOptions& options);
  ImageCache(SceneRenderer& renderer, std::unique_ptr<Store> store,
             const ImageCacheOptions& options);
  Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) override;
  void prepare_objects() override;

  std::unique_ptr<Store> store_;
  std::unique_ptr<SceneCache> cache_;
};

}  // namespace rilievo
