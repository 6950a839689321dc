// The cache as a method: what is baked beforehand, and its frames.
#pragma once

#include "rilievo/cache/scene_cache.h"
#include "rilievo/method/method.h"

namespace rilievo {

// Makes the cache's frames (cache/scene_cache.h), and bakes for --bake-mb. The errors name options.
[[nodiscard]] Result<Method> make_cached_method(const MethodOptions& options, Backend& backend);

// The options that the cache is made with, and those that can change between frames.
[[nodiscard]] ImageCacheOptions cache_options(const MethodOptions& options, int samples);
void follow_cache(const MethodOptions& options, ImageCacheOptions& cache);

}  // namespace rilievo
