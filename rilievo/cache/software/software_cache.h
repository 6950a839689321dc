// How is a scene drawn from pictures within an error in pixels, without OpenGL?
//
// scene_cache.h says what is drawn, the same as for OpenGL whose pictures the rasteriser captures;
// this class keeps the pictures in memory, and composes the frames there. What was baked stands for
// objects by the same rules, and is drawn into the same tiles.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "rilievo/cache/scene_cache.h"
#include "rilievo/frame/software/software_frames.h"

namespace rilievo {

// A frame source that captures pictures and reuses them, in memory.
class SoftwareCache final : public SoftwareFrames {
 public:
  // `scene` must be valid and outlive the cache. Fails if max_bytes does not suffice for captures,
  // if the samples are neither 1 nor 4, and for OpenGL's captures.
  [[nodiscard]] static Result<std::unique_ptr<SoftwareCache>> create(
      const Scene& scene, const ImageCacheOptions& options);
  ~SoftwareCache() override;
  // Would create() fail? The error says why.
  [[nodiscard]] static Result<> check(const ImageCacheOptions& options);
  // Only what keeps pictures, for others who choose (cache/picture_chooser.h) or measure
  // (cache/measure_costs.h). `placed` must outlive it. Fails as create() does.
  [[nodiscard]] static Result<std::unique_ptr<CachePictures>> make_pictures(
      const PlacedScene& placed, const ImageCacheOptions& options);

  // As ImageCache's; drawables and factories are those without OpenGL (software_drawable_rows).
  void add_alternatives(std::vector<ObjectDrawable> drawables,
                        std::unique_ptr<DrawableFactory> factory);
  void add_surroundings(std::unique_ptr<Drawable> drawable,
                        std::unique_ptr<DrawableFactory> factory,
                        std::vector<std::uint32_t> objects);
  void invalidate();
  void finish_captures();
  void invalidate_object(std::uint32_t object);
  [[nodiscard]] ImageCacheOptions& options();
  [[nodiscard]] std::vector<SceneCache::Shown> shown() const;
  [[nodiscard]] std::vector<DepthImage> read_pictures() const override;

 private:
  class Store;
  SoftwareCache(const Scene& scene, std::unique_ptr<ObjectLevels> levels,
                const ImageCacheOptions& options);
  Result<> choose(const Camera& camera, FrameContent& content, FrameStats& stats) override;
  void prepare_objects() override;
  void learn(std::span<const ObjectWork> work) override;

  std::unique_ptr<ObjectLevels> levels_;  // null: none; frames are drawn from its scene
  std::unique_ptr<Store> store_;
  std::unique_ptr<SceneCache> cache_;
  std::vector<float> seen_shares_;  // of the last frame's pictures
};

}  // namespace rilievo
