// The cache as a method: what is baked beforehand, and its frames.
#pragma once

#include "rilievo/method/method.h"

namespace rilievo {

// Makes the cache's frames (cache/scene_cache.h), and bakes for --bake-mb. The errors name options.
[[nodiscard]] Result<Method> make_cached_method(const MethodOptions& options, Backend& backend);

}  // namespace rilievo
