#include "rilievo/cache/software/software_picture_frames.h"

#include <utility>

#include "rilievo/cache/software/software_cache.h"

namespace rilievo {

Result<std::unique_ptr<SoftwareChosenFrames>> make_software_picture_frames(
    const Scene& scene, const PictureFramesOptions& options) {
  if (Result<> possible = SoftwareCache::check(store_options(options)); !possible)
    return possible.error();
  return SoftwareChosenFrames::create(
      scene, options.samples, options.outlines,
      [&](const PlacedScene& placed) -> Result<std::unique_ptr<FrameChooser>> {
        Result<std::unique_ptr<CachePictures>> store =
            SoftwareCache::make_pictures(placed, store_options(options));
        if (!store) return store.error();
        return {std::make_unique<PictureChooser>(placed, std::move(*store), options)};
      });
}

}  // namespace rilievo
