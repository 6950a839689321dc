#include "bench/drawn_by.h"

#include <utility>

#include "rilievo/cache/gl/image_cache.h"
#include "rilievo/cache/software/software_cache.h"
#include "rilievo/frame/gl/scene_frames.h"
#include "rilievo/frame/software/software_frames.h"
#include "rilievo/gl/context.h"

namespace rilievo::bench {

bool draws_by_software(const BenchOptions& options) {
  return options.draw == "software" || (options.draw == "automatic" && gl::is_software());
}

Result<std::unique_ptr<SceneRenderer>> make_renderer(const Scene& scene,
                                                     const BenchOptions& options) {
  if (draws_by_software(options)) return std::unique_ptr<SceneRenderer>();
  Result<SceneRenderer> made = SceneRenderer::create(scene);
  if (!made) return made.error();
  return std::make_unique<SceneRenderer>(std::move(*made));
}

std::unique_ptr<FrameSource> polygon_drawer(const Scene& scene, SceneRenderer* renderer,
                                            int samples) {
  if (renderer) return std::make_unique<DirectFrames>(*renderer);
  return std::make_unique<SoftwareDirectFrames>(scene, samples);
}

Result<std::unique_ptr<FrameSource>> make_cache(const Scene& scene, SceneRenderer* renderer,
                                                const ImageCacheOptions& options) {
  if (!renderer) {
    Result<std::unique_ptr<SoftwareCache>> made = SoftwareCache::create(scene, options);
    if (!made) return made.error();
    return {std::move(*made)};
  }
  Result<ImageCache> made = ImageCache::create(*renderer, options);
  if (!made) return made.error();
  return {std::make_unique<ImageCache>(std::move(*made))};
}

}  // namespace rilievo::bench
