// Direct drawing and the cache in one chooser: both are drawn by the same frames.
//
// So a change from one to the other copies nothing and takes no memory twice: textures, the target
// and the placed scene are the same. The cache is made when it is first used, and keeps its
// pictures while polygons are drawn.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "rilievo/cache/scene_cache.h"
#include "rilievo/frame/backend.h"
#include "rilievo/method/direct.h"

namespace rilievo {

// Chooses polygons for everything in view, or what the cache chooses.
class DirectOrCached final : public FrameChooser {
 public:
  // `backend` must outlive the object, and make its frames.
  DirectOrCached(Backend& backend, const ImageCacheOptions& options)
      : backend_(backend), options_(options) {}

  // From the next frame on.
  void use_cache(bool use) { uses_cache_ = use; }
  // Can it not be made?
  [[nodiscard]] bool cache_failed() const { return failed_; }
  // The cache's; those that can change between frames do.
  [[nodiscard]] ImageCacheOptions& options() { return cache_ ? cache_->options() : options_; }

  // The time of the last frame by counts of its work, not by a clock: the same on all machines, in
  // milliseconds of the machine of FrameLoad (method/frame_load.h), roughly.
  [[nodiscard]] double counted_ms() const { return counted_ms_; }

  void add_sets(FrameContent&) override {}
  // Where the cache cannot be made, polygons.
  Result<> choose(const Camera& camera, const PlacedScene& placed, FrameContent& content,
                  FrameStats& stats) override;
  void drawn(const FrameWork* work, FrameStats& stats) override;
  void prepare_objects() override;
  [[nodiscard]] std::vector<DepthImage> read_pictures(const FrameContent& content) const override;

 private:
  [[nodiscard]] bool chose_cache() const { return uses_cache_ && cache_; }

  Backend& backend_;
  ImageCacheOptions options_;
  DirectChooser direct_;
  std::unique_ptr<SceneCache> cache_;
  bool uses_cache_ = false, failed_ = false;
  double counted_ms_ = 0, beside_polygons_ = 0;
};

}  // namespace rilievo
