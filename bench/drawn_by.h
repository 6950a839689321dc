// Who draws a bench's frames, OpenGL or software.
#pragma once

#include <memory>

#include "bench/bench.h"
#include "rilievo/cache/scene_cache.h"
#include "rilievo/frame/frame_source.h"
#include "rilievo/render/opengl/scene_renderer.h"
#include "rilievo/render/shading/frame_visibility.h"

namespace rilievo::bench {

// As BenchOptions::draw says, in the current OpenGL context.
[[nodiscard]] bool draws_by_software(const BenchOptions& options);
// Draws a scene as BenchOptions::draw says: by OpenGL, whose context must then be current, or, if
// null, by software.
[[nodiscard]] Result<std::unique_ptr<SceneRenderer>> make_renderer(const Scene& scene,
                                                                   const BenchOptions& options);
// A backend of the scene, or of its renderer if there is one; both must outlive it.
[[nodiscard]] std::unique_ptr<Backend> make_backend(const Scene& scene, SceneRenderer* renderer,
                                                    int samples);

// All polygons of the scene, by its renderer; null: by software. Both must outlive the source.
// `visibility` finds the polygons instead of the rasteriser.
[[nodiscard]] std::unique_ptr<FrameSource> polygon_drawer(
    const Scene& scene, SceneRenderer* renderer, int samples,
    std::unique_ptr<FrameVisibility> visibility = nullptr);

// A stored drawable under the scene's sky, likewise.
[[nodiscard]] std::unique_ptr<FrameSource> stored_drawer(const Scene& scene,
                                                         SceneRenderer* renderer, int samples,
                                                         std::unique_ptr<Drawable> drawable,
                                                         std::vector<Instance> instances);

// The cache of the scene, likewise.
[[nodiscard]] Result<CachedFrames> make_cache(const Scene& scene, SceneRenderer* renderer,
                                              const ImageCacheOptions& options);

}  // namespace rilievo::bench
