#include "rilievo/cache/gl/picture_frames.h"

#include <memory>
#include <utility>

#include "rilievo/cache/gl/image_cache.h"

namespace rilievo {

Result<PictureFrames> PictureFrames::create(SceneRenderer& renderer,
                                            const PictureFramesOptions& options) {
  Result<std::unique_ptr<CachePictures>> store =
      ImageCache::make_pictures(renderer, store_options(options));
  if (!store) return store.error();
  return PictureFrames(
      renderer, std::make_unique<PictureChooser>(renderer.placed(), std::move(*store), options),
      options.outlines);
}

}  // namespace rilievo
