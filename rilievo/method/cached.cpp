#include "rilievo/method/cached.h"

#include <algorithm>
#include <span>
#include <utility>

#include "rilievo/cache/scene_cache.h"
#include "rilievo/method/kinds.h"
#include "rilievo/representation/bake_objects.h"

namespace rilievo {
namespace {

constexpr std::size_t kMegabyte = std::size_t(1) << 20;

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
Result<> add_surroundings(SceneCache& cache, const KindMethod& method, const MethodOptions& options,
                          const BakeFrom& from) {
  Result<PreparedKind> kind = prepare(method, options.kinds, from.rows);
  if (!kind) return kind.error();
  SurroundingsOptions surroundings{kind->bake, kind->draw, options.eyes};
  surroundings.beyond =
      options.bake_beyond.value_or(0.1 * double(world_bounds(from.placed.scene()).radius()));
  surroundings.progress = options.progress;
  Result<ObjectDrawable> made = bake_surroundings_drawable(from.placed, from.source, *method.kind,
                                                           *kind->factory, surroundings);
  if (!made) return made.error();
  cache.add_surroundings(std::move(made->drawable), std::move(kind->factory),
                         std::move(made->objects));
  return Done{};
}

// The kinds of --bake-as share --bake-mb evenly.
Result<> add_alternatives(SceneCache& cache, const MethodOptions& options, const BakeFrom& from) {
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
    const ObjectDrawablesOptions objects = object_options(*prepared, each, options.progress);
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

}  // namespace

void follow_cache(const MethodOptions& options, ImageCacheOptions& cache) {
  cache.error_px = options.error_px;
  cache.gap_px = options.gap_px;
  cache.capture_ms = options.capture_ms;
  cache.late = options.late;
  cache.max_spike = options.max_spike;
  cache.outlines = options.outlines;
}

ImageCacheOptions cache_options(const MethodOptions& options, int samples) {
  ImageCacheOptions cache;
  follow_cache(options, cache);
  cache.max_bytes = std::size_t(options.memory_mb - options.bake_mb) * kMegabyte;
  cache.levels = options.levels;
  if (!options.fade) cache.fade_frames = 1;
  cache.delta_bits = options.delta_bits;
  cache.depth_mode = options.depth_mode;
  cache.samples = samples;
  cache.machine = options.machine;
  return cache;
}

Result<Method> make_cached_method(const MethodOptions& options, Backend& backend) {
  if (options.bake_mb >= options.memory_mb)
    return Error{"--bake-mb", "must be less than --memory-mb, so that pictures get memory, too"};
  Result<CachedFrames> made =
      make_cached_frames(backend, cache_options(options, backend.samples()));
  if (!made) return made.error();
  SceneCache& cache = *made->cache;
  if (options.bake_mb > 0) {
    Result<std::unique_ptr<CaptureSource>> source = backend.make_capture_source();
    if (!source) return source.error();
    const BakeFrom from{backend.placed(), **source, backend.drawables()};
    if (Result<> added = add_alternatives(cache, options, from); !added) return added.error();
  }
  Method method;
  method.frames = std::move(made->frames);
  method.follow = [&cache](const MethodOptions& changed) {
    follow_cache(changed, cache.options());
  };
  return method;
}

}  // namespace rilievo
