// The first frames of a built-in scene's walk through the image cache, timed, and compared with
// direct drawing every now and then.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "rilievo/cache/scene_cache.h"
#include "rilievo/measure/stats.h"
#include "rilievo/scene/builtin/builtin.h"

namespace rilievo::bench {

struct CachedWalkOptions {
  int width = 1280, height = 720, samples = 4, frames = 120;
  int compare_every = 12;  // frames between two that are drawn directly too; 0: none
  std::function<void(int done, int total)> progress;
};

struct CachedWalk {
  Summary frame_ms;  // the first frame, which fills the cache, is not among them
  double first_frame_ms = 0;
  double busy_ms_p50 = 0;                  // of processors; by walk_memory_cache() only
  double direct_ms_p50 = 0;                // of the frames compared
  double psnr_db = 0, ssim = 0, flip = 0;  // means over the frames compared
  double bound_px = 0;
  int captures = 0;
};

// One walk for each of `caches`, frame by frame in turn, so that whatever else the machine does
// hits all alike. Needs a current OpenGL context.
[[nodiscard]] Result<std::vector<CachedWalk>> walk_cached(const BuiltinScene& builtin,
                                                          std::span<const ImageCacheOptions> caches,
                                                          const CachedWalkOptions& options);

// The same walk, drawn without OpenGL; nothing is compared.
[[nodiscard]] Result<CachedWalk> walk_memory_cache(const BuiltinScene& builtin,
                                                   ImageCacheOptions cache,
                                                   const CachedWalkOptions& options);

}  // namespace rilievo::bench
