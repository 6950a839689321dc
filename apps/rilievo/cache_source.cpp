#include "apps/rilievo/cache_source.h"

#include <algorithm>
#include <span>
#include <utility>

#include "apps/rilievo/prepared_kind.h"
#include "rilievo/cache/gl/image_cache.h"
#include "rilievo/cache/software/software_cache.h"
#include "rilievo/capture/gl/opengl_source.h"
#include "rilievo/capture/ray_source.h"
#include "rilievo/render/rays/ray_scene.h"
#include "rilievo/representation/gl/factories.h"
#include "rilievo/representation/software/software_factories.h"

namespace rilievo::app {
namespace {

// Does a kind of --bake-as stand for what lies around the eyes?
bool surrounds(const std::string& name) {
  return kind_method(name).kind->stands_for == StandsFor::surroundings;
}

// What the cache's alternatives are baked from, and what draws them.
struct BakeFrom {
  const PlacedScene& placed;
  CaptureSource& source;
  std::span<const DrawableRow> rows;
};

// What lies far around the eyes, as one.
template <class Cache>
Result<> add_surroundings(Cache& cache, const KindMethod& method, const MethodOptions& options,
                          const BakeFrom& from) {
  Result<PreparedKind> kind = prepare(method, options.kinds, from.rows);
  if (!kind) return kind.error();
  Progress progress("view");
  SurroundingsOptions surroundings{kind->bake, kind->draw, options.eyes};
  surroundings.beyond =
      options.bake_beyond.value_or(0.1 * double(world_bounds(from.placed.scene()).radius()));
  surroundings.progress = [&](int done, int total) { progress.show(done, total); };
  Result<ObjectDrawable> made = bake_surroundings_drawable(from.placed, from.source, *method.kind,
                                                           *kind->factory, surroundings);
  if (!made) return made.error();
  cache.add_surroundings(std::move(made->drawable), std::move(kind->factory),
                         std::move(made->objects));
  return Done{};
}

// The kinds of --bake-as share --bake-mb evenly.
template <class Cache>
Result<> add_alternatives(Cache& cache, const MethodOptions& options, const BakeFrom& from) {
  if (std::count_if(options.bake_as.begin(), options.bake_as.end(), surrounds) > 1)
    return Error{"--bake-as", "names more than one kind of surroundings"};
  if (options.bake_together && (options.bake_as.size() > 1 || surrounds(options.bake_as[0])))
    return Error{"--bake-together", "is for one kind of objects"};
  const std::size_t each = std::size_t(options.bake_mb) * kMegabyte / options.bake_as.size();
  for (const std::string& name : options.bake_as) {
    const KindMethod method = kind_method(name);
    if (surrounds(name)) {
      if (Result<> added = add_surroundings(cache, method, options, from); !added) return added;
      continue;
    }
    Result<PreparedKind> prepared = prepare(method, options.kinds, from.rows);
    if (!prepared) return prepared.error();
    Progress progress("view");
    const ObjectDrawablesOptions objects = object_options(*prepared, each, progress);
    if (options.bake_together) {
      Result<ObjectDrawable> one = bake_together_drawable(from.placed, from.source, *method.kind,
                                                          *prepared->factory, objects);
      if (!one) return one.error();
      cache.add_surroundings(std::move(one->drawable), std::move(prepared->factory),
                             std::move(one->objects));
      continue;
    }
    Result<std::vector<ObjectDrawable>> drawables =
        bake_object_drawables(from.placed, from.source, *method.kind, *prepared->factory, objects);
    if (!drawables) return drawables.error();
    cache.add_alternatives(std::move(*drawables), std::move(prepared->factory));
  }
  return Done{};
}

Result<> expect_memory(const MethodOptions& options) {
  if (options.bake_mb < options.memory_mb) return Done{};
  return Error{"--bake-mb", "must be less than --memory-mb, so that pictures get memory, too"};
}

ImageCacheOptions cache_options(const MethodOptions& options, int samples) {
  ImageCacheOptions cache;
  cache.error_px = options.error_px;
  cache.gap_px = options.gap_px;
  cache.max_bytes = std::size_t(options.memory_mb - options.bake_mb) * kMegabyte;
  cache.capture_ms = options.capture_ms;
  cache.late = options.late;
  cache.max_spike = options.max_spike;
  cache.levels = options.levels;
  if (!options.fade) cache.fade_frames = 1;
  cache.delta_bits = options.delta_bits;
  cache.depth_mode = depth_mode(options);
  cache.samples = samples;
  cache.outlines = options.outlines;
  cache.machine = options.machine;
  return cache;
}

}  // namespace

Result<std::unique_ptr<FrameSource>> make_cache(const MethodOptions& options, int samples,
                                                SceneRenderer& renderer) {
  if (Result<> enough = expect_memory(options); !enough) return enough.error();
  Result<ImageCache> made = ImageCache::create(renderer, cache_options(options, samples));
  if (!made && made.error().where == "machine") return Error{"--machine", made.error().reason};
  if (!made && made.error().where == "levels") return Error{"--levels", made.error().reason};
  if (!made) return made.error();
  if (options.bake_mb > 0) {
    OpenGLSource source(renderer);
    const BakeFrom from{renderer.placed(), source, drawable_rows()};
    if (Result<> added = add_alternatives(*made, options, from); !added) return added.error();
  }
  return {std::make_unique<ImageCache>(std::move(*made))};
}

Result<std::unique_ptr<FrameSource>> make_software_cache(const MethodOptions& options, int samples,
                                                         const Scene& scene) {
  if (Result<> enough = expect_memory(options); !enough) return enough.error();
  Result<std::unique_ptr<SoftwareCache>> made =
      SoftwareCache::create(scene, cache_options(options, samples));
  if (!made) return Error{"--memory-mb", made.error().reason};
  if (options.bake_mb > 0) {
    Result<RayScene> rays = RayScene::create(scene);
    if (!rays) return rays.error();
    RaySource source(*rays);
    const PlacedScene placed(scene);
    const BakeFrom from{placed, source, software_drawable_rows()};
    if (Result<> added = add_alternatives(**made, options, from); !added) return added.error();
  }
  return {std::move(*made)};
}

}  // namespace rilievo::app
