#include "rilievo/cache/cpu/memory_picture_frames.h"

#include <utility>

#include "rilievo/cache/cpu/memory_cache.h"

namespace rilievo {

Result<std::unique_ptr<SoftwareChosenFrames>> make_memory_picture_frames(
    const Scene& scene, const PictureFramesOptions& options) {
  if (Result<> possible = MemoryCache::check(store_options(options)); !possible)
    return possible.error();
  return SoftwareChosenFrames::create(
      scene, options.samples, options.outlines,
      [&](const PlacedScene& placed) -> Result<std::unique_ptr<FrameChooser>> {
        Result<std::unique_ptr<CachePictures>> store =
            MemoryCache::make_pictures(placed, store_options(options));
        if (!store) return store.error();
        return {std::make_unique<PictureChooser>(placed, std::move(*store), options)};
      });
}

}  // namespace rilievo
