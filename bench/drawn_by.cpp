#include "bench/drawn_by.h"

#include <utility>

#include "bench/owned_frames.h"
#include "rilievo/frame/gl/opengl_backend.h"
#include "rilievo/frame/gl/opengl_frames.h"
#include "rilievo/frame/software/software_frames.h"
#include "rilievo/gl/context.h"
#include "rilievo/method/direct.h"
#include "rilievo/method/stored.h"

namespace rilievo::bench {
namespace {

std::unique_ptr<FrameSource> frames_of(const Scene& scene, SceneRenderer* renderer, int samples,
                                       std::unique_ptr<FrameChooser> chooser,
                                       std::unique_ptr<FrameVisibility> visibility = nullptr) {
  if (renderer) return std::make_unique<OpenGLFrames>(*renderer, std::move(chooser));
  auto backend = std::make_unique<SoftwareBackend>(scene, samples);
  auto frames =
      std::make_unique<SoftwareFrames>(*backend, std::move(chooser), std::move(visibility));
  return std::make_unique<OwnedFrames>(std::move(backend), std::move(frames));
}

}  // namespace

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

std::unique_ptr<Backend> make_backend(const Scene& scene, SceneRenderer* renderer, int samples) {
  if (renderer) return std::make_unique<OpenGLBackend>(*renderer, samples);
  return std::make_unique<SoftwareBackend>(scene, samples);
}

std::unique_ptr<FrameSource> polygon_drawer(const Scene& scene, SceneRenderer* renderer,
                                            int samples,
                                            std::unique_ptr<FrameVisibility> visibility) {
  return frames_of(scene, renderer, samples, std::make_unique<DirectChooser>(),
                   std::move(visibility));
}

std::unique_ptr<FrameSource> stored_drawer(const Scene& scene, SceneRenderer* renderer, int samples,
                                           std::unique_ptr<Drawable> drawable,
                                           std::vector<Instance> instances) {
  return frames_of(scene, renderer, samples,
                   std::make_unique<StoredChooser>(
                       PictureSet{std::move(drawable), std::move(instances)}, StoredOptions{}));
}

Result<CachedFrames> make_cache(const Scene& scene, SceneRenderer* renderer,
                                const ImageCacheOptions& options) {
  std::unique_ptr<Backend> backend = make_backend(scene, renderer, options.samples);
  Result<CachedFrames> made = make_cached_frames(*backend, options);
  if (!made) return made.error();
  made->frames = std::make_unique<OwnedFrames>(std::move(backend), std::move(made->frames));
  return made;
}

}  // namespace rilievo::bench
