// Who draws a bench's frames, OpenGL or software?
#pragma once

#include <memory>

#include "bench/bench.h"
#include "rilievo/cache/scene_cache.h"
#include "rilievo/frame/frame_source.h"
#include "rilievo/render/opengl/scene_renderer.h"

namespace rilievo::bench {

// As BenchOptions::draw says, in the current OpenGL context.
[[nodiscard]] bool draws_by_software(const BenchOptions& options);
// Draws a scene as BenchOptions::draw says: by OpenGL, whose context must then be current, or, if
// null, by software.
[[nodiscard]] Result<std::unique_ptr<SceneRenderer>> make_renderer(const Scene& scene,
                                                                   const BenchOptions& options);

// All polygons of the scene, by its renderer; null: by software. Both must outlive the source.
[[nodiscard]] std::unique_ptr<FrameSource> polygon_drawer(const Scene& scene,
                                                          SceneRenderer* renderer, int samples);

// The cache of the scene, likewise.
[[nodiscard]] Result<std::unique_ptr<FrameSource>> make_cache(const Scene& scene,
                                                              SceneRenderer* renderer,
                                                              const ImageCacheOptions& options);

}  // namespace rilievo::bench
